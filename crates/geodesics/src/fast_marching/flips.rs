//! Flipping edges inside the surface until its triangles are as round as its vertices allow.
//!
//! An edge whose two opposite angles exceed 180 degrees together is replaced by the other diagonal
//! of its two triangles, laid out in one plane. Neither the surface nor its distances change, and
//! where no such edge is left (the intrinsic Delaunay triangulation; Bobenko and Springborn 2007),
//! few angles are obtuse.

use surface::{EdgeId, FaceId, IntrinsicMesh};

use super::triangulation::Triangulation;
use crate::corner::Corner;

/// Flips are bounded by this many for each edge; meshes in practice need less than one.
const FLIPS_PER_EDGE: usize = 16;

/// A flip gains at least this share of the cotangents at the edge, or it is rounding.
const SLACK: f64 = 1e-9;

/// The triangulation of a mesh after all flips, and how many there were.
///
/// Edges at boundaries and of more than two faces stay. Two vertices may be joined by several edges in
/// the end, but none to itself. The edges that were flipped away stay as segments.
pub(super) fn flipped(mesh: &IntrinsicMesh, triangulation: Triangulation) -> (Triangulation, usize) {
    let mut flips = Flips::new(mesh, triangulation);
    flips.run();
    (flips.triangulation, flips.flips)
}

struct Flips {
    triangulation: Triangulation,
    /// The edge opposite each vertex of each triangle.
    edges: Vec<[u32; 3]>,
    /// The triangles on either side of every edge that may be flipped.
    sides: Vec<Option<[u32; 2]>>,
    /// Which edges are no longer those of the mesh.
    is_new: Vec<bool>,
    flips: usize,
}

/// A triangle seen from one of its sides: the slot of the vertex opposite it, and those of the
/// side's two ends, of which the given vertex is the first.
fn from_side(face: &[u32; 3], edges: &[u32; 3], edge: u32, first: Option<u32>) -> [usize; 3] {
    let apex = edges.iter().position(|e| *e == edge).unwrap_or(0);
    let (a, b) = ((apex + 1) % 3, (apex + 2) % 3);
    if first.is_some_and(|first| face[a] != first) { [apex, b, a] } else { [apex, a, b] }
}

impl Flips {
    fn new(mesh: &IntrinsicMesh, triangulation: Triangulation) -> Self {
        let topology = mesh.topology();
        let side_of = |e: usize| match topology.edge_corners(EdgeId::from(e)) {
            [a, b] => Some([a.face().0, b.face().0]),
            _ => None,
        };
        Self {
            triangulation,
            edges: (0..topology.n_faces())
                .map(|f| FaceId::from(f).corners().map(|corner| topology.opposite_edge(corner).0))
                .collect(),
            sides: (0..topology.n_edges()).map(side_of).collect(),
            is_new: vec![false; topology.n_edges()],
            flips: 0,
        }
    }

    fn run(&mut self) {
        let n = self.sides.len();
        let mut waiting: Vec<u32> = (0..n as u32).rev().collect();
        let mut queued = vec![true; n];
        while let Some(edge) = waiting.pop() {
            queued[edge as usize] = false;
            if self.flips == FLIPS_PER_EDGE * n {
                break;
            }
            let Some(around) = self.flip(edge) else { continue };
            self.flips += 1;
            for other in around {
                if !std::mem::replace(&mut queued[other as usize], true) {
                    waiting.push(other);
                }
            }
        }
    }

