//! Fast multidimensional scaling.

use linalg::{LandmarkDistances, Matrix, SparseCholesky, SparseSymmetric, symmetric_eigen, thin_qr};

use crate::embedding::center_columns;
use crate::{Embedding, NmdsError};

/// Fast multidimensional scaling (FMDS): embeds p points from n columns of distances and the smoothest
/// functions on the surface that have given values at the samples.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `W`, `A` | `stiffness`, `masses` | p x p, p | Laplacian: `A^-1 W`, `A` diagonal |
/// | `R` | | p x n | squared distances to the samples |
/// | `M` | | p x n | column j: least `x' W A^-1 W x` among functions one at sample j, zero at the others |
/// | `Ê` | `(M R' + R M') / 2` | p x p | squared distances, smooth where they are not known |
///
/// `Z = Q U √L` with the `k` algebraically largest eigenpairs `U L U'` of `-1/4 T P T'`, `Q T = J [M R]` and
/// `P = [0 I; I 0]` (Shamai, Aflalo, Zibulevsky and Kimmel 2015, `shamai2015b` in `REFERENCES.bib`).
///
/// * Exact at the samples: their columns of `Ê` are the measured ones where the distances are symmetric.
/// * Distances are relative to their maximum and `M` has no unit, so no unit matters.
/// * Cost one sparse factorisation of `W` and `2 n` solutions, `O(p n^2)` time and `O(p n)` memory beside it.
///
/// **Deviation**: constraints are hard, `M` is one and zero at the samples, so there is no weight to choose. And
/// `M` comes from splines, `M = H C + 1 d'` with `H = W^+ A W^+` at the samples and `1' C = 0`, which equals
/// `-(L_ff)^-1 L_fs` with `L = W A^-1 W` but never squares the condition of `W`.
///
/// # Errors
/// [`NmdsError::PointMismatch`], [`NmdsError::NotDetermined`] when a component of the surface is without a sample,
/// [`NmdsError::BadDimension`], [`NmdsError::NoExtent`], [`NmdsError::Linalg`].
pub fn fmds(
    distances: &LandmarkDistances,
    stiffness: &SparseSymmetric,
    masses: &[f64],
    dim: usize,
) -> Result<Embedding, NmdsError> {
    let (p, n) = distances.matrix().shape();
    for given in [stiffness.order(), masses.len()] {
        if given != p {
            return Err(NmdsError::PointMismatch { given, n_points: p });
        }
    }
    if dim == 0 || dim > n {
        return Err(NmdsError::BadDimension { dim, limit: n });
    }
    let unit = distances.max();
    if unit <= 0.0 {
        return Err(NmdsError::NoExtent { n_points: p });
    }
    let interpolant = interpolant(distances.landmarks(), stiffness, masses)?;
    let mut both = Matrix::zeros(p, 2 * n);
    both.columns_mut(0, n).copy_from(&interpolant);
    both.columns_mut(n, n).copy_from(&distances.matrix().map(|d| (d / unit).powi(2)));
    center_columns(&mut both);
    let (q, t) = thin_qr(&both);
    let cross = t.columns(0, n) * t.columns(n, n).transpose();
    let inner = symmetric_eigen(&((&cross + cross.transpose()) * -0.25))?;
    let columns = q * inner.vectors.columns(0, dim);
    Ok(Embedding::from_orthonormal(columns, inner.values, unit, n))
}

/// `M`, by splines.
fn interpolant(samples: &[usize], stiffness: &SparseSymmetric, masses: &[f64]) -> Result<Matrix, NmdsError> {
    let (p, n) = (masses.len(), samples.len());
    let blocks = Blocks::new(stiffness, masses);
    let factor = SparseCholesky::new(&blocks.grounded(stiffness))?;
    let green = |mut b: Matrix| {
        factor.solve_columns(&mut b);
        blocks.subtract_means(&mut b);
        b
    };
    let mut unit = Matrix::zeros(p, n);
    for (j, &sample) in samples.iter().enumerate() {
        unit[(sample, j)] = 1.0;
        // The right-hand side of a solvable system sums to zero.
        let block = blocks.of[sample];
        let share = if blocks.mass[block] > 0.0 { 1.0 / blocks.mass[block] } else { 0.0 };
        (0..p).filter(|&i| blocks.of[i] == block).for_each(|i| unit[(i, j)] -= share * masses[i]);
    }
    let mut weighted = green(unit);
    weighted.row_iter_mut().zip(masses).for_each(|(mut row, mass)| row *= *mass);
    let splines = green(weighted);

    let count = blocks.mass.len();
    let constants = |rows: &[usize]| {
        Matrix::from_fn(rows.len(), count, |i, k| if blocks.of[rows[i]] == k { 1.0 } else { 0.0 })
    };
    let at_samples = splines.select_rows(samples);
    // Constants of the size of the splines, for pivots to be compared.
    let size = at_samples.amax().max(f64::MIN_POSITIVE);
    let null = constants(samples) * size;
    let mut system = Matrix::zeros(n + count, n + count);
    system.view_mut((0, 0), (n, n)).copy_from(&((&at_samples + at_samples.transpose()) * 0.5));
    system.view_mut((0, n), (n, count)).copy_from(&null);
    system.view_mut((n, 0), (count, n)).copy_from(&null.transpose());
    let solution = system.lu().solve(&Matrix::identity(n + count, n));
    let solution = solution
        .filter(|x| x.iter().all(|v| v.is_finite()))
        .ok_or(NmdsError::NotDetermined { n_landmarks: n })?;
    let everywhere: Vec<usize> = (0..p).collect();
    let mut m = splines * solution.rows(0, n) + constants(&everywhere) * solution.rows(n, count) * size;
    for (j, &sample) in samples.iter().enumerate() {
        m.row_mut(sample).fill(0.0);
        m[(sample, j)] = 1.0;
    }
    Ok(m)
}

