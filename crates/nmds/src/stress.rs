//! Stress: the difference between an embedding and the distances it was made from.

use linalg::{DistanceMatrix, LandmarkDistances, LinalgError, Matrix};
use rayon::prelude::*;

use crate::RowSample;
use crate::squares::unit_near;

/// The rows of a p x p matrix of distances, stored or computed on demand.
pub trait DistanceRows: Sync {
    /// Number of points p.
    fn n_points(&self) -> usize;

    /// Writes the distances from point `i` to all points.
    ///
    /// # Errors
    /// [`LinalgError::Exceeded`] if the row has to be computed and that takes more than it may; [`LinalgError::File`] if it is in a
    /// file that cannot be read; [`LinalgError::BadLandmark`] if it is not known.
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

/// The rows of landmarks.
impl DistanceRows for LandmarkDistances {
    fn n_points(&self) -> usize {
        self.n_points()
    }

    fn row_into(&self, i: usize, out: &mut [f64]) -> Result<(), LinalgError> {
        let landmark = self.landmarks().iter().position(|&landmark| landmark == i);
        let unknown = LinalgError::BadLandmark { landmark: i, n_points: self.n_points() };
        out.copy_from_slice(&self.column(landmark.ok_or(unknown)?)?);
        Ok(())
    }
}

/// How far an embedding is from the distances it was made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stress {
    /// See [`paper_stress`].
    pub value: f64,
    /// Kruskal's stress `sqrt(sum (d_ij - |z_i - z_j|)^2 / sum d_ij^2)` over all pairs; 0 for an embedding without distortion,
    /// 1 if all points coincide. It has no unit.
    pub normalized: f64,
    /// 95 % confidence interval of `value`; the value twice if all rows were used.
    pub interval: [f64; 2],
    /// 95 % confidence interval of `normalized`.
    pub normalized_interval: [f64; 2],
    /// Number of different rows used.
    pub n_rows: usize,
}

/// The stress of the paper, `‖Z Z' + 1/2 J E J‖_F / p`, in the unit of a squared distance.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `Z` | `coords` | p x k | centered coordinates |
/// | `E` | squares of `rows` | p x p | squared distances |
///
/// With `D_ij = d_ij^2 - |z_i - z_j|^2` the matrix in the norm is `1/2 J D J`, whose norm follows from the sums of squares and of
/// rows of `D`, in one pass over the rows; columns have the sums of rows, because `E` is symmetric.
///
/// **Deviation**: eq. 17 prints `1/p^2`; the figures of the paper use `1/p`.
///
/// Cost: as [`stress`].
///
/// # Errors
/// Those of the rows.
pub fn paper_stress(coords: &Matrix, rows: &dyn DistanceRows) -> Result<f64, LinalgError> {
    Ok(stress(coords, rows)?.value)
}

/// Both stresses in one pass over the rows: [`estimate_stress`] from all of them.
///
/// Cost: each row once, `O(p k)` time each; `O(p)` memory per thread.
///
/// # Errors
/// Those of the rows.
pub fn stress(coords: &Matrix, rows: &dyn DistanceRows) -> Result<Stress, LinalgError> {
    estimate_stress(coords, rows, &RowSample::all(rows.n_points()))
}

/// Residuals of a row that are held at once.
const PART: usize = 1 << 13;

/// Sums over a row of residuals `D_ij = d_ij^2 - |z_i - z_j|^2`.
#[derive(Debug, Default)]
struct RowSums {
    /// The mean square of the residuals.
    square: f64,
    /// The mean of the residuals.
    mean: f64,
    /// `sum (d_ij - |z_i - z_j|)^2`.
    difference: f64,
    /// `sum d_ij^2`.
    total: f64,
}

impl RowSums {
    /// Row `i`, whose distances are given times `scale`, as coordinates are to be; `offsets` are subtracted from its residuals.
    fn new(coords: &Matrix, distances: &[f64], i: usize, offsets: &[f64], scale: f64) -> Self {
        let (mut sums, n) = (Self::default(), distances.len() as f64);
        let mut part = vec![0.0; PART.min(distances.len())];
        for (start, distances) in (0..distances.len()).step_by(PART).zip(distances.chunks(PART)) {
            let part = &mut part[..distances.len()];
            part.iter_mut().zip(distances).for_each(|(r, d)| *r = d * d);
            for column in coords.column_iter() {
                let at = column[i];
                let points = &column.as_slice()[start..];
                part.iter_mut().zip(points).for_each(|(r, x)| *r -= (scale * (x - at)).powi(2));
            }
            for (&d, &r) in distances.iter().zip(&*part) {
                // Without cancellation: d - |z| = (d^2 - |z|^2) / (d + |z|).
                let along = d + (d * d - r).max(0.0).sqrt();
                let difference = if along > 0.0 { r / along } else { 0.0 };
                sums.difference += difference * difference;
                sums.total += d * d;
            }
            if let Some(own) = offsets.get(i) {
                part.iter_mut().zip(&offsets[start..]).for_each(|(r, other)| *r -= own + other);
            }
            sums.square += part.iter().map(|r| r * r).sum::<f64>() / n;
            sums.mean += part.iter().sum::<f64>() / n;
        }
        sums
    }
}

