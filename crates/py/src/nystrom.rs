//! Embeddings of any points with distances.

use canonform::linalg::{LandmarkDistances, Matrix};
use canonform::nmds::{
    self, Embedding, NmdsError, NystromOptions, OutOfSample, Regularization, SampleGoal, SampleStep,
    nystrom_extended,
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

/// What a search needs next: `n` samples, the distances from some rows, or nothing.
type Step = (&'static str, Vec<usize>);

fn step(next: SampleStep) -> Step {
    match next {
        SampleStep::Samples(n) => ("samples", vec![n]),
        SampleStep::Rows(rows) => ("rows", rows),
        SampleStep::Done(_) => ("done", Vec::new()),
    }
}

/// Finds how many landmarks are enough; Python measures the distances.
#[pyclass(module = "canonform._canonform")]
pub(crate) struct SampleSearch {
    search: nmds::SampleSearch,
    options: NystromOptions,
    goal: SampleGoal,
}

impl SampleSearch {
    /// Embeddings with the default rank, or with other ranks.
    fn embedded(&self, distances: &LandmarkDistances, others: bool) -> Result<Vec<Embedding>, NmdsError> {
        let others = if others { self.options.other_ranks(distances.n_landmarks()) } else { Vec::new() };
        let with = |rank| NystromOptions {
            regularization: Regularization::LowRank { rank: Some(rank) },
            ..self.options.clone()
        };
        let all = std::iter::once(self.options.clone()).chain(others.into_iter().map(with));
        all.map(|options| nmds::nystrom(distances, &options)).collect()
    }
}

#[pymethods]
impl SampleSearch {
    #[new]
    fn new(settings: &str, limit: usize, seed: u64) -> PyResult<Self> {
        let (options, goal) = Settings::parse(settings)?.nystrom()?;
        Ok(Self {
            search: nmds::SampleSearch::new(goal, options.first_samples(), limit, seed),
            options,
            goal,
        })
    }

    fn start(&self) -> Step {
        step(self.search.start())
    }

    /// Embeds by the distances from landmarks, one column each.
    fn offer(
        &mut self,
        py: Python<'_>,
        columns: PyReadonlyArray2<'_, f64>,
        landmarks: Vec<usize>,
    ) -> PyResult<Step> {
        let columns = matrix_of(&columns);
        run_alone(py, None, |_| {
            let distances = LandmarkDistances::new(landmarks, columns)?;
            let candidates = self.embedded(&distances, self.goal != SampleGoal::Settled)?;
            Ok(step(self.search.offer(&distances, candidates)?))
        })
    }

    /// Takes the distances from rows, one column each.
    fn supply(
        &mut self,
        py: Python<'_>,
        rows: Vec<usize>,
        columns: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Step> {
        let columns = matrix_of(&columns);
        run_alone(py, None, |_| Ok(step(self.search.supply(&rows, &columns)?)))
    }

    /// The rank of the embedding found, for the last landmarks that were offered.
    fn rank(
        &mut self,
        py: Python<'_>,
        columns: PyReadonlyArray2<'_, f64>,
        landmarks: Vec<usize>,
    ) -> PyResult<Option<usize>> {
        let columns = matrix_of(&columns);
        run_alone(py, None, |_| {
            if self.goal == SampleGoal::Settled {
                let others = self.embedded(&LandmarkDistances::new(landmarks, columns)?, true)?;
                self.search.compare(others)?;
            }
            let is_free = matches!(self.options.regularization, Regularization::LowRank { .. });
            let found = self.search.trials().last().map(|trial| trial.rank);
            Ok(found.filter(|_| is_free))
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
    let (options, _) = Settings::parse(settings)?.nystrom()?;
    let columns = matrix_of(&columns);
    let (embedding, extension) = run_alone(py, None, |_| {
        Ok(nystrom_extended(&LandmarkDistances::new(landmarks, columns)?, &options)?)
    })?;
    let Embedding { coords, eigenvalues, negative_mass, rank } = embedding;
    let points = arrays::of_matrix(py, &coords)?;
    Ok((points, arrays::vector(py, eigenvalues), negative_mass, rank, Extension(extension)))
}
