//! Embeddings of any points with distances.

use canonform::linalg::LandmarkDistances;
use canonform::nmds::{Embedding, OutOfSample, nystrom_extended};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{Rows, Vector, matrix_of, of_matrix};
use crate::run::run;
use crate::settings::Settings;

/// An embedding, and what places further points in it.
type Embedded = (Rows<f64>, Vector<f64>, f64, usize, Extension);

/// The arguments of an [`Extension`].
type Arguments = (f64, Vector<f64>, Rows<f64>);

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
    fn place(&self, py: Python<'_>, distances: PyReadonlyArray2<'_, f64>) -> PyResult<Rows<f64>> {
        let distances = matrix_of(&distances);
        Ok(of_matrix(&run(py, |_| Ok(self.0.place(&distances)?))?))
    }

    /// What `pickle` needs to make it again.
    fn __getnewargs__(&self) -> Arguments {
        let OutOfSample { unit, means, axes } = &self.0;
        (*unit, Vector(means.clone()), of_matrix(axes))
    }
}

/// Nystrom MDS from columns of distances, one for each landmark.
#[pyfunction]
pub(crate) fn nystrom(
    py: Python<'_>,
    columns: PyReadonlyArray2<'_, f64>,
    landmarks: Vec<usize>,
    settings: Settings,
) -> PyResult<Embedded> {
    let (regularization, dim) = settings.nystrom()?;
    let columns = matrix_of(&columns);
    let (embedding, extension) = run(py, |_| {
        Ok(nystrom_extended(&LandmarkDistances::new(landmarks, columns)?, regularization, dim)?)
    })?;
    let Embedding { coords, eigenvalues, negative_mass, rank } = embedding;
    Ok((of_matrix(&coords), Vector(eigenvalues), negative_mass, rank, Extension(extension)))
}
