//! A description as an index keeps it.

use std::path::Path;

use descriptors::CanonicalForm;
use index::{ContentHash, Index, Shape, ShapeEntry, ShapeVectors};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};

use crate::describe::DESCRIPTION_VERSION;
use crate::{DescribeOptions, PipelineError, ShapeDescription, ShapeFile};

/// The fact that gives a form its unit of length.
const AREA: &str = "area";

/// How the shapes of an index were described, as the index says it.
#[derive(Serialize, Deserialize)]
struct Provenance {
    description: u32,
    #[serde(flatten)]
    options: DescribeOptions,
}

/// The text by which an index says how its shapes were described.
pub(super) fn options_text(options: &DescribeOptions) -> String {
    let provenance = Provenance { description: DESCRIPTION_VERSION, options: options.clone() };
    // Nothing in it can fail to become text.
    serde_json::to_string(&provenance).unwrap_or_else(|_| options.text())
}

/// How the shapes of an index were described.
///
/// # Errors
/// [`PipelineError::UnknownOptions`].
pub(super) fn options_of(index: &Index) -> Result<DescribeOptions, PipelineError> {
    let unknown = || PipelineError::UnknownOptions {
        path: index.path().to_owned(),
        options: index.options().to_owned(),
    };
    let mut fields: serde_json::Map<String, serde_json::Value> =
        serde_json::from_str(index.options()).map_err(|_| unknown())?;
    let version = fields.remove("description");
    if version != Some(DESCRIPTION_VERSION.into()) {
        return Err(unknown());
    }
    serde_json::from_value(fields.into()).map_err(|_| unknown())
}

/// What the index is told of a file without a look at its mesh.
pub(super) fn same_source(entry: &ShapeEntry, file: &ShapeFile) -> bool {
    entry.label == file.label && entry.path == path_text(&file.path)
}

pub(super) fn path_text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// The shape that a file became.
pub(super) fn shape(file: &ShapeFile, content: ContentHash, described: ShapeDescription) -> Shape {
    let repair = &described.repair;
    let facts = [
        ("vertices", repair.input_vertices as f64),
        ("faces", repair.input_faces as f64),
        (AREA, described.area),
        ("diameter", described.diameter),
        ("dropped_area_share", repair.dropped_area_share),
    ];
    let form = described.form.points().iter().zip(described.form.weights());
    let signatures = described.signatures.iter();
    Shape {
        id: file.name.clone(),
        entry: ShapeEntry {
            label: file.label.clone(),
            path: path_text(&file.path),
            content,
            facts: facts.map(|(name, value)| (name.to_owned(), value)).to_vec(),
        },
        vectors: ShapeVectors {
            signatures: signatures
                .map(|s| (s.kind.name().to_owned(), s.values.iter().map(|x| *x as f32).collect()))
                .collect(),
            form: form.map(|(p, w)| [p.x, p.y, p.z, *w].map(|x| x as f32)).collect(),
            fused: described.fused,
        },
    }
}

/// The form of an indexed shape.
///
/// # Errors
/// [`PipelineError::Descriptor`] when it has none.
pub(super) fn form(entry: &ShapeEntry, vectors: &ShapeVectors) -> Result<CanonicalForm, PipelineError> {
    let points = vectors.form.iter().map(|[x, y, z, _]| Point3::new(*x, *y, *z).cast());
    let weights = vectors.form.iter().map(|[.., w]| f64::from(*w)).collect();
    Ok(CanonicalForm::from_parts(points.collect(), weights, entry.fact(AREA))?)
}
