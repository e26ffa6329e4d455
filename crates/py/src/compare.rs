//! Alignment and comparison of two shapes.

use canonform::compare::compare_meshes;
use canonform::rigid::{Reflections, align_points};
use pyo3::prelude::*;

use crate::arrays::{Rows, Vector};
use crate::form::Form;
use crate::record::json;
use crate::run::run;
use crate::settings::Settings;
use crate::surface::Surface;

/// A rigid motion: rotation, translation, whether it includes a reflection, and how far nearest points are apart after it.
type Motion = (Rows<f64>, Vector<f64>, bool, f64);

/// The rigid motion that takes one form onto another, in mesh units.
#[pyfunction]
pub(crate) fn align(py: Python<'_>, a: &Form, b: &Form, reflections: bool) -> PyResult<Motion> {
    let reflections = if reflections { Reflections::Allow } else { Reflections::Forbid };
    let found = run(py, |_| Ok(align_points(&a.prepared()?, &b.prepared()?, reflections)))?;
    let rotation = found.map.rotation.transpose().as_slice().to_vec();
    let translation = found.map.translation.as_slice().to_vec();
    Ok((Rows(rotation, [3, 3]), Vector(translation), found.map.reflected, found.gap.rms))
}

/// The comparison of two surfaces as the JSON of `canonform compare`, and the residuals of the vertices of both repaired
/// meshes.
#[pyfunction]
pub(crate) fn compare(
    py: Python<'_>,
    a: &Surface,
    b: &Surface,
    names: [String; 2],
    settings: Settings,
) -> PyResult<(String, Vector<f64>)> {
    let [of_a, of_b] = [settings.form(a.inner.input.repair)?, settings.form(b.inner.input.repair)?];
    let (found, residuals) = run(py, |observer| {
        let sides = [a.compared(&of_a, observer)?, b.compared(&of_b, observer)?];
        let mut found = compare_meshes([sides[0].compared(), sides[1].compared()])?;
        found.relation = found.relation.named(&names[0], &names[1]);
        let residuals = a.inner.in_input_order(&found.overlay.residuals[0], f64::NAN);
        Ok((found, residuals))
    })?;
    Ok((json(&found), Vector(residuals)))
}
