//! Embeddings of any points with distances.

use canonform::linalg::{LandmarkDistances, Matrix};
use canonform::nmds::{
    self, Embedding, NystromOptions, OutOfSample, Regularization, SampleStep, nystrom_extended,
};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays;
use crate::run::run_alone;
use crate::settings::Settings;

/// An embedding, and what places further points in it.
type Embedded<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, f64, usize, Extension);

/// The arguments of an [`Extension`].
type Arguments<'py> = (f64, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);

/// Places further points by their distances to the landmarks.
#[pyclass(frozen, module = "canonform._canonform")]
pub(crate) struct Extension(OutOfSample);

/// A matrix of the library from an array, whatever its layout.
fn matrix_of(array: &PyReadonlyArray2<'_, f64>) -> Matrix {
    let [rows, columns] = [array.shape()[0], array.shape()[1]];
    let array = array.as_array();
    Matrix::from_fn(rows, columns, |i, j| array[(i, j)])
}

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
        let placed = run_alone(py, None, |_| Ok(self.0.place(&distances)?))?;
        arrays::of_matrix(py, &placed)
    }

    /// What `pickle` needs to make it again.
    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Arguments<'py>> {
        let OutOfSample { unit, means, axes } = &self.0;
        let axes = arrays::of_matrix(py, axes)?;
        Ok((*unit, arrays::vector(py, means.clone()), axes))
    }
}

/// Finds how many landmarks are enough; Python measures the distances.
#[pyclass(module = "canonform._canonform")]
pub(crate) struct SampleSearch {
    search: nmds::SampleSearch,
    options: NystromOptions,
}

/// The next number of samples; none at the end.
fn next(step: SampleStep) -> Option<usize> {
    match step {
        SampleStep::Samples(n) => Some(n),
        SampleStep::Done(_) => None,
    }
}

/// The number of landmarks that a search begins with.
#[pyfunction]
pub(crate) fn first_landmarks(settings: &str) -> PyResult<usize> {
    Ok(Settings::parse(settings)?.nystrom()?.first_samples())
}

#[pymethods]
impl SampleSearch {
    /// Embeds by the distances from the first landmarks, one column each.
    #[new]
    fn new(
        py: Python<'_>,
        settings: &str,
        columns: PyReadonlyArray2<'_, f64>,
        landmarks: Vec<usize>,
        limit: usize,
        seed: u64,
    ) -> PyResult<Self> {
        let options = Settings::parse(settings)?.nystrom()?;
        let columns = matrix_of(&columns);
        run_alone(py, None, |_| {
            let distances = LandmarkDistances::new(landmarks, columns)?;
            let first = nmds::nystrom(&distances, &options)?;
            Ok(Self { search: nmds::SampleSearch::new(&distances, first, limit, seed)?, options })
        })
    }

    /// The points whose distances are needed to start.
    fn rows(&self) -> Vec<usize> {
        self.search.rows()
    }

    /// Takes the distances from the rows, one column each.
    fn start(&mut self, py: Python<'_>, columns: PyReadonlyArray2<'_, f64>) -> PyResult<Option<usize>> {
        let columns = matrix_of(&columns);
        run_alone(py, None, |_| Ok(next(self.search.start(&columns)?)))
    }

    /// Embeds by the distances from landmarks, one column each.
    fn offer(
        &mut self,
        py: Python<'_>,
        columns: PyReadonlyArray2<'_, f64>,
        landmarks: Vec<usize>,
    ) -> PyResult<Option<usize>> {
        let columns = matrix_of(&columns);
        run_alone(py, None, |_| {
            let distances = LandmarkDistances::new(landmarks, columns)?;
            let embedding = nmds::nystrom(&distances, &self.options)?;
            Ok(next(self.search.offer(&distances, embedding)?))
        })
    }

    /// The best rank for the last landmarks that were offered; none if the regularisation has none to choose.
    fn rank(
        &mut self,
        py: Python<'_>,
        columns: PyReadonlyArray2<'_, f64>,
        landmarks: Vec<usize>,
    ) -> PyResult<Option<usize>> {
        let columns = matrix_of(&columns);
        run_alone(py, None, |_| {
            let distances = LandmarkDistances::new(landmarks, columns)?;
            let with = |rank| NystromOptions {
                regularization: Regularization::LowRank { rank: Some(rank) },
                ..self.options.clone()
            };
            let ranks = self.options.other_ranks(distances.n_landmarks()).into_iter();
            let others =
                ranks.map(|rank| nmds::nystrom(&distances, &with(rank))).collect::<Result<_, _>>()?;
            self.search.compare(others)?;
            let is_free = matches!(self.options.regularization, Regularization::LowRank { .. });
            Ok(self.search.trials().last().map(|trial| trial.rank).filter(|_| is_free))
        })
    }
}

/// Nystrom MDS from columns of distances, one for each landmark.
#[pyfunction]
pub(crate) fn nystrom<'py>(
    py: Python<'py>,
    columns: PyReadonlyArray2<'py, f64>,
    landmarks: Vec<usize>,
    settings: &str,
) -> PyResult<Embedded<'py>> {
    let options = Settings::parse(settings)?.nystrom()?;
    let columns = matrix_of(&columns);
    let (embedding, extension) = run_alone(py, None, |_| {
        Ok(nystrom_extended(&LandmarkDistances::new(landmarks, columns)?, &options)?)
    })?;
    let Embedding { coords, eigenvalues, negative_mass, rank } = embedding;
    let points = arrays::of_matrix(py, &coords)?;
    Ok((points, arrays::vector(py, eigenvalues), negative_mass, rank, Extension(extension)))
}