/// The connected blocks of a stiffness matrix: it maps a function to zero exactly when that is constant on each.
#[derive(Debug)]
struct Blocks<'a> {
    /// The block of every row.
    of: Vec<usize>,
    /// The mass of every block.
    mass: Vec<f64>,
    masses: &'a [f64],
}

impl<'a> Blocks<'a> {
    fn new(stiffness: &SparseSymmetric, masses: &'a [f64]) -> Self {
        let of = stiffness.blocks();
        let mut mass = vec![0.0; of.iter().max().map_or(0, |last| last + 1)];
        of.iter().zip(masses).for_each(|(&block, m)| mass[block] += m);
        Self { of, mass, masses }
    }

    /// The matrix with the first diagonal entry of each block doubled: definite, and with the same solutions up
    /// to constants where there are any.
    fn grounded(&self, stiffness: &SparseSymmetric) -> SparseSymmetric {
        let mut ground = vec![0.0; self.of.len()];
        let mut next = 0;
        for (row, (block, value)) in self.of.iter().zip(stiffness.diagonal()).enumerate() {
            // Blocks are numbered in the order of their first rows.
            if *block == next {
                ground[row] = if value > 0.0 { value } else { 1.0 };
                next += 1;
            }
        }
        let mut matrix = stiffness.clone();
        matrix.add_to_diagonal(ground.into_iter());
        matrix
    }

