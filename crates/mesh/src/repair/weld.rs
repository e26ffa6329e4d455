//! Merging vertices in the same or nearly the same position.

use std::collections::HashMap;

use nalgebra::{Point3, center};
use surface::{EdgeId, IntrinsicMesh, Topology, VertexId};

use super::{Repair, Weld};
use crate::box_tree::BoxTree;
use crate::coincidence::coincident_pairs;

/// Two boundary edges are the two sides of a seam if their ends are no farther apart than this share of the shortest
/// side of their faces.
pub(super) const SEAM_TOLERANCE: f64 = 0.02;

/// The most candidates per boundary edge or vertex in a pass. Where more are close together, later passes go on.
const CANDIDATES: usize = 8;

impl Repair<'_> {
    /// Merges vertices according to the policy, first those in the same position; nearby ones wait for a pass in which there are
    /// none. Returns how many were merged into another. No face is degenerate.
    pub(super) fn weld(&mut self, topology: &Topology) -> usize {
        let edges: Vec<EdgeId> = match self.weld {
            Weld::None => return 0,
            Weld::All => Vec::new(),
            Weld::Seams | Weld::Within(_) => topology.boundary_edges().collect(),
        };
        let mut candidates: Vec<u32> = match self.weld {
            Weld::All => (0..self.scaled.len() as u32).collect(),
            _ => edges.iter().flat_map(|edge| topology.edges()[edge.index()]).map(|v| v.0).collect(),
        };
        candidates.sort_unstable();
        candidates.dedup();
        let pairs = coincident_pairs(&self.mesh.positions, candidates.iter().copied());
        let n_coincident = pairs.into_iter().filter(|&[a, b]| self.merged.union(a, b)).count();
        self.report.welded_vertices += n_coincident;
        let pairs = match self.weld {
            _ if n_coincident > 0 => return n_coincident,
            Weld::Within(tolerance) => vertex_pairs(&self.scaled, &candidates, tolerance / self.unit),
            Weld::Seams => seam_pairs(&self.scaled, topology, &edges),
            Weld::All | Weld::None => return 0,
        };
        self.merge_near(topology, pairs)
    }

    /// Merges the nearest pairs first, unless that would merge two vertices of one edge, or vertices farther apart along an
    /// axis than the tolerance.
    fn merge_near(&mut self, topology: &Topology, mut pairs: Vec<Pair>) -> usize {
        let Self { scaled, unit, merged, report, .. } = self;
        pairs.sort_unstable_by(|a, b| a.gap.total_cmp(&b.gap).then(a.ends.cmp(&b.ends)));
        pairs.dedup_by_key(|pair| pair.ends);
        let (mut n_merged, mut widest) = (0, [0.0; 2]);
        // Those of more than one vertex, by their lowest.
        let mut clusters: HashMap<u32, Cluster> = HashMap::new();
        let alone = |v: u32| {
            let (at, n_corners) = (scaled[v as usize], topology.vertex_corners(VertexId(v)).len());
            Cluster { members: vec![v], n_corners, low: at, high: at }
        };
        for Pair { gap, tolerance, ends } in pairs {
            let sets = ends.map(|v| merged.find(v));
            if sets[0] == sets[1] {
                continue;
            }
            let [a, b] = sets.map(|set| clusters.remove(&set).unwrap_or_else(|| alone(set)));
            let (low, high) = (a.low.inf(&b.low), a.high.sup(&b.high));
            // The cluster with fewer corners is searched, which bounds the cost of all searches.
            let (small, mut large, [own, other]) =
                if a.n_corners < b.n_corners { (a, b, sets) } else { (b, a, [sets[1], sets[0]]) };
            let corners = small.members.iter().flat_map(|v| topology.vertex_corners(VertexId(*v)));
            let mut neighbors = corners.flat_map(|corner| topology.edge_ends(*corner));
            if (high - low).max() > tolerance || neighbors.any(|v| merged.find(v.0) == other) {
                clusters.extend([(own, small), (other, large)]);
                continue;
            }
            merged.union(own, other);
            large.members.extend(small.members);
            let n_corners = large.n_corners + small.n_corners;
            clusters.insert(merged.find(own), Cluster { n_corners, low, high, ..large });
            n_merged += 1;
            if gap >= widest[0] {
                widest = [gap, tolerance];
            }
        }
        report.near_welded_vertices += n_merged;
        if *unit * widest[0] > report.weld_gap {
            [report.weld_gap, report.weld_tolerance] = widest.map(|length| *unit * length);
        }
        n_merged
    }

    /// Merges the ends of every edge whose squared length, in units near the size of the mesh, vanishes; returns how many vertices
    /// were merged into another.
    ///
    /// The faces at such an edge become degenerate and are removed. If its ends stayed apart, that would leave a slit.
    pub(super) fn collapse_zero_edges(&mut self, surface: &IntrinsicMesh) -> usize {
        let edges = surface.topology().edges().iter().zip(surface.edge_lengths());
        let vanishing = edges.filter(|(_, length)| (*length / self.unit).powi(2) < f64::MIN_POSITIVE);
        vanishing.filter(|([a, b], _)| self.merged.union(a.0, b.0)).count()
    }
}

