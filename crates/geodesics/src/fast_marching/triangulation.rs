//! The triangles that a front runs over.

use surface::{FaceId, IntrinsicMesh, Rows};

use super::chains::{Arm, Part, Reaches};

/// Triangles by their vertices and sides, and straight ways that are no side of any.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Triangulation {
    pub(super) n_vertices: usize,
    /// The vertices of each triangle.
    pub(super) faces: Vec<[u32; 3]>,
    /// The length of the side opposite each of them.
    pub(super) lengths: Vec<[f64; 3]>,
    /// Links between components, and edges that were flipped away.
    pub(super) segments: Vec<([u32; 2], f64)>,
}

impl Triangulation {
    pub(super) fn new(mesh: &IntrinsicMesh) -> Self {
        let topology = mesh.topology();
        Self {
            n_vertices: mesh.n_vertices(),
            faces: topology.faces().iter().map(|face| face.map(|v| v.0)).collect(),
            lengths: (0..topology.n_faces())
                .map(|f| FaceId::from(f).corners().map(|corner| mesh.opposite_length(corner)))
                .collect(),
            segments: mesh.links().iter().map(|link| (link.ends.map(|v| v.0), link.length)).collect(),
        }
    }

    /// How many corners are wider than 90 degrees.
    pub(super) fn obtuse_corners(&self) -> usize {
        let is_wide = |a: f64, b: f64, c: f64| a * a + b * b < c * c;
        let wide = |[a, b, c]: &[f64; 3]| is_wide(*a, *b, *c) || is_wide(*b, *c, *a) || is_wide(*c, *a, *b);
        self.lengths.iter().filter(|sides| wide(sides)).count()
    }

    /// The corners of every vertex, by triangle and slot.
    pub(super) fn corners(&self) -> Rows<(u32, u8)> {
        let of_face = |(f, face): (usize, &[u32; 3])| {
            let face = *face;
            [0, 1, 2].map(|k| (face[k] as usize, (f as u32, k as u8)))
        };
        Rows::collect(self.n_vertices, self.faces.iter().enumerate().flat_map(of_face))
    }

    /// A corner as a part of its vertex.
    pub(super) fn part(&self, face: u32, slot: u8) -> Part {
        let (vertices, lengths) = (&self.faces[face as usize], &self.lengths[face as usize]);
        let k = slot as usize;
        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
        let arms = [Arm::edge(vertices[a], lengths[b]), Arm::edge(vertices[b], lengths[a])];
        Part::triangle(arms, lengths[k], Reaches::Both)
    }
}