    /// Subtracts from each column its mean, by mass, over each block.
    fn subtract_means(&self, columns: &mut Matrix) {
        for mut column in columns.column_iter_mut() {
            let mut sums = vec![0.0; self.mass.len()];
            for ((x, m), &block) in column.iter().zip(self.masses).zip(&self.of) {
                sums[block] += m * x;
            }
            for (x, &block) in column.iter_mut().zip(&self.of) {
                *x -= if self.mass[block] > 0.0 { sums[block] / self.mass[block] } else { 0.0 };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use linalg::DistanceMatrix;

    use super::*;
    use crate::classical_full;

    /// Points at irregular places around a circle: springs as stiff as they are short, masses as long as the
    /// arcs, and distances along the circle of length `2 pi`.
    struct Ring {
        angles: Vec<f64>,
    }

    impl Ring {
        fn new(p: usize) -> Self {
            let step = std::f64::consts::TAU / p as f64;
            Self { angles: (0..p).map(|i| step * (i as f64 + 0.3 * (i as f64 * 1.7).sin())).collect() }
        }

        fn arc(&self, i: usize, j: usize) -> f64 {
            let way = (self.angles[i] - self.angles[j]).abs();
            way.min(std::f64::consts::TAU - way)
        }

        fn laplacian(&self, scale: f64) -> (SparseSymmetric, Vec<f64>) {
            let p = self.angles.len();
            let mut masses = vec![0.0; p];
            let mut entries = Vec::new();
            for i in 0..p {
                let next = (i + 1) % p;
                let length = scale * self.arc(i, next);
                masses[i] += length / 2.0;
                masses[next] += length / 2.0;
                let w = 1.0 / length;
                entries.extend([(i, i, w), (next, next, w), (i, next, -w)]);
            }
            (SparseSymmetric::from_entries(p, entries), masses)
        }

        fn columns(&self, step: usize, distance: impl Fn(f64) -> f64) -> LandmarkDistances {
            let p = self.angles.len();
            let samples: Vec<usize> = (0..p).step_by(step).collect();
            let columns = Matrix::from_fn(p, samples.len(), |i, j| distance(self.arc(i, samples[j])));
            LandmarkDistances::new(samples, columns).unwrap()
        }
    }

    fn gap(a: &Matrix, b: &Matrix) -> f64 {
        let distance = |z: &Matrix, i: usize, j: usize| (z.row(i) - z.row(j)).norm();
        let pairs = (0..a.nrows()).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs.map(|(i, j)| (distance(a, i, j) - distance(b, i, j)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn with_all_samples_it_is_classical_scaling() {
        let ring = Ring::new(25);
        let (w, a) = ring.laplacian(1.0);
        let found = fmds(&ring.columns(1, |d| d), &w, &a, 2).unwrap();
        let all = DistanceMatrix::from_pairs(25, |i, j| ring.arc(i, j)).unwrap();
        assert!(gap(&found.coords, &classical_full(&all, 2).unwrap().coords) < 1e-9);
    }

    #[test]
    fn the_interpolant_solves_its_definition() {
        let ring = Ring::new(40);
        let (w, a) = ring.laplacian(1.0);
        let samples = [0, 7, 13, 22, 31];
        let found = interpolant(&samples, &w, &a).unwrap();
        let mut dense = Matrix::zeros(40, 40);
        for (i, j, value) in w.entries() {
            dense[(i, j)] = value;
            dense[(j, i)] = value;
        }
        let inverse = Matrix::from_diagonal(&a.iter().map(|m| 1.0 / m).collect::<Vec<_>>().into());
        let l = &dense * inverse * &dense;
        let free: Vec<usize> = (0..40).filter(|i| !samples.contains(i)).collect();
        let l_ff = l.select_rows(&free).select_columns(&free);
        let l_fs = l.select_rows(&free).select_columns(&samples);
        let expected = -l_ff.lu().solve(&l_fs).unwrap();
        assert!((found.select_rows(&free) - expected).amax() < 1e-8);
        assert_eq!(found.select_rows(&samples), Matrix::identity(5, 5));
    }

    #[test]
    fn constants_are_kept_on_every_component() {
        let ring = Ring::new(30);
        let (w, a) = ring.laplacian(1.0);
        let twice = w.entries().chain(w.entries().map(|(i, j, v)| (i + 30, j + 30, v)));
        let w = SparseSymmetric::from_entries(60, twice.collect::<Vec<_>>());
        let a = [a.clone(), a].concat();
        let found = interpolant(&[3, 20, 41], &w, &a).unwrap();
        for i in 0..60 {
            let own = if i < 30 { found[(i, 0)] + found[(i, 1)] } else { found[(i, 2)] };
            assert!((own - 1.0).abs() < 1e-10 && (found.row(i).sum() - 1.0).abs() < 1e-10);
        }
        assert_eq!(
            interpolant(&[3, 20], &w, &a).map(|_| ()),
            Err(NmdsError::NotDetermined { n_landmarks: 2 })
        );
    }

    #[test]
    fn chords_of_a_circle_come_back_from_a_few_samples() {
        let ring = Ring::new(160);
        let (w, a) = ring.laplacian(1.0);
        let chord = |arc: f64| 2.0 * (0.5 * arc).sin();
        let worst = |step: usize| {
            let found = fmds(&ring.columns(step, chord), &w, &a, 2).unwrap();
            let pairs = (0..160).flat_map(|i| (0..i).map(move |j| (i, j)));
            let error = |(i, j): (usize, usize)| {
                ((found.coords.row(i) - found.coords.row(j)).norm() - chord(ring.arc(i, j))).abs()
            };
            pairs.map(error).fold(0.0, f64::max)
        };
        // Splines of fourth order.
        assert!(worst(20) < 0.01 && worst(10) < worst(20) / 8.0, "{} {}", worst(20), worst(10));
    }

    #[test]
    fn no_unit_matters() {
        let ring = Ring::new(90);
        let (w, a) = ring.laplacian(1.0);
        let base = fmds(&ring.columns(9, |d| d), &w, &a, 2).unwrap();
        for scale in [1e-3, 1e3] {
            let (w, a) = ring.laplacian(scale);
            let found = fmds(&ring.columns(9, |d| scale * d), &w, &a, 2).unwrap();
            assert!(gap(&(found.coords / scale), &base.coords) < 1e-9);
        }
    }

    #[test]
    fn impossible_requests_are_refused() {
        let ring = Ring::new(12);
        let (w, a) = ring.laplacian(1.0);
        let distances = ring.columns(3, |d| d);
        for dim in [0, 5] {
            let refused = fmds(&distances, &w, &a, dim);
            assert_eq!(refused, Err(NmdsError::BadDimension { dim, limit: 4 }));
        }
        let refused = fmds(&distances, &w, &a[1..], 2);
        assert_eq!(refused, Err(NmdsError::PointMismatch { given: 11, n_points: 12 }));
        let nothing = LandmarkDistances::new(vec![0, 1, 2], Matrix::zeros(12, 3)).unwrap();
        assert_eq!(fmds(&nothing, &w, &a, 2), Err(NmdsError::NoExtent { n_points: 12 }));
    }
}
