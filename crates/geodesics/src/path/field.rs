//! Distances and their sources, which paths lead to.

use surface::{FaceId, IntrinsicMesh, SurfacePoint};

use crate::source::Source;

/// Distances from sources, which paths lead to.
#[derive(Debug)]
pub(super) struct PathField<'a> {
    pub(super) mesh: &'a IntrinsicMesh,
    pub(super) sources: &'a [Source],
    pub(super) distances: &'a [f64],
}

impl PathField<'_> {
    pub(super) fn is_source(&self, point: SurfacePoint) -> bool {
        self.sources.iter().any(|source| source.point() == point)
    }

    /// The sources in a face that are not vertices.
    pub(super) fn sources_within(&self, face: FaceId) -> impl Iterator<Item = SurfacePoint> {
        self.sources.iter().map(Source::point).filter(move |source| match *source {
            SurfacePoint::Vertex(_) => false,
            SurfacePoint::Edge { edge, .. } => {
                self.mesh.topology().edge_corners(edge).iter().any(|corner| corner.face() == face)
            }
            SurfacePoint::Face { face: own, .. } => own == face,
        })
    }
}
