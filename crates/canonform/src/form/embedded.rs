//! Embedded surfaces.

use descriptors::CanonicalForm;
use linalg::LandmarkDistances;
use mesh::Surface;
use nmds::{Embedding, OutOfSample};

use super::options::FormOptions;
use super::report::EmbedReport;
use crate::error::Error;

/// An embedded surface.
#[derive(Debug, Clone)]
pub struct Embedded {
    /// How it was made.
    pub options: FormOptions,
    /// Coordinates of the vertices of the repaired mesh.
    pub embedding: Embedding,
    /// Distances from the samples to all vertices, in mesh units. A method without samples keeps the columns of as many.
    pub distances: LandmarkDistances,
    /// Facts about the run.
    pub report: EmbedReport,
    /// What placed the points, if the coordinates are those of a coarser mesh.
    pub(super) extension: Option<OutOfSample>,
}

impl Embedded {
    /// The canonical form: the embedded surface, weighted by the areas of the mesh.
    ///
    /// # Errors
    /// [`Error::Descriptor`] when the embedding is not three-dimensional or all points coincide.
    pub fn form(&self, surface: &Surface) -> Result<CanonicalForm, Error> {
        let form = CanonicalForm::new(&self.embedding, surface.mesh())?;
        Ok(if self.options.method.has_unit() { form } else { form.without_unit() })
    }
}
