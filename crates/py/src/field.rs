//! Distance fields.

use std::path::PathBuf;

use canonform::fields::{FieldOptions, Finish, PairDistance, PairKind};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::Vector;
use crate::error::Exception;
use crate::points::{pairs_of, vertex_of};
use crate::record::json;
use crate::run::run;
use crate::settings::Settings;
use crate::surface::Surface;

/// The distances between all pairs of vertices of a surface.
#[pyclass(frozen, module = "canonform._canonform")]
pub(crate) struct DistanceField(canonform::fields::DistanceField);

/// Vertices, and their distances.
type Neighbors = (Vector<i64>, Vector<f64>);

/// Distances, lower and upper bounds, and which distances are exact.
type Answers = (Vector<f64>, Vector<f64>, Vector<f64>, Vector<bool>);

/// `None` finishes no pair.
fn finish(tolerance: Option<f64>) -> Finish {
    tolerance.map_or(Finish::Never, Finish::Beyond)
}

fn answers(found: &[PairDistance]) -> Answers {
    let column = |value: fn(&PairDistance) -> f64| {
        let known = |pair: &PairDistance| if pair.kind == PairKind::Dropped { f64::NAN } else { value(pair) };
        Vector(found.iter().map(known).collect())
    };
    let exact = found.iter().map(|pair| pair.kind == PairKind::Exact).collect();
    (column(|pair| pair.distance), column(|pair| pair.lower), column(|pair| pair.upper), Vector(exact))
}

#[pymethods]
impl DistanceField {
    /// Measures the distances from landmarks of a surface.
    #[staticmethod]
    fn build(
        py: Python<'_>,
        surface: &Surface,
        landmarks: usize,
        rank: Option<usize>,
        geodesic: Settings,
    ) -> PyResult<Self> {
        let options = FieldOptions { method: geodesic.distances()?, landmarks, rank };
        run(py, |observer| {
            Ok(Self(canonform::fields::DistanceField::build(&surface.inner, &options, observer)?))
        })
    }

    #[staticmethod]
    fn open(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        run(py, |_| Ok(Self(canonform::fields::DistanceField::open(&path)?)))
    }

    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        run(py, |_| Ok(self.0.save(&path)?))
    }

    /// The content of its file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.0.to_bytes()))
    }

    /// The field of which these bytes are the file.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let read = py.detach(|| canonform::fields::DistanceField::from_bytes(bytes));
        read.map(Self).map_err(|fault| Exception::FileError.with(fault))
    }

    #[getter]
    fn n_vertices(&self) -> usize {
        self.0.n_vertices()
    }

    /// Facts about the field, as the JSON of `canonform field info`.
    fn facts(&self) -> String {
        json(self.0.facts())
    }

    /// Vertices of the input.
    fn landmarks(&self) -> Vector<i64> {
        Vector(self.0.landmarks().iter().map(|v| i64::from(v.0)).collect())
    }

    /// The distances of the rows of an n x 2 array.
    fn pairs(
        &self,
        py: Python<'_>,
        pairs: PyReadonlyArray2<'_, i64>,
        tolerance: Option<f64>,
    ) -> PyResult<Answers> {
        let (pairs, finish) = (pairs_of(&pairs)?, finish(tolerance));
        let found = run(py, |observer| Ok(self.0.pairs(&pairs, finish, observer)?))?;
        Ok(answers(&found))
    }

    /// The distances from one vertex to all.
    fn row(&self, py: Python<'_>, source: &Bound<'_, PyAny>, tolerance: Option<f64>) -> PyResult<Answers> {
        let (source, finish) = (vertex_of(source)?, finish(tolerance));
        let found = run(py, |observer| Ok(self.0.row(source, finish, observer)?))?;
        Ok(answers(&found))
    }

    /// The nearest vertices, and their distances.
    fn nearest(&self, py: Python<'_>, source: &Bound<'_, PyAny>, k: usize) -> PyResult<Neighbors> {
        let source = vertex_of(source)?;
        let found = run(py, |observer| Ok(self.0.nearest(source, k, observer)?))?;
        let (vertices, distances) = found.iter().map(|pair| (i64::from(pair.b.0), pair.distance)).unzip();
        Ok((Vector(vertices), Vector(distances)))
    }
}
