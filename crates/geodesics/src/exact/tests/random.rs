//! Random surfaces, non-manifold as a rule.

use proptest::prelude::*;
use surface::IntrinsicMesh;

use super::spatial;

/// Faces over `n` vertices, with their corners in any order.
fn any_faces(n: u32, n_faces: usize) -> impl Strategy<Value = Vec<[u32; 3]>> {
    let face = (0..n, 1..n, 2..n).prop_map(move |(a, b, c)| {
        // The second differs from the first, the third from both.
        let third = if c > b { c } else { c - 1 };
        [a, (a + b) % n, (a + third) % n]
    });
    prop::collection::vec(face, 1..=n_faces)
}

/// Any faces over a few points in space.
pub(super) fn soup(n: u32, n_faces: usize) -> impl Strategy<Value = IntrinsicMesh> {
    let points = prop::collection::vec([-1.0..1.0, -1.0..1.0, -1.0..1.0f64], n as usize);
    (points, any_faces(n, n_faces)).prop_map(|(points, faces)| spatial(&points, &faces))
}

/// The same over different points of a lattice, which are often in one plane, hardly moved: paths meet vertices, and
/// several have the same length. The oracle cannot handle faces without area.
pub(super) fn lattice_soup(n: usize, n_faces: usize) -> impl Strategy<Value = IntrinsicMesh> {
    let points = prop::sample::subsequence((0..18u32).collect::<Vec<_>>(), n).prop_shuffle();
    let moves = prop::collection::vec([-1.0..1.0, -1.0..1.0, -1.0..1.0f64], n);
    let scale = prop_oneof![Just(0.0), Just(1e-15), Just(1e-12), Just(1e-6), Just(1e-3)];
    (points, any_faces(n as u32, n_faces), moves, scale).prop_map(|(points, faces, moves, scale)| {
        let at = |(p, by): (&u32, &[f64; 3])| {
            let lattice = [p % 3, p / 3 % 3, p / 9].map(f64::from);
            [0, 1, 2].map(|i| lattice[i] + scale * by[i])
        };
        let points: Vec<[f64; 3]> = points.iter().zip(&moves).map(at).collect();
        let has_area = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| points[v as usize]);
            let ([p, q, r], [s, t, u]) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
            (q * u - r * t).abs() + (r * s - p * u).abs() + (p * t - q * s).abs() > 0.5
        };
        let faces: Vec<[u32; 3]> = faces.into_iter().filter(has_area).collect();
        spatial(&points, &faces)
    })
}

/// A fan of faces over points in space, two rings around a vertex: a manifold with a saddle or a peak.
pub(super) fn star(n: u32) -> impl Strategy<Value = IntrinsicMesh> {
    prop::collection::vec([0.4..1.6, -1.0..1.0f64], 2 * n as usize).prop_map(move |raw| {
        let mut points = vec![[0.0; 3]];
        for (i, [radius, z]) in raw.iter().enumerate() {
            let (ring, angle) =
                (i as u32 / n, f64::from(i as u32 % n) * std::f64::consts::TAU / f64::from(n));
            let radius = radius + 1.5 * f64::from(ring);
            points.push([radius * angle.cos(), radius * angle.sin(), *z * f64::from(1 + ring)]);
        }
        let mut faces = Vec::new();
        for i in 0..n {
            let (a, b) = (1 + i, 1 + (i + 1) % n);
            faces.extend([[0, a, b], [a, a + n, b + n], [a, b, b + n]]);
        }
        spatial(&points, &faces)
    })
}
