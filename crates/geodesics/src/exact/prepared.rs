//! All that is prepared once per surface.

use surface::{CornerId, EdgeGraph, FaceId, IntrinsicMesh};

use super::faces::{Face, Faces};
use super::fan::Fans;
use super::order::{Renumbered, renumbered};

/// A surface prepared for the propagation of windows; vertices and faces are renumbered.
#[derive(Debug)]
pub(super) struct PreparedSurface {
    pub(super) faces: Faces,
    pub(super) fans: Fans,
    /// In mesh units.
    pub(super) links: EdgeGraph,
    /// How many faces a window may cross in a row around one vertex.
    pub(super) max_turn: i32,
    /// The new number of every vertex and face.
    pub(super) new_vertices: Vec<u32>,
    pub(super) new_faces: Vec<u32>,
}

impl PreparedSurface {
    pub(super) fn new(mesh: &IntrinsicMesh) -> Self {
        let Renumbered { mesh, vertices, faces: new_faces } = renumbered(mesh);
        let faces = Faces::new(&mesh);
        let fans = Fans::new(&mesh, &faces);
        let links = EdgeGraph::new(mesh.n_vertices(), mesh.links().iter().copied());
        // A shortest path crosses no face twice.
        let max_turn = i32::try_from(fans.max_valence()).unwrap_or(i32::MAX);
        Self { faces, fans, links, max_turn, new_vertices: vertices, new_faces }
    }

    pub(super) fn n_vertices(&self) -> usize {
        self.new_vertices.len()
    }

    /// The face of a corner.
    #[inline]
    pub(super) fn face(&self, corner: CornerId) -> &Face {
        self.faces.of(corner.face())
    }

    /// The vertices of a face.
    pub(super) fn vertices(&self, face: FaceId) -> [u32; 3] {
        self.faces.of(face).vertices
    }
}