/// Two vertices that may be merged, the lower one first.
#[derive(Debug, Clone, Copy)]
struct Pair {
    gap: f64,
    tolerance: f64,
    ends: [u32; 2],
}

impl Pair {
    fn new([p, q]: [u32; 2], gap: f64, tolerance: f64) -> Self {
        Self { gap, tolerance, ends: [p.min(q), p.max(q)] }
    }
}

/// The pairs of boundary vertices within a tolerance.
fn vertex_pairs(positions: &[Point3<f64>], boundary: &[u32], tolerance: f64) -> Vec<Pair> {
    let tree = BoxTree::new(boundary.iter().map(|&v| (positions[v as usize], v)));
    let near = |&v: &u32| {
        let at = &positions[v as usize];
        let found = tree.nearest_within(at, tolerance * tolerance, CANDIDATES, |other| other == v, |_| false);
        found.into_iter().map(move |(sq, other)| Pair::new([v, other], sq.sqrt(), tolerance))
    };
    boundary.iter().flat_map(near).collect()
}

/// The pairs of ends of boundary edges that are the two sides of a seam.
fn seam_pairs(positions: &[Point3<f64>], topology: &Topology, edges: &[EdgeId]) -> Vec<Pair> {
    let ends = |i: u32| topology.edges()[edges[i as usize].index()];
    let at = |v: VertexId| positions[v.index()];
    let apex = |i: u32| topology.corner_vertex(topology.edge_corners(edges[i as usize])[0]);
    let middle = |i: u32| {
        let [a, b] = ends(i);
        center(&at(a), &at(b))
    };
    let tolerance = |edge: &EdgeId| {
        let [a, b, c] = topology.faces()[topology.edge_corners(*edge)[0].face().index()].map(at);
        SEAM_TOLERANCE
            * [b - a, c - b, a - c].map(|side| side.norm()).into_iter().fold(f64::INFINITY, f64::min)
    };
    let tolerances: Vec<f64> = edges.iter().map(tolerance).collect();
    let tree = BoxTree::new((0..edges.len() as u32).map(|i| (middle(i), i)));
    let mut pairs = Vec::new();
    for i in 0..edges.len() as u32 {
        let sq_tolerance = tolerances[i as usize] * tolerances[i as usize];
        for (_, j) in tree.nearest_within(&middle(i), sq_tolerance, CANDIDATES, |j| j == i, |_| false) {
            // Two faces over the same vertex would become one.
            if apex(i) == apex(j) {
                continue;
            }
            let tolerance = tolerances[i as usize].min(tolerances[j as usize]);
            let ([a, b], [c, d]) = (ends(i), ends(j));
            let gaps = |pairs: [[VertexId; 2]; 2]| pairs.map(|[p, q]| (at(q) - at(p)).norm());
            let matches = [[[a, c], [b, d]], [[a, d], [b, c]]];
            let widest = |m: &[[VertexId; 2]; 2]| gaps(*m).into_iter().fold(0.0, f64::max);
            let [same, crossed] = [widest(&matches[0]), widest(&matches[1])];
            let best = matches[usize::from(crossed < same)];
            if same.min(crossed) <= tolerance {
                let both = best.into_iter().zip(gaps(best)).filter(|([p, q], _)| p != q);
                pairs.extend(both.map(|([p, q], gap)| Pair::new([p.0, q.0], gap, tolerance)));
            }
        }
    }
    pairs
}

/// Vertices that are merged into one.
struct Cluster {
    members: Vec<u32>,
    /// Number of their corners.
    n_corners: usize,
    /// Their bounding box.
    low: Point3<f64>,
    high: Point3<f64>,
}
