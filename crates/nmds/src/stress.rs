//! Stress: the difference between an embedding and the distances it was made from.

use std::ops::Add;

use linalg::{DistanceMatrix, LinalgError, Matrix};
use rayon::prelude::*;

/// The rows of a p x p matrix of distances, stored or computed on demand.
pub trait DistanceRows: Sync {
    /// Number of points p.
    fn n_points(&self) -> usize;

    /// Writes the distances from point `i` to all points.
    ///
    /// # Errors
    /// [`LinalgError::Exceeded`] if the row has to be computed and that takes more than it may; [`LinalgError::File`] if it is in a
    /// file that cannot be read.
    fn row_into(&self, i: usize, out: &mut [f64]) -> Result<(), LinalgError>;
}

impl DistanceRows for DistanceMatrix {
    fn n_points(&self) -> usize {
        self.n_points()
    }

    fn row_into(&self, i: usize, out: &mut [f64]) -> Result<(), LinalgError> {
        out.copy_from_slice(self.row(i));
        Ok(())
    }
}

/// Rows in a block of the exact stress. The fixed size fixes the order of summation, so the result does not depend on the
/// number of threads.
const BLOCK: usize = 64;

/// How far an embedding is from the distances it was made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stress {
    /// See [`paper_stress`].
    pub paper: f64,
    /// See [`normalized_stress`].
    pub normalized: f64,
}

/// The stress of the paper, `‖Z Z' + 1/2 J E J‖_F / p`, in the unit of a squared distance.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `Z` | `coords` | p x k | centred coordinates |
/// | `E` | squares of `rows` | p x p | squared distances |
///
/// With `D_ij = d_ij^2 - |z_i - z_j|^2` the matrix in the norm is `1/2 J D J`, whose norm follows from the sums of squares,
/// of rows and of columns of `D`, in one pass over the rows.
///
/// **Deviation**: eq. 17 prints `1/p^2`; the figures of the paper use `1/p`.
///
/// Cost: as [`stress`].
///
/// # Errors
/// Those of the rows.
pub fn paper_stress(coords: &Matrix, rows: &dyn DistanceRows) -> Result<f64, LinalgError> {
    Ok(stress(coords, rows)?.paper)
}

/// [`paper_stress`] and [`normalized_stress`] in one pass over the rows.
///
/// Cost: each row once, `O(p k)` time each; `O(p)` memory per block.
///
/// # Errors
/// Those of the rows.
pub fn stress(coords: &Matrix, rows: &dyn DistanceRows) -> Result<Stress, LinalgError> {
    let p = rows.n_points();
    let starts: Vec<usize> = (0..p).step_by(BLOCK).collect();
    let blocks = starts
        .par_iter()
        .map(|&start| {
            let mut column_sums = vec![0.0; p];
            let (mut row, mut distances) = (vec![0.0; p], vec![0.0; p]);
            let (mut squares, mut row_sums_sq, mut total) = (0.0, 0.0, 0.0);
            let mut kruskal = Kruskal::default();
            for i in start..(start + BLOCK).min(p) {
                rows.row_into(i, &mut distances)?;
                residuals(coords, &distances, i, 0, &mut row);
                kruskal = kruskal + Kruskal::of_row(&distances, &row);
                let sum: f64 = row.iter().sum();
                squares += row.iter().map(|d| d * d).sum::<f64>();
                row_sums_sq += sum * sum;
                total += sum;
                column_sums.iter_mut().zip(&row).for_each(|(c, d)| *c += d);
            }
            Ok((squares, row_sums_sq, total, column_sums, kruskal))
        })
        .collect::<Result<Vec<_>, LinalgError>>()?;
    let mut column_sums = vec![0.0; p];
    let (mut squares, mut row_sums_sq, mut total) = (0.0, 0.0, 0.0);
    let mut kruskal = Kruskal::default();
    for (s, r, t, columns, k) in blocks {
        kruskal = kruskal + k;
        squares += s;
        row_sums_sq += r;
        total += t;
        column_sums.iter_mut().zip(&columns).for_each(|(c, d)| *c += d);
    }
    let column_sums_sq: f64 = column_sums.iter().map(|c| c * c).sum();
    let n = p as f64;
    let norm_sq = squares - (row_sums_sq + column_sums_sq) / n + total * total / (n * n);
    Ok(Stress { paper: 0.5 * norm_sq.max(0.0).sqrt() / n, normalized: kruskal.stress() })
}

/// The sums of Kruskal's stress.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Kruskal {
    /// `sum (d_ij - |z_i - z_j|)^2`.
    pub(crate) residual: f64,
    /// `sum d_ij^2`.
    pub(crate) total: f64,
}

