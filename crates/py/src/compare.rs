//! Alignment and comparison of two shapes.

use canonform::compare::compare_meshes;
use canonform::rigid::{self, Reflections, align_points};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays;
use crate::form::Form;
use crate::record::json;
use crate::run::run;
use crate::settings::Settings;
use crate::surface::Surface;

/// The rigid motion that takes one form onto another.
#[pyclass(frozen, module = "canonform._canonform")]
pub(crate) struct Alignment(rigid::Alignment);

#[pymethods]
impl Alignment {
    fn rotation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rotation = self.0.map.rotation.transpose();
        arrays::matrix(py, rotation.as_slice().to_vec(), [3, 3])
    }

    fn translation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::vector(py, self.0.map.translation.as_slice().to_vec())
    }

    #[getter]
    fn reflected(&self) -> bool {
        self.0.map.reflected
    }

    #[getter]
    fn rms(&self) -> f64 {
        self.0.gap.rms
    }
}

/// Aligns two forms in mesh units.
#[pyfunction]
pub(crate) fn align(py: Python<'_>, a: &Form, b: &Form, reflections: bool) -> PyResult<Alignment> {
    let reflections = if reflections { Reflections::Allow } else { Reflections::Forbid };
    run(py, |_| Ok(Alignment(align_points(&a.prepared()?, &b.prepared()?, reflections))))
}

/// The comparison of two surfaces as the JSON of `canonform compare`, and the residuals of the vertices of both repaired
/// meshes.
#[pyfunction]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    a: &Surface,
    b: &Surface,
    names: [String; 2],
    settings: Settings,
) -> PyResult<(String, Bound<'py, PyArray1<f64>>)> {
    let [of_a, of_b] = [settings.form(a.inner.input.repair)?, settings.form(b.inner.input.repair)?];
    let (found, residuals) = run(py, |observer| {
        let sides = [a.compared(&of_a, observer)?, b.compared(&of_b, observer)?];
        let mut found = compare_meshes([sides[0].compared(), sides[1].compared()])?;
        found.relation = found.relation.named(&names[0], &names[1]);
        let residuals = a.inner.in_input_order(&found.overlay.residuals[0], f64::NAN);
        Ok((found, residuals))
    })?;
    Ok((json(&found), arrays::vector(py, residuals)))
}
