//! A description as an index stores it.

use std::path::Path;

use base::ContentHash;
use descriptors::{CanonicalForm, DiscAreas, PreparedShape, SignatureKind};
use index::{Index, IndexError, Shape, ShapeEntry, ShapeVectors};
use nalgebra::Point3;
use surface::unit_for;

use super::source::Listed;
use crate::error::Error;
use crate::form::{DescribeOptions, ShapeDescription};

/// The area of the surface, in squared mesh units.
pub(super) const AREA: &str = "area";

/// The share of the surface that the repair dropped.
pub(super) const DROPPED: &str = "dropped_area_share";

/// The number of connected components before the repair. Indexes may lack it.
pub(super) const COMPONENTS: &str = "components";

/// The number of components that are stored beside the largest. Indexes may lack it.
pub(super) const OTHER_COMPONENTS: &str = "other_components";

/// The number of shortcuts that were cut.
pub(super) const SHORTCUTS: &str = "shortcuts";

/// How the shapes of an index were described.
pub(super) fn options_of(index: &Index) -> Result<DescribeOptions, Error> {
    let options = DescribeOptions::from_text(index.options()).ok_or_else(|| Error::UnknownOptions {
        path: index.path().to_owned(),
        options: index.options().to_owned(),
    })?;
    options.validate()?;
    Ok(options)
}

/// Whether an entry has the class and the path of a file.
pub(super) fn same_source(entry: &ShapeEntry, listed: &Listed) -> bool {
    entry.label == listed.file.label && entry.path == listed.stored
}

/// The unit of the points of a stored form, in mesh units: 1 unless 32-bit numbers could not hold them.
fn form_unit(area: Option<f64>, options: &DescribeOptions) -> f64 {
    let size = area.filter(|_| options.form.method.has_unit()).map(f64::sqrt);
    size.map_or(1.0, unit_for)
}

/// The shape of a mesh file, as an index stores it.
pub(super) fn shape(listed: &Listed, content: ContentHash, described: Described) -> Shape {
    let Described { shape: described, components } = described;
    let repair = &described.repair;
    let mut facts = vec![
        ("vertices", repair.input_vertices as f64),
        ("faces", repair.input_faces as f64),
        (AREA, described.area),
        ("diameter", described.diameter),
        (DROPPED, repair.dropped_area_share),
        (COMPONENTS, repair.components as f64),
        (SHORTCUTS, described.shortcuts.len() as f64),
    ];
    if !components.is_empty() {
        facts.push((OTHER_COMPONENTS, components.len() as f64));
    }
    let unit = form_unit(Some(described.area), &described.options);
    let points = described.form.points().iter().map(|p| p / unit);
    let form = points.zip(described.form.weights());
    let signatures = described.signatures.iter();
    Shape {
        id: listed.file.name.clone(),
        entry: ShapeEntry {
            label: listed.file.label.clone(),
            path: listed.stored.clone(),
            content,
            facts: facts.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
        },
        vectors: ShapeVectors {
            form: form.map(|(p, w)| [p.x, p.y, p.z, *w].map(|x| x as f32)).collect(),
            fused: described.fused,
            disc_areas: described.disc_areas.to_numbers(),
            components,
            signatures: signatures
                .map(|s| (s.kind.name().to_owned(), s.values.iter().map(|x| *x as f32).collect()))
                .collect(),
        },
    }
}

/// The areas of geodesic discs of an indexed shape; `None` if they are not stored.
pub(super) fn disc_areas(vectors: &ShapeVectors) -> Option<DiscAreas> {
    DiscAreas::from_numbers(&vectors.disc_areas).filter(|_| !vectors.disc_areas.is_empty())
}

/// Whether a shape is stored without the signature of a kind.
pub(super) fn lacks(vectors: &ShapeVectors, kind: SignatureKind) -> bool {
    vectors.signatures.iter().all(|(name, _)| name != kind.name())
}

/// The signature of a kind of an indexed shape.
///
/// # Errors
/// [`IndexError::Damaged`] if it is not stored.
pub(super) fn signature(
    vectors: ShapeVectors,
    kind: SignatureKind,
    id: &str,
    path: &Path,
) -> Result<Vec<f32>, IndexError> {
    let found = vectors.signatures.into_iter().find(|(name, _)| name == kind.name());
    let missing = || IndexError::Damaged {
        path: path.to_owned(),
        what: format!("`{id}` has no {} signature", kind.name()),
    };
    Ok(found.ok_or_else(missing)?.1)
}

/// A described mesh file.
pub(super) struct Described {
    /// The largest component.
    pub(super) shape: ShapeDescription,
    /// The fused vectors of the other different components.
    pub(super) components: Vec<Vec<f32>>,
}

/// An indexed shape, which was described with `options`, ready to be compared.
pub(super) fn prepared(
    entry: &ShapeEntry,
    vectors: ShapeVectors,
    options: &DescribeOptions,
) -> Result<PreparedShape, Error> {
    let unit = form_unit(entry.fact(AREA), options);
    let points = vectors.form.iter().map(|[x, y, z, _]| Point3::new(*x, *y, *z).cast() * unit);
    let weights = vectors.form.iter().map(|[.., w]| f64::from(*w)).collect();
    let area = entry.fact(AREA);
    let form_area = area.filter(|_| options.form.method.has_unit());
    let form = CanonicalForm::from_parts(points.collect(), weights, form_area)?;
    let rigid = vectors.signatures.into_iter().find(|(name, _)| name == SignatureKind::Rigid.name());
    let shape = PreparedShape::new(vectors.fused, &form, area)?;
    Ok(shape.with_rigid(rigid.map_or_else(Vec::new, |(_, values)| values)))
}