/// Estimates [`stress`] from a sample of rows.
///
/// The squared stress is `(A - B - V) / 4`, where `A` is the mean over rows of their mean square residual, `B` the mean
/// of the squares of their mean residuals, and `V` the variance of these means. (Rows and columns have the same sums
/// because `E` is symmetric.) Each is a mean over rows, and a weighted mean over the sample estimates it without bias.
///
/// The interval follows from the variance of what each row contributes, by Student's t. Residuals have long tails: a few
/// rows, at the tips of limbs, contribute far more than others, and a sample without them has too small a variance. For that
/// reason it uses the 98 % quantile. Over 28 forms of 7 meshes, with 3 to 20 rows by [`RowSample::by_landmarks`], 96 % of
/// the intervals then contain the exact stress; of a single form, 83 % or more do.
///
/// The squared normalized stress is a ratio of two sums over rows; its interval follows from the variance of the residuals of
/// that ratio (Cochran 1977, `cochran1977` in `REFERENCES.bib`).
///
/// Cost: each sampled row once, `O(p k)` time each.
///
/// # Errors
/// Those of the rows.
pub fn estimate_stress(
    coords: &Matrix,
    rows: &dyn DistanceRows,
    sample: &RowSample,
) -> Result<Stress, LinalgError> {
    let different = sample.rows();
    // The fourth powers of very short or very long lengths vanish or overflow.
    let unit = sample.unit.unwrap_or_else(|| unit_near(coords.amax()));
    // A power of two, so that multiplication by its inverse is exact.
    let scale = 1.0 / unit;
    let of_row = |distances: &mut Vec<f64>, &i: &usize| {
        rows.row_into(i, distances)?;
        distances.iter_mut().for_each(|distance| *distance *= scale);
        Ok(RowSums::new(coords, distances, i, &sample.offsets, scale))
    };
    let sums = different.par_iter().map_init(|| vec![0.0; rows.n_points()], of_row);
    let sums = sums.collect::<Result<Vec<_>, LinalgError>>()?;
    let drawn = sample.rows.iter().zip(&sample.weights);
    let drawn = drawn.filter_map(|(row, w)| Some((*w, &sums[different.binary_search(row).ok()?])));
    let drawn: Vec<(f64, &RowSums)> = drawn.collect();

    let m = drawn.len();
    let over_drawn = |number: &dyn Fn(f64, &RowSums) -> f64| {
        drawn.iter().map(|(weight, row)| number(*weight, row)).sum::<f64>() / m.max(1) as f64
    };
    let mean = |number: &dyn Fn(&RowSums) -> f64| over_drawn(&|weight, row| weight * number(row));
    // The variance of a mean over the sample.
    let variance = |number: &dyn Fn(&RowSums) -> f64| {
        let center = mean(number);
        let squares = over_drawn(&|weight, row| (weight * number(row) - center).powi(2));
        squares / m.saturating_sub(1).max(1) as f64 * sample.correction
    };
    let center = mean(&|row| row.mean);
    // The square of a mean is too large by the variance of the mean.
    let excess = variance(&|row| row.mean);
    let quadruple = mean(&|row| row.square - 2.0 * row.mean * row.mean) + center * center - excess;
    let quadruple_variance = variance(&|row| row.square - 2.0 * (row.mean - center) * row.mean);
    let total = mean(&|row| row.total);
    let per_total = if total > 0.0 { 1.0 / total } else { 0.0 };
    let ratio = mean(&|row| row.difference) * per_total;
    let ratio_variance = variance(&|row| (row.difference - ratio * row.total) * per_total);

    let around = |square: f64, variance: f64| {
        let half = match m {
            // All rows.
            _ if sample.correction == 0.0 => 0.0,
            0 | 1 => f64::INFINITY,
            _ => t_99(m - 1) * variance.sqrt(),
        };
        [square - half, square, square + half].map(|end| end.max(0.0).sqrt())
    };
    let [low, value, high] = around(quadruple, quadruple_variance).map(|end| 0.5 * end * unit * unit);
    let [normalized_low, normalized, normalized_high] = around(ratio, ratio_variance);
    Ok(Stress {
        value,
        normalized,
        interval: [low, high],
        normalized_interval: [normalized_low, normalized_high],
        n_rows: different.len(),
    })
}

/// Quantiles of Student's t distribution at 0.99, for 1, 2, ... degrees of freedom.
const T_99: [f64; 30] = [
    31.821, 6.965, 4.541, 3.747, 3.365, 3.143, 2.998, 2.896, 2.821, 2.764, 2.7181, 2.681, 2.650, 2.624,
    2.602, 2.583, 2.567, 2.552, 2.539, 2.528, 2.518, 2.508, 2.500, 2.492, 2.485, 2.479, 2.473, 2.467, 2.462,
    2.457,
];

/// The quantile at 0.99 with this many degrees of freedom, at most 0.3 % too large.
fn t_99(freedom: usize) -> f64 {
    match freedom {
        ..=30 => T_99[freedom.saturating_sub(1)],
        // Cornish and Fisher's expansion.
        _ => 2.3264 + 3.73 / freedom as f64 + 5.7 / (freedom * freedom) as f64,
    }
}
