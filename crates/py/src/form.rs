//! Embedded surfaces.

use std::path::PathBuf;
use std::sync::Arc;

use canonform::descriptors::CanonicalForm;
use canonform::embed::Embedded;
use canonform::mesh::TriMesh;
use canonform::rigid::PointSet;
use canonform::surface::VertexId;
use pyo3::prelude::*;

use crate::arrays::{Rows, Vector, of_matrix, picked_rows};
use crate::error::{Exception, raised};
use crate::points::points_of;
use crate::record::json;
use crate::run::run;

/// An embedding of a surface.
#[pyclass(frozen, module = "canonform._canonform")]
pub(crate) struct Form {
    pub(crate) surface: Arc<canonform::Surface>,
    pub(crate) embedded: Embedded,
}

impl Form {
    /// The form, weighted by area.
    pub(crate) fn weighted(&self) -> Result<CanonicalForm, canonform::Error> {
        self.embedded.form(&self.surface)
    }

    /// The form, ready to be aligned.
    pub(crate) fn prepared(&self) -> Result<PointSet, canonform::Error> {
        Ok(self.weighted()?.prepared()?)
    }

    /// The faces of the input with the coordinates of the form, if there are three.
    fn to_mesh(&self) -> PyResult<TriMesh> {
        let coords = &self.embedded.embedding.coords;
        if coords.ncols() != 3 {
            let message = format!("a mesh has 3 dimensions, not {}; leave out n_components=", coords.ncols());
            return Err(Exception::EmbeddingError.with(message));
        }
        Ok(self.surface.input.with_positions(|v| [0, 1, 2].map(|axis| coords[(v.index(), axis)]).into()))
    }
}

#[pymethods]
impl Form {
    /// Coordinates in the order of the input, NaN for vertices that the repair dropped.
    fn points(&self) -> Rows<f64> {
        let rows = self.surface.input.remap.all_to_new().map(|vertex| vertex.map(VertexId::index));
        picked_rows(&self.embedded.embedding.coords, rows)
    }

    /// Coordinates of the surface bent into its form, in the order of the input.
    fn bent_points(&self, py: Python<'_>) -> PyResult<Rows<f64>> {
        let bent = run(py, |observer| Ok(self.weighted()?.with_features(self.surface.mesh(), observer)?))?;
        let points: Vec<[f64; 3]> = bent.points().iter().map(|p| p.coords.into()).collect();
        Ok(self.surface.in_input_order(&points, [f64::NAN; 3]).into())
    }

    fn eigenvalues(&self) -> Vector<f64> {
        Vector(self.embedded.embedding.eigenvalues.clone())
    }

    /// Distances from the samples to all vertices of the input, one row per sample.
    fn distances(&self, py: Python<'_>) -> PyResult<Rows<f64>> {
        let known = &self.embedded.distances;
        let (n, p) = (known.n_landmarks(), self.surface.n_input_vertices());
        run(py, |_| {
            let mut rows = Vec::with_capacity(n * p);
            for landmark in 0..n {
                rows.extend(self.surface.in_input_order(&known.column(landmark)?, f64::NAN));
            }
            Ok(Rows(rows, [n, p]))
        })
    }

    /// Coordinates of points of the surface, one row each.
    fn place(&self, py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<Rows<f64>> {
        let points = points_of(points)?;
        Ok(of_matrix(&run(py, |_| self.embedded.place(&self.surface, &points))?))
    }

    /// Facts about the embedding, as the JSON of `canonform embed`.
    fn report(&self) -> String {
        json(&self.embedded.report)
    }

    /// The options that it was made with, as JSON.
    fn options(&self) -> String {
        json(&self.embedded.options)
    }

    /// Writes the form as a mesh.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let mesh = self.to_mesh()?;
        raised(py.detach(|| canonform::mesh::io::write(&path, &mesh)))
    }
}
