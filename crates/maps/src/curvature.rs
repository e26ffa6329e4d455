//! The curvature of a surface, which tells its inside from its outside.

use linalg::{EliminationOrder, LinalgError, Matrix, SparseCholesky, SparseSymmetric};
use mesh::TriMesh;
use nalgebra::DVector;
use surface::EdgeId;
use surface::laplacian::Laplacian;

/// Times of heat by which a function is smoothed, at unit area. A convention: bumps of 3 to 10 % of the square root of the
/// area are left.
pub(crate) const TIMES: [f64; 3] = [0.001, 0.003, 0.01];

/// A function at some points, such as the mean curvature, smoothed by heat: a row for each point, a column for each time.
/// `coefficients` are those of the function in the eigenfunctions, `values` the eigenvalues and `vectors` the eigenfunctions at
/// these points; times are those at unit area, times `factor`.
pub(crate) fn smoothed(coefficients: &DVector<f64>, values: &[f64], vectors: &Matrix, factor: f64) -> Matrix {
    let mut found = Matrix::zeros(vectors.nrows(), TIMES.len());
    for (mut column, time) in found.column_iter_mut().zip(TIMES) {
        let left = values.iter().map(|value| (-time * factor * value).exp());
        let left = DVector::from_iterator(coefficients.len(), left).component_mul(coefficients);
        column.copy_from(&(vectors * left));
    }
    found
}

/// Four times the mean curvature, integrated around every vertex: the bend of each edge, which is its length times the angle
/// between the normals of its faces, goes to both ends (Cohen-Steiner and Morvan 2003, `cohensteiner2003` in
/// `REFERENCES.bib`). `outward` has its normals outwards.
pub(crate) fn bends(outward: &TriMesh) -> DVector<f64> {
    let topology = outward.topology();
    let mut sums = DVector::zeros(outward.n_vertices());
    for (e, ends) in topology.edges().iter().enumerate() {
        let &[corner, opposite] = topology.edge_corners(EdgeId::from(e)) else { continue };
        let [m, n] = [corner, opposite].map(|corner| outward.area_vector(corner.face().index()));
        let [p, q] = ends.map(|v| outward.positions[v.index()]);
        let tip = outward.positions[topology.corner_vertex(opposite).index()];
        // Convex if the other face lies below this one.
        let sign = if m.dot(&(tip - p)) < 0.0 { 1.0 } else { -1.0 };
        let bend = sign * (q - p).norm() * m.cross(&n).norm().atan2(m.dot(&n));
        ends.iter().for_each(|v| sums[v.index()] += bend);
    }
    sums
}

/// The mean curvature that fine curvature is clipped to, at unit area, so that the flat of a body counts as much as its edges. Chosen on
/// all pairs of two scanned persons that decision 19 measures, as was the time of heat: the least.
const CREASE: f64 = 15.0;

/// The mean curvature at all vertices, up to a factor, clipped and smoothed by one implicit step of heat: `(M + t L)⁻¹ M H`. It
/// keeps what [`smoothed`] loses to the number of eigenfunctions.
pub(crate) fn fine_curvature(outward: &TriMesh, bends: &DVector<f64>) -> Result<Vec<f64>, LinalgError> {
    let laplacian = Laplacian::new(&outward.intrinsic());
    let masses = laplacian.masses();
    let [sum, area] = [masses.iter().sum::<f64>(), outward.area()];
    let shares = || masses.iter().map(|mass| mass / sum);
    let scaled = |(i, j, weight)| (i, j, weight * TIMES[0]);
    let mut step = SparseSymmetric::from_entries(masses.len(), laplacian.stiffness_entries().map(scaled));
    step.add_to_diagonal(shares());
    let clipped = |(bend, share): (&f64, f64)| {
        let most = 4.0 * CREASE * share;
        (bend / area.sqrt()).clamp(-most, most)
    };
    let mut found: Vec<f64> = bends.iter().zip(shares()).map(clipped).collect();
    SparseCholesky::new(&EliminationOrder::new(&step, &())?, &step, &())?.solve(&mut found);
    Ok(found)
}

/// One less the correlation of the curvatures of corresponding points, or a rounding error for isometries that do not turn inside
/// out, so that its logarithm and ratios of two are finite. `partners` names a point of the second list for each of the first, as far as they go.
pub(crate) fn mismatch(x: &[f64], y: &[f64], partners: &[usize]) -> f64 {
    let n = partners.len();
    let centered = |values: DVector<f64>| values.add_scalar(-values.mean());
    let x = centered(DVector::from_column_slice(&x[..n]));
    let y = centered(DVector::from_iterator(n, partners.iter().map(|&i| y[i])));
    let scale = x.norm() * y.norm();
    if scale > 0.0 { (1.0 - x.dot(&y) / scale).max(f64::EPSILON) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use descriptors::LaplaceSpectrum;
    use mesh::shapes;

    #[test]
    fn equal_curvatures_match_up_to_rounding_and_opposite_ones_do_not() {
        let partners: Vec<usize> = (0..300).collect();
        for seed in 0..50 {
            let values: Vec<f64> = partners.iter().map(|&i| 9.0 + ((i * i + seed) as f64).sin()).collect();
            let opposite: Vec<f64> = values.iter().map(|x| -x).collect();
            let equal = mismatch(&values, &values, &partners);
            assert!(equal > 0.0 && equal < 1e-14, "{equal}");
            assert!((mismatch(&values, &opposite, &partners) - 2.0).abs() < 1e-14);
        }
    }

    #[test]
    fn a_ball_bulges_evenly_and_a_ring_bulges_outside() {
        let of = |mesh: &TriMesh| {
            let spectrum = LaplaceSpectrum::new(&mesh.intrinsic(), 60, &()).unwrap();
            smoothed(&(spectrum.vectors.transpose() * bends(mesh)), &spectrum.values, &spectrum.vectors, 1.0)
        };
        let ball = of(&shapes::icosphere(4));
        assert!(ball.min() > 0.0 && ball.max() < 1.05 * ball.min(), "{} to {}", ball.min(), ball.max());
        // Four over the radius of a ball of area 1.
        let sphere = shapes::icosphere(4);
        let fine = fine_curvature(&sphere, &bends(&sphere)).unwrap();
        let expected = 4.0 * (4.0 * std::f64::consts::PI).sqrt();
        assert!(fine.iter().all(|h| (h / expected - 1.0).abs() < 0.03), "{expected}: {fine:?}");
        // The mean curvature of a ring is 1/2 (1/r + cos(v) / (R + r cos(v))), here with R = 2 and r = 1/2.
        let ring = shapes::torus(80, 40, 2.0, 0.5);
        let found = of(&ring);
        let ratio = |v: usize| {
            let along = ring.positions[v].x.hypot(ring.positions[v].y);
            found[(v, 0)] / (2.0 + 2.0 * (along - 2.0) / along)
        };
        let ratios: Vec<f64> = (0..ring.n_vertices()).map(ratio).collect();
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        assert!(ratios.iter().all(|x| (x / mean - 1.0).abs() < 0.1), "{mean}: {ratios:?}");
    }
}
