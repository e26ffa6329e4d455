//! Laws of exact distances.

mod closed_forms;
mod degenerate;
mod log_map;
mod oracle;
mod random;
mod reference;
mod sources;

use surface::{IntrinsicMesh, Topology, VertexId};

use super::Exact;
use crate::DistanceSolver;
use crate::tests::{assert_close, bumpy, faces, points, spatial};

/// The matrix of all distances, one row a source.
fn all_pairs(mesh: &IntrinsicMesh) -> Vec<Vec<f64>> {
    let exact = Exact::new(mesh, &());
    (0..mesh.n_vertices()).map(|v| exact.distances(VertexId::from(v)).unwrap()).collect()
}

/// Distance of two points at these distances from the origin, at this angle.
fn apart(p: f64, q: f64, angle: f64) -> f64 {
    ((p - q).powi(2) + 4.0 * p * q * (0.5 * angle).sin().powi(2)).sqrt()
}

/// Flat rings of `n` sectors around vertex 0 with this total angle, closed or open, by their lengths alone, and the polar
/// coordinates of the vertices on the surface.
fn cone(n: usize, total: f64, n_rings: usize, is_closed: bool) -> (IntrinsicMesh, Vec<[f64; 2]>) {
    let spokes = if is_closed { n } else { n + 1 };
    let at = |ring: usize, sector: usize| VertexId::from(1 + ring * spokes + sector % spokes);
    let (mut faces, mut polar) = (Vec::new(), vec![[0.0; 2]]);
    for r in 0..n_rings {
        polar.extend((0..spokes).map(|s| [(r + 1) as f64, total * s as f64 / n as f64]));
        for s in 0..n {
            match r {
                0 => faces.push([VertexId(0), at(0, s), at(0, s + 1)]),
                _ => faces.extend([
                    [at(r - 1, s), at(r, s), at(r, s + 1)],
                    [at(r - 1, s), at(r, s + 1), at(r - 1, s + 1)],
                ]),
            }
        }
    }
    let length = |ends: [VertexId; 2]| {
        let [[p, a], [q, b]] = ends.map(|v| polar[v.index()]);
        let angle = if p * q == 0.0 { 0.0 } else { (a - b).abs() };
        apart(p, q, if is_closed { angle.min(total - angle) } else { angle })
    };
    (IntrinsicMesh::with_lengths(Topology::new(polar.len(), faces), length), polar)
}
