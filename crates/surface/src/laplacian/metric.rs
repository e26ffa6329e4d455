//! Edge lengths made safe for cotangents.

use crate::ids::FaceId;
use crate::intrinsic::{IntrinsicMesh, Link};

/// Smallest excess of two sides of a triangle over the third, in mean edge lengths. The height of the flattest
/// triangle is then about a thousandth of its base, and no cotangent exceeds a million.
const SLACK: f64 = 1e-6;

/// Rounds of shortening. Lengths of a surface in space need none.
const MAX_ROUNDS: usize = 16;

/// The lengths of a surface in units of their mean, corrected so that every face has an area.
#[derive(Debug, Clone)]
pub struct Metric {
    /// Mean length of edges and links, in mesh units; zero when all are zero.
    pub unit: f64,
    /// The length of every edge, in units; positive.
    pub edges: Vec<f64>,
    /// The links, their lengths in units; positive.
    pub links: Vec<Link>,
}

impl Metric {
    /// Corrects the lengths of a surface.
    ///
    /// * An edge longer than the two other sides of one of its faces, which no surface in space has, is cut to their
    ///   sum: that is the distance between its ends.
    /// * If two sides of a face exceed the third by less than 1e-6, all edges grow by the missing amount (intrinsic
    ///   mollification, Sharp and Crane 2020).
    pub fn new(mesh: &IntrinsicMesh) -> Self {
        let all = || mesh.edge_lengths().iter().copied().chain(mesh.links().iter().map(|link| link.length));
        let longest = all().fold(0.0, f64::max);
        // Relative to the longest, so that no sum overflows.
        let mean = all().map(|length| length / longest).sum::<f64>() / all().count() as f64;
        let unit = if longest > 0.0 { mean * longest } else { 0.0 };
        let scaled = |length: f64| if unit > 0.0 { length / unit } else { 0.0 };
        let mut edges: Vec<f64> = mesh.edge_lengths().iter().map(|length| scaled(*length)).collect();
        for _ in 0..MAX_ROUNDS {
            if !shorten(mesh, &mut edges) {
                break;
            }
        }
        let lacking = sides(mesh).map(|[a, b, c]| SLACK - excess([edges[a], edges[b], edges[c]]));
        let growth = lacking.fold(0.0, f64::max);
        edges.iter_mut().for_each(|length| *length += growth);
        let links = mesh.links().iter().map(|link| Link { length: scaled(link.length).max(SLACK), ..*link });
        Self { unit, links: links.collect(), edges }
    }
}

fn sides(mesh: &IntrinsicMesh) -> impl Iterator<Item = [usize; 3]> {
    let topology = mesh.topology();
    (0..topology.n_faces())
        .map(|f| FaceId::from(f).corners().map(|corner| topology.opposite_edge(corner).index()))
}

/// By how much the shorter two sides exceed the longest.
fn excess([a, b, c]: [f64; 3]) -> f64 {
    (b - a + c).min(c - b + a).min(a - c + b)
}

/// Cuts each length that exceeds the sum of the two others in a face; returns whether there was any.
fn shorten(mesh: &IntrinsicMesh, edges: &mut [f64]) -> bool {
    let mut any = false;
    for [a, b, c] in sides(mesh) {
        for (long, i, j) in [(a, b, c), (b, c, a), (c, a, b)] {
            let around = edges[i] + edges[j];
            if edges[long] > around {
                // Rounding is not worth another round.
                any |= edges[long] > around * (1.0 + 1e-12);
                edges[long] = around;
            }
        }
    }
    any
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Topology, VertexId};

    fn strip(lengths: Vec<f64>) -> IntrinsicMesh {
        // Edges in order: 01, 02, 12, 13, 23.
        let faces = [[0, 1, 2], [2, 1, 3]].map(|f: [u32; 3]| f.map(VertexId)).to_vec();
        IntrinsicMesh::new(Topology::new(4, faces), lengths)
    }

    #[test]
    fn good_triangles_are_scaled_and_nothing_else() {
        let metric = Metric::new(&strip(vec![3.0, 4.0, 5.0, 4.0, 4.0]));
        assert_eq!(metric.unit, 4.0);
        assert_eq!(metric.edges, [0.75, 1.0, 1.25, 1.0, 1.0]);
    }

    #[test]
    fn every_face_of_any_lengths_is_a_triangle() {
        for lengths in [
            vec![0.0; 5],
            vec![1.0, 1.0, 2.0, 1.0, 1.0],
            vec![1.0, 1.0, 1e9, 1.0, 1.0],
            vec![1.0, 1.0, 0.0, 1.0, 1.0],
            vec![1.0, 0.0, 0.0, 7.0, 0.0],
            vec![f64::MAX; 5],
            vec![f64::MAX, f64::MIN_POSITIVE, 1.0, 5e-324, f64::MAX],
            vec![5e-324; 5],
        ] {
            let mesh = strip(lengths.clone());
            let Metric { edges, unit, .. } = Metric::new(&mesh);
            assert!(unit.is_finite(), "{lengths:?}");
            for [a, b, c] in sides(&mesh) {
                let excess = excess([edges[a], edges[b], edges[c]]);
                assert!(excess >= 0.99 * SLACK && edges[a] < 1e9, "{lengths:?} became {edges:?}");
            }
        }
    }

    #[test]
    fn a_length_beyond_the_sum_of_the_two_others_is_cut_to_it() {
        let metric = Metric::new(&strip(vec![1.0, 1.0, 9.0, 1.0, 1.0]));
        let shared = metric.edges[2] / metric.edges[0];
        assert!((shared - 2.0).abs() < 1e-4, "{shared}");
    }
}