    /// Flips an edge if that is possible and makes the triangles rounder: the four edges around it.
    fn flip(&mut self, edge: u32) -> Option<[u32; 4]> {
        // Triangle f = (c, a, b) lies above the edge from a to b, and g = (d, a, b) below it.
        let [f, g] = self.sides[edge as usize]?.map(|face| face as usize);
        let Triangulation { faces, lengths, .. } = &self.triangulation;
        let [fc, fa, fb] = from_side(&faces[f], &self.edges[f], edge, None);
        let [c, a, b] = [fc, fa, fb].map(|slot| faces[f][slot]);
        let [gd, ga, gb] = from_side(&faces[g], &self.edges[g], edge, Some(a));
        let d = faces[g][gd];
        let base = lengths[f][fc];
        let (from_a, from_b) = ([lengths[f][fb], lengths[g][gb]], [lengths[f][fa], lengths[g][ga]]);
        // Nearly all edges face two acute angles, and stay.
        if (0..2).all(|k| base * base <= from_a[k] * from_a[k] + from_b[k] * from_b[k]) {
            return None;
        }
        let [up, down] = [0, 1].map(|k| Corner::from_lengths(base, from_a[k], from_b[k]));
        let cotangent = |apex: Corner| (apex.x * (apex.x - base) + apex.y * apex.y) / (base * apex.y);
        let (at_c, at_d) = (cotangent(up), cotangent(down));
        let is_gain = at_c + at_d < -SLACK * (at_c.abs() + at_d.abs());
        // Between its ends, the other diagonal crosses the edge.
        let crossing = (up.x * down.y + down.x * up.y) / (up.y + down.y);
        if !is_gain || crossing <= 0.0 || crossing >= base || c == d {
            return None;
        }
        let diagonal = (up.x - down.x).hypot(up.y + down.y);
        let [ca, cb, da, db] = [self.edges[f][fb], self.edges[f][fa], self.edges[g][gb], self.edges[g][ga]];
        if !std::mem::replace(&mut self.is_new[edge as usize], true) {
            self.triangulation.segments.push(([a, b], base));
        }
        self.triangulation.faces[f] = [c, a, d];
        self.triangulation.lengths[f] = [from_a[1], diagonal, from_a[0]];
        self.edges[f] = [da, edge, ca];
        self.triangulation.faces[g] = [c, b, d];
        self.triangulation.lengths[g] = [from_b[1], diagonal, from_b[0]];
        self.edges[g] = [db, edge, cb];
        for (moved, from, to) in [(da, g, f), (cb, f, g)] {
            if let Some(side) =
                self.sides[moved as usize].iter_mut().flatten().find(|side| **side as usize == from)
            {
                *side = to as u32;
            }
        }
        Some([ca, cb, da, db])
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use mesh::shapes;
    use surface::{Topology, VertexId};

    use super::*;

    fn all_flipped(mesh: &IntrinsicMesh) -> (Triangulation, usize) {
        flipped(mesh, Triangulation::new(mesh))
    }

    fn is_delaunay(triangulation: &Triangulation) -> bool {
        let mut cotangents: HashMap<[u32; 2], Vec<f64>> = HashMap::new();
        for (face, sides) in triangulation.faces.iter().zip(&triangulation.lengths) {
            for k in 0..3 {
                let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                let apex = Corner::from_lengths(sides[k], sides[b], sides[a]);
                let cotangent = (apex.x * (apex.x - sides[k]) + apex.y * apex.y) / (sides[k] * apex.y);
                cotangents.entry([face[a].min(face[b]), face[a].max(face[b])]).or_default().push(cotangent);
            }
        }
        cotangents.values().all(|at| at.len() != 2 || at[0] + at[1] > -1e-6)
    }

    #[test]
    fn a_sheared_sheet_becomes_right_again() {
        let sheet = shapes::sheared_grid(9, 7, 1.0, 1.0).intrinsic();
        assert!(!is_delaunay(&Triangulation::new(&sheet)));
        let (triangulation, flips) = all_flipped(&sheet);
        assert!(flips > 0 && is_delaunay(&triangulation));
    }

    #[test]
    fn lengths_are_those_in_the_plane_and_nothing_is_lost() {
        let sheet = shapes::jittered_grid(12, 9, 1.0, 0.3, 5);
        let surface = sheet.intrinsic();
        let (triangulation, flips) = all_flipped(&surface);
        assert!(flips > 0 && is_delaunay(&triangulation));
        let distance = |a: u32, b: u32| (sheet.positions[a as usize] - sheet.positions[b as usize]).norm();
        let area = |sides: &[f64; 3]| {
            let apex = Corner::from_lengths(sides[0], sides[1], sides[2]);
            0.5 * sides[0] * apex.y
        };
        for (face, sides) in triangulation.faces.iter().zip(&triangulation.lengths) {
            for k in 0..3 {
                assert!((sides[k] - distance(face[(k + 1) % 3], face[(k + 2) % 3])).abs() < 1e-12);
            }
        }
        for (ends, length) in &triangulation.segments {
            assert!((length - distance(ends[0], ends[1])).abs() < 1e-12);
        }
        let total = |t: &Triangulation| t.lengths.iter().map(area).sum::<f64>();
        assert!((total(&triangulation) - total(&Triangulation::new(&surface))).abs() < 1e-9);
    }

    #[test]
    fn edges_of_one_or_three_faces_stay() {
        let fan: Vec<[VertexId; 3]> =
            [[0, 1, 2], [1, 0, 3], [0, 1, 4]].map(|face: [u32; 3]| face.map(VertexId)).to_vec();
        let topology = Topology::new(5, fan);
        // The edge between vertices 0 and 1 is long, so the angles that face it are wide.
        let lengths = topology.edges().iter().map(|ends| if ends[1].0 == 1 { 1.9 } else { 1.0 }).collect();
        let surface = IntrinsicMesh::new(topology, lengths);
        assert_eq!(all_flipped(&surface), (Triangulation::new(&surface), 0));
    }
}
