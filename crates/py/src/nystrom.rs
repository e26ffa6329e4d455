//! Embeddings of any points with distances.

use canonform::linalg::LandmarkDistances;
use canonform::nmds::{Embedding, OutOfSample, nystrom_extended};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{self, matrix_of};
use crate::run::run;
use crate::settings::Settings;

/// An embedding, and what places further points in it.
type Embedded<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, f64, usize, Extension);

/// The arguments of an [`Extension`].
type Arguments<'py> = (f64, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);

/// Places further points by their distances to the landmarks.
#[pyclass(frozen, module = "canonform._canonform")]
pub(crate) struct Extension(OutOfSample);

#[pymethods]
impl Extension {
    #[new]
    fn new(unit: f64, means: PyReadonlyArray1<'_, f64>, axes: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        Ok(Self(OutOfSample { unit, means: means.as_slice()?.to_vec(), axes: matrix_of(&axes) }))
    }

    /// Coordinates from distances, one row for each point.
    fn place<'py>(
        &self,
        py: Python<'py>,
        distances: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let distances = matrix_of(&distances);
        let placed = run(py, |_| Ok(self.0.place(&distances)?))?;
        arrays::of_matrix(py, &placed)
    }

    /// What `pickle` needs to make it again.
    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Arguments<'py>> {
        let OutOfSample { unit, means, axes } = &self.0;
        let axes = arrays::of_matrix(py, axes)?;
        Ok((*unit, arrays::vector(py, means.clone()), axes))
    }
}

/// Nystrom MDS from columns of distances, one for each landmark.
#[pyfunction]
pub(crate) fn nystrom<'py>(
    py: Python<'py>,
    columns: PyReadonlyArray2<'py, f64>,
    landmarks: Vec<usize>,
    settings: Settings,
) -> PyResult<Embedded<'py>> {
    let (regularization, dim) = settings.nystrom()?;
    let columns = matrix_of(&columns);
    let (embedding, extension) = run(py, |_| {
        Ok(nystrom_extended(&LandmarkDistances::new(landmarks, columns)?, regularization, dim)?)
    })?;
    let Embedding { coords, eigenvalues, negative_mass, rank } = embedding;
    let points = arrays::of_matrix(py, &coords)?;
    Ok((points, arrays::vector(py, eigenvalues), negative_mass, rank, Extension(extension)))
}
