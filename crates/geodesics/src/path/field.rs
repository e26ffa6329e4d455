//! Distances and their sources, which paths lead to.

use std::collections::{BTreeMap, BTreeSet};

use surface::{FaceId, IntrinsicMesh, SurfacePoint, VertexId};

use crate::flat::faces_around;
use crate::source::Source;

/// Distances from sources, which paths lead to.
#[derive(Debug)]
pub(super) struct PathField<'a> {
    pub(super) mesh: &'a IntrinsicMesh,
    pub(super) sources: &'a [Source],
    pub(super) distances: &'a [f64],
    /// The sources that are vertices, and the others by the faces that hold them.
    at_vertices: BTreeSet<VertexId>,
    in_faces: BTreeMap<FaceId, Vec<SurfacePoint>>,
}

impl<'a> PathField<'a> {
    pub(super) fn new(mesh: &'a IntrinsicMesh, sources: &'a [Source], distances: &'a [f64]) -> Self {
        let mut at_vertices = BTreeSet::new();
        let mut in_faces: BTreeMap<FaceId, Vec<SurfacePoint>> = BTreeMap::new();
        for point in sources.iter().map(Source::point) {
            if let SurfacePoint::Vertex(vertex) = point {
                at_vertices.insert(vertex);
                continue;
            }
            for face in faces_around(mesh, point) {
                in_faces.entry(face).or_default().push(point);
            }
        }
        Self { mesh, sources, distances, at_vertices, in_faces }
    }

    pub(super) fn is_source(&self, vertex: VertexId) -> bool {
        self.at_vertices.contains(&vertex)
    }

    /// The sources in a face that are not vertices.
    pub(super) fn sources_within(&self, face: FaceId) -> &[SurfacePoint] {
        self.in_faces.get(&face).map_or(&[], Vec::as_slice)
    }
}
