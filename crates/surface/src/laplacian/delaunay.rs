//! The intrinsic Delaunay triangulation of a surface of any topology.

use super::triangle::Triangle;
use crate::{CornerId, EdgeId, IntrinsicMesh, VertexId};

/// Flips are bounded by this many for each side; meshes in practice need less than one.
const FLIPS_PER_SIDE: usize = 32;

/// A negative sum of two cotangents within this share of one and their sizes is rounding.
const SLACK: f64 = 1e-10;

/// A closed surface glued from triangles side to side, each side known by the number
/// `3 * triangle + slot` and running from corner `slot` to the next.
///
/// It is the double of the mesh (the "tufted cover" of Sharp and Crane 2020): every face has a
/// front and a back, and around an edge the front of each face is glued to the back of the next.
/// Whatever the edge was (a boundary, an edge of three faces, one of opposite orientations), its
/// sides now come in pairs that run against each other, and may be flipped.
///
/// **Invariant.** `twin` is an involution without fixed points that joins sides of the same two
/// vertices, opposite in direction and equal in length.
#[derive(Debug)]
pub(super) struct Cover {
    /// The vertices of each triangle; one may occur twice.
    vertices: Vec<[u32; 3]>,
    /// Length of each side.
    lengths: Vec<f64>,
    /// The side that each side is glued to.
    twin: Vec<u32>,
}