impl Kruskal {
    /// The sums over one row, from distances `d` and residuals `d^2 - |z|^2`.
    pub(crate) fn of_row(distances: &[f64], residuals: &[f64]) -> Self {
        let mut sums = Self::default();
        for (&d, &r) in distances.iter().zip(residuals) {
            // Without cancellation: d - |z| = (d^2 - |z|^2) / (d + |z|).
            let along = d + (d * d - r).max(0.0).sqrt();
            let difference = if along > 0.0 { r / along } else { 0.0 };
            sums.residual += difference * difference;
            sums.total += d * d;
        }
        sums
    }

    pub(crate) fn stress(self) -> f64 {
        if self.total > 0.0 { (self.residual / self.total).sqrt() } else { 0.0 }
    }
}

impl Add for Kruskal {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { residual: self.residual + other.residual, total: self.total + other.total }
    }
}

/// `d_ij^2 - |z_i - z_j|^2` for all `j` from `start` on, for as many as there are `distances`.
pub(crate) fn residuals(coords: &Matrix, distances: &[f64], i: usize, start: usize, out: &mut [f64]) {
    out.iter_mut().zip(distances).for_each(|(r, d)| *r = d * d);
    for column in coords.column_iter() {
        let at = column[i];
        for (d, x) in out.iter_mut().zip(&column.as_slice()[start..]) {
            *d -= (x - at) * (x - at);
        }
    }
}

/// Kruskal's stress `sqrt(sum (d_ij - |z_i - z_j|)^2 / sum d_ij^2)` over all pairs; 0 for an embedding without distortion,
/// 1 if all points coincide. It has no unit.
///
/// Cost: `O(p^2 k)` time on one thread, for small p; [`stress`] finds it faster.
#[must_use]
pub fn normalized_stress(coords: &Matrix, distances: &DistanceMatrix) -> f64 {
    let p = distances.n_points();
    let (mut residual, mut total) = (0.0, 0.0);
    for i in 0..p {
        for j in 0..i {
            let d = distances.get(i, j);
            residual += (d - (coords.row(i) - coords.row(j)).norm()).powi(2);
            total += d * d;
        }
    }
    if total > 0.0 { (residual / total).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::classical;

    fn circle(p: usize) -> DistanceMatrix {
        DistanceMatrix::from_pairs(p, |i, j| (j - i).min(p - (j - i)) as f64).unwrap()
    }

    /// The stress by its definition.
    fn by_definition(coords: &Matrix, distances: &DistanceMatrix) -> f64 {
        let p = distances.n_points();
        let squares = Matrix::from_fn(p, p, |i, j| distances.get(i, j).powi(2));
        let centring = Matrix::identity(p, p).add_scalar(-1.0 / p as f64);
        (coords * coords.transpose() + &centring * squares * &centring * 0.5).norm() / p as f64
    }

    #[test]
    fn equals_its_definition_and_the_norm_of_the_omitted_eigenvalues() {
        let distances = circle(151);
        let embedding = classical(&distances, 3, &()).unwrap();
        let stress = paper_stress(&embedding.coords, &distances).unwrap();
        assert!((stress / by_definition(&embedding.coords, &distances) - 1.0).abs() < 1e-12);
        let all = crate::classical_full(&distances, 3).unwrap().eigenvalues;
        let rest = all[3..].iter().map(|v| v * v).sum::<f64>().sqrt() / 151.0;
        assert!((stress / rest - 1.0).abs() < 1e-9);
    }

    #[test]
    fn normalized_stress_is_zero_for_exact_distances_and_relative_otherwise() {
        let coords = Matrix::from_fn(20, 2, |i, j| ((3 * i + 7 * j) as f64).sin());
        let distance = |i: usize, j: usize| (coords.row(i) - coords.row(j)).norm();
        let exact = DistanceMatrix::from_pairs(20, distance).unwrap();
        assert_eq!(normalized_stress(&coords, &exact), 0.0);
        let stretched = DistanceMatrix::from_pairs(20, |i, j| 1.25 * distance(i, j)).unwrap();
        assert!((normalized_stress(&coords, &stretched) - 0.2).abs() < 1e-14);
    }

    #[test]
    fn does_not_depend_on_the_number_of_threads() {
        let distances = circle(500);
        let embedding = classical(&distances, 2, &()).unwrap();
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| paper_stress(&embedding.coords, &distances).unwrap().to_bits())
        };
        assert_eq!(with(1), with(4));
    }

    #[test]
    fn the_normalised_stress_equals_its_definition_and_has_no_unit() {
        let distances = circle(151);
        let embedding = classical(&distances, 3, &()).unwrap();
        let found = stress(&embedding.coords, &distances).unwrap().normalized;
        assert!((found / normalized_stress(&embedding.coords, &distances) - 1.0).abs() < 1e-12);
        let large = DistanceMatrix::from_pairs(151, |i, j| 1024.0 * distances.get(i, j)).unwrap();
        assert_eq!(stress(&(embedding.coords * 1024.0), &large).unwrap().normalized, found);
        assert_eq!(stress(&Matrix::zeros(151, 3), &distances).unwrap().normalized, 1.0);
    }
}
