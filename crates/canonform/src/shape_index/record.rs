//! A description as an index stores it.

use std::path::Path;

use descriptors::{CanonicalForm, PreparedShape, SignatureKind};
use index::{Entry, Facts, Index, IndexError, Shape};
use nalgebra::Point3;
use surface::unit_for;

use super::source::Listed;
use crate::error::Error;
use crate::form::{DescribeOptions, ShapeDescription};

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
pub(super) fn same_source(entry: &Entry, listed: &Listed) -> bool {
    entry.label == listed.file.label && entry.path == listed.stored
}

/// The unit of the points of a stored form, in mesh units: 1 unless 32-bit numbers could not hold them.
fn form_unit(area: f64, options: &DescribeOptions) -> f64 {
    if options.form.method.has_unit() { unit_for(area.sqrt()) } else { 1.0 }
}

impl ShapeDescription {
    /// The shape as an index stores it, with 32-bit numbers, and without a name.
    #[must_use]
    pub fn shape(&self) -> Shape {
        let unit = form_unit(self.area, &self.options);
        let points = self.form.points().iter().map(|p| p / unit).zip(self.form.weights());
        let signatures = self.signatures.iter();
        Shape {
            entry: Entry {
                facts: Facts {
                    vertices: self.repair.input_vertices as u64,
                    faces: self.repair.input_faces as u64,
                    area: self.area,
                    diameter: self.diameter,
                    dropped_area_share: self.repair.dropped_area_share,
                    components: self.repair.components as u64,
                    shortcuts: self.shortcuts.len() as u64,
                    longest_boundary: self.longest_boundary,
                },
                ..Entry::default()
            },
            fused: self.fused.clone(),
            signatures: signatures.map(|s| (s.kind.name().to_owned(), self.rounded(s.kind))).collect(),
            form: points.map(|(p, w)| [p.x, p.y, p.z, *w].map(|x| x as f32)).collect(),
            disc_areas: self.disc_areas.to_numbers(),
            components: Vec::new(),
        }
    }
}

/// A shape that was described with `options`, ready to be compared.
///
/// # Errors
/// [`Error::Descriptor`] if its form or its fused vector is none.
pub(super) fn prepared(shape: &Shape, options: &DescribeOptions) -> Result<PreparedShape, Error> {
    let area = shape.entry.facts.area;
    let unit = form_unit(area, options);
    let points = shape.form.iter().map(|[x, y, z, _]| Point3::new(*x, *y, *z).cast() * unit);
    let weights = shape.form.iter().map(|[.., w]| f64::from(*w)).collect();
    let form_area = options.form.method.has_unit().then_some(area);
    let form = CanonicalForm::from_parts(points.collect(), weights, form_area)?;
    let prepared = PreparedShape::new(shape.fused.clone(), &form, Some(area))?;
    Ok(prepared.with_rigid(shape.signatures.get(SignatureKind::Rigid.name()).cloned().unwrap_or_default()))
}

/// The error that a shape of an index has no signature of a kind.
pub(super) fn missing_signature(path: &Path, id: &str, kind: SignatureKind) -> IndexError {
    IndexError::Damaged { path: path.to_owned(), what: format!("`{id}` has no {} signature", kind.name()) }
}