impl Cover {
    /// The double of a mesh with the given edge lengths.
    pub(super) fn new(mesh: &IntrinsicMesh, edge_lengths: &[f64]) -> Self {
        let topology = mesh.topology();
        let fronts = topology.faces().iter().map(|f| f.map(|v| v.0));
        let backs = fronts.clone().map(|[a, b, c]| [a, c, b]);
        let vertices: Vec<[u32; 3]> = fronts.chain(backs).collect();
        let n_sides = 3 * vertices.len();
        let mut cover = Self { lengths: vec![0.0; n_sides], twin: vec![0; n_sides], vertices };
        for (e, (&[lower, _], &length)) in topology.edges().iter().zip(edge_lengths).enumerate() {
            let corners = topology.edge_corners(EdgeId::from(e));
            for (corner, next) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                let [rising, falling] = cover.sides_at(*corner, lower);
                let [_, glued] = cover.sides_at(*next, lower);
                cover.twin[rising] = glued as u32;
                cover.twin[glued] = rising as u32;
                cover.lengths[rising] = length;
                cover.lengths[falling] = length;
            }
        }
        cover
    }

    /// The two sides, on front and back, of the edge that a corner of the mesh faces: first the one
    /// that starts at its end `lower`.
    fn sides_at(&self, corner: CornerId, lower: VertexId) -> [usize; 2] {
        let (face, slot) = (corner.face().index(), (corner.slot() + 1) % 3);
        let back = face + self.vertices.len() / 2;
        let sides = [3 * face + slot, 3 * back + 2 - slot];
        if self.vertices[face][slot] == lower.0 { sides } else { [sides[1], sides[0]] }
    }

    /// Flips sides until the two angles that face each sum to at most 180 degrees: no weight of the
    /// cotangent stiffness matrix is negative then.
    ///
    /// Bounded: on a surface so degenerate that flips run out, some negative weights stay.
    pub(super) fn flip_to_delaunay(&mut self) {
        // A flip keeps the numbers of its two triangles and renumbers their sides; it queues the
        // four outer ones under their new numbers, so none is ever missed.
        let mut waiting: Vec<u32> =
            (0..self.twin.len() as u32).filter(|&s| s < self.twin[s as usize]).collect();
        let mut queued: Vec<bool> = vec![false; self.twin.len()];
        waiting.iter().for_each(|&side| queued[side as usize] = true);
        let mut budget = FLIPS_PER_SIDE * self.twin.len();
        while let Some(side) = waiting.pop() {
            queued[side as usize] = false;
            let Some(triangles) = self.flip(side as usize) else { continue };
            for triangle in triangles {
                for outer in [3 * triangle + 1, 3 * triangle + 2] {
                    let outer = self.twin[outer].min(outer as u32);
                    if !std::mem::replace(&mut queued[outer as usize], true) {
                        waiting.push(outer);
                    }
                }
            }
            budget -= 1;
            if budget == 0 {
                break;
            }
        }
    }

    /// Replaces a side that is not Delaunay by the other diagonal of its two triangles, which
    /// becomes side 0 of both.
    fn flip(&mut self, side: usize) -> Option<[usize; 2]> {
        let next = |side: usize| side - side % 3 + (side + 1) % 3;
        let glued = self.twin[side] as usize;
        let [f, g] = [side / 3, glued / 3];
        if f == g {
            return None;
        }
        let upper = self.laid_out_on(side);
        let lower = self.laid_out_on(glued);
        let (p, q) = (upper.apex_cotangent(), lower.apex_cotangent());
        let beyond_180_degrees = p + q < -SLACK * (1.0 + p.abs() + q.abs());
        if !beyond_180_degrees {
            return None;
        }
        // The quad a d b c with the diagonal from a to b; its sides bc, ca, ad, db.
        let [bc, ad] = [next(side), next(glued)];
        let [ca, db] = [next(bc), next(ad)];
        let [a, b, c, d] = [side, glued, ca, db].map(|s| self.vertices[s / 3][s % 3]);
        let diagonal = upper.apex_to_apex(lower);
        let [l_bc, l_ca, l_ad, l_db] = [bc, ca, ad, db].map(|s| self.lengths[s]);
        let has_inside = |sides| Triangle::from_sides(sides).y > 0.0;
        if !has_inside([diagonal, l_db, l_bc]) || !has_inside([diagonal, l_ca, l_ad]) {
            return None;
        }
        let moves = [(db, 3 * f + 1), (bc, 3 * f + 2), (ca, 3 * g + 1), (ad, 3 * g + 2)];
        let moved = |side: u32| {
            moves.iter().find(|(old, _)| *old == side as usize).map_or(side, |(_, new)| *new as u32)
        };
        let partners = moves.map(|(old, new)| (new, moved(self.twin[old])));
        self.vertices[f] = [c, d, b];
        self.vertices[g] = [d, c, a];
        for (new, partner) in partners.into_iter().chain([(3 * f, 3 * g as u32)]) {
            self.twin[new] = partner;
            self.twin[partner as usize] = new as u32;
        }
        self.lengths[3 * f..3 * f + 3].copy_from_slice(&[diagonal, l_db, l_bc]);
        self.lengths[3 * g..3 * g + 3].copy_from_slice(&[diagonal, l_ca, l_ad]);
        Some([f, g])
    }

    /// A triangle with one of its sides as base.
    fn laid_out_on(&self, side: usize) -> Triangle {
        let (first, slot) = (side - side % 3, side % 3);
        Triangle::from_sides([0, 1, 2].map(|i| self.lengths[first + (slot + i) % 3]))
    }

    /// The triangles: their vertices, and their sides from each corner to the next.
    pub(super) fn triangles(&self) -> impl Iterator<Item = ([u32; 3], [f64; 3])> {
        self.vertices.iter().zip(self.lengths.chunks_exact(3)).map(|(v, l)| (*v, [l[0], l[1], l[2]]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::shapes;

    use crate::Topology;
    use crate::testing::intrinsic;

    fn double(mesh: &IntrinsicMesh) -> Cover {
        Cover::new(mesh, mesh.edge_lengths())
    }

    fn flipped(mesh: &IntrinsicMesh) -> Cover {
        let mut cover = double(mesh);
        cover.flip_to_delaunay();
        cover
    }

    /// Every side is glued to one that runs against it, as long as it is; no side can be flipped.
    fn assert_delaunay(cover: &Cover) {
        let start = |side: usize| cover.vertices[side / 3][side % 3];
        let end = |side: usize| cover.vertices[side / 3][(side + 1) % 3];
        for (side, &twin) in cover.twin.iter().enumerate() {
            let twin = twin as usize;
            assert!(twin != side && cover.twin[twin] as usize == side);
            assert_eq!((start(side), end(side)), (end(twin), start(twin)));
            assert_eq!(cover.lengths[side], cover.lengths[twin]);
            let [p, q] = [side, twin].map(|side| cover.laid_out_on(side).apex_cotangent());
            assert!(side / 3 == twin / 3 || p + q >= -1e-9 * (1.0 + p.abs() + q.abs()), "{p} {q}");
        }
    }

    fn area(cover: &Cover) -> f64 {
        cover.triangles().map(|(_, sides)| Triangle::from_sides(sides).area()).sum()
    }

    #[test]
    fn flips_end_with_delaunay_and_the_same_area() {
        for mesh in [
            shapes::sheared_grid(12, 9, 1.0, 4.3),
            shapes::jittered_grid(14, 14, 1.0, 0.24, 5),
            shapes::torus(30, 4, 2.0, 0.5),
            shapes::cylinder(5, 40, 1.0, 2.0),
            shapes::tetrahedron(2),
        ] {
            let mesh = intrinsic(&mesh);
            let (before, after) = (double(&mesh), flipped(&mesh));
            assert_delaunay(&after);
            assert!((area(&after) / area(&before) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_delaunay_surface_stays_as_it_is() {
        let mesh = intrinsic(&shapes::icosphere(2));
        assert_eq!(flipped(&mesh).lengths, double(&mesh).lengths);
        // Right angles on both sides: a tie, and no reason to flip.
        let mesh = intrinsic(&shapes::grid(7, 5, 0.3));
        assert_eq!(flipped(&mesh).lengths, double(&mesh).lengths);
    }

    #[test]
    fn flips_find_the_short_diagonal_of_a_kite() {
        // A rhombus of sides 1 cut along its long diagonal.
        let faces = [[0, 1, 2], [2, 1, 3]].map(|f: [u32; 3]| f.map(VertexId)).to_vec();
        let mesh = IntrinsicMesh::new(Topology::new(4, faces), vec![1.0, 1.0, 1.8, 1.0, 1.0]);
        let cover = flipped(&mesh);
        let short = 2.0 * (1.0f64 - 0.81).sqrt();
        let found = |[v, w]: [u32; 2]| {
            cover.triangles().flat_map(move |(vertices, sides)| {
                (0..3).filter_map(move |i| {
                    let ends = [vertices[i], vertices[(i + 1) % 3]];
                    (ends == [v, w] || ends == [w, v]).then_some(sides[i])
                })
            })
        };
        assert_eq!(found([1, 2]).count(), 0);
        assert_eq!(found([0, 3]).count(), 4);
        assert!(found([0, 3]).all(|length| (length - short).abs() < 1e-15));
    }

    #[test]
    fn edges_of_any_kind_are_glued() {
        let fan: Vec<[u32; 3]> = vec![[0, 1, 2], [0, 1, 3], [1, 0, 4]];
        let moebius: Vec<[u32; 3]> = vec![[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]];
        let doubled: Vec<[u32; 3]> = vec![[0, 1, 2], [0, 1, 2], [2, 1, 0]];
        for faces in [fan, moebius, doubled] {
            let faces = faces.into_iter().map(|f| f.map(VertexId)).collect();
            let topology = Topology::new(5, faces);
            // Sides of different lengths, some corners obtuse.
            let lengths = (0..topology.n_edges()).map(|e| 1.0 + 0.13 * (e * e % 7) as f64).collect();
            assert_delaunay(&flipped(&IntrinsicMesh::new(topology, lengths)));
        }
    }

    #[test]
    fn slivers_are_flipped_away_where_they_can_be() {
        // A thin strip: caps of 179.99 degrees along both sides.
        let mut sheet = shapes::grid(30, 2, 1.0);
        for p in &mut sheet.positions {
            p.x += if p.y > 0.5 { 7.3 } else { 0.0 };
            p.y *= 1e-3;
        }
        let mesh = intrinsic(&sheet);
        let cover = flipped(&mesh);
        assert_delaunay(&cover);
        assert!((area(&cover) / area(&double(&mesh)) - 1.0).abs() < 1e-6);
    }
}
