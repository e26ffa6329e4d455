//! Stress: the difference between an embedding and the distances it was made from.

use linalg::{DistanceMatrix, LandmarkDistances, LinalgError, Matrix};
use rayon::prelude::*;

use crate::RowSample;

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
    /// See [`normalized_stress`].
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

/// [`paper_stress`] and [`normalized_stress`] in one pass over the rows: [`estimate_stress`] from all of them.
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
    /// Row `i`, with `offsets` subtracted from its residuals.
    fn new(coords: &Matrix, distances: &[f64], i: usize, offsets: &[f64]) -> Self {
        let (mut sums, n) = (Self::default(), distances.len() as f64);
        let mut part = vec![0.0; PART.min(distances.len())];
        for (start, distances) in (0..distances.len()).step_by(PART).zip(distances.chunks(PART)) {
            let part = &mut part[..distances.len()];
            part.iter_mut().zip(distances).for_each(|(r, d)| *r = d * d);
            for column in coords.column_iter() {
                let at = column[i];
                let points = &column.as_slice()[start..];
                part.iter_mut().zip(points).for_each(|(r, x)| *r -= (x - at) * (x - at));
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
    let of_row = |distances: &mut Vec<f64>, &i: &usize| {
        rows.row_into(i, distances)?;
        Ok(RowSums::new(coords, distances, i, &sample.offsets))
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
    let [low, value, high] = around(quadruple, quadruple_variance).map(|end| 0.5 * end);
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

/// Kruskal's stress `sqrt(sum (d_ij - |z_i - z_j|)^2 / sum d_ij^2)` over all pairs; 0 for an embedding without distortion,
/// 1 if all points coincide. It has no unit.
///
/// Cost: `O(p^2 k)` time on one thread, for small p; [`stress`] finds it faster.
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
    use crate::tests::support::Cloud;

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
    fn the_normalized_stress_equals_its_definition_and_has_no_unit() {
        let distances = circle(151);
        let embedding = classical(&distances, 3, &()).unwrap();
        let found = stress(&embedding.coords, &distances).unwrap().normalized;
        assert!((found / normalized_stress(&embedding.coords, &distances) - 1.0).abs() < 1e-12);
        let large = DistanceMatrix::from_pairs(151, |i, j| 1024.0 * distances.get(i, j)).unwrap();
        assert_eq!(stress(&(embedding.coords * 1024.0), &large).unwrap().normalized, found);
        assert_eq!(stress(&Matrix::zeros(151, 3), &distances).unwrap().normalized, 1.0);
    }

    /// Distances that are not Euclidean, their best embedding in the plane, and the distances from 8 of the points.
    fn bent(p: usize) -> (DistanceMatrix, Matrix, LandmarkDistances) {
        let cloud = Cloud::new(p, 3, 21);
        let distances = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j).powf(0.7)).unwrap();
        let coords = classical(&distances, 2, &()).unwrap().coords;
        let landmarks: Vec<usize> = (0..8).map(|j| j * p / 8).collect();
        let columns = Matrix::from_fn(p, 8, |i, j| distances.get(i, landmarks[j]));
        (distances, coords, LandmarkDistances::new(landmarks, columns).unwrap())
    }

    #[test]
    fn estimates_from_all_rows_are_exact() {
        let (distances, coords, landmarks) = bent(300);
        let exact = stress(&coords, &distances).unwrap();
        let all = estimate_stress(&coords, &distances, &RowSample::uniform(300, 1000, 0)).unwrap();
        assert!((all.value / exact.value - 1.0).abs() < 1e-12 && all.n_rows == 300);
        assert!((all.normalized / exact.normalized - 1.0).abs() < 1e-12);
        assert!(all.interval[1] - all.interval[0] < 1e-9 * exact.value);
        assert_eq!(all.normalized_interval[0], all.normalized_interval[1]);
        // Offsets change nothing.
        let offsets = RowSample::by_landmarks(&coords, &landmarks, 1.0, 2, 0).unwrap().offsets;
        let centered = RowSample { offsets, ..RowSample::uniform(300, 300, 0) };
        let centered = estimate_stress(&coords, &distances, &centered).unwrap();
        assert!((centered.value / exact.value - 1.0).abs() < 1e-12);
    }

    #[test]
    fn estimates_are_unbiased_and_intervals_cover_the_exact_stress() {
        let (distances, coords, landmarks) = bent(300);
        let exact = stress(&coords, &distances).unwrap();
        type Draw<'a> = &'a dyn Fn(usize, u64) -> RowSample;
        let uniform: Draw<'_> = &|m, seed| RowSample::uniform(300, m, seed);
        let guided: Draw<'_> = &|m, seed| RowSample::by_landmarks(&coords, &landmarks, 1.0, m, seed).unwrap();
        for (name, draw, m) in [("uniform", uniform, 20), ("guided", guided, 4), ("guided", guided, 20)] {
            let runs = 300;
            let found: Vec<_> =
                (0..runs).map(|seed| estimate_stress(&coords, &distances, &draw(m, seed)).unwrap()).collect();
            let covered = found.iter().filter(|e| (e.interval[0]..=e.interval[1]).contains(&exact.value));
            let covered = covered.count() as f64 / runs as f64;
            let mean_square = found.iter().map(|e| e.value.powi(2)).sum::<f64>() / runs as f64;
            let width = found.iter().map(|e| e.interval[1] - e.interval[0]).sum::<f64>() / runs as f64;
            println!("{name} {m}: {covered:.3} covered, width {:.3}", width / exact.value);
            assert!(covered > 0.93, "{name} {m}: {covered}");
            let within = |e: &&Stress| {
                (e.normalized_interval[0]..=e.normalized_interval[1]).contains(&exact.normalized)
            };
            let covered = found.iter().filter(within).count() as f64 / runs as f64;
            println!("{name} {m}: {covered:.3} of the normalized stress covered");
            assert!(covered > 0.93, "{name} {m}, normalized: {covered}");
            assert!((mean_square / exact.value.powi(2) - 1.0).abs() < 0.05, "{name} {m}");
        }
    }

    #[test]
    fn one_row_has_no_interval() {
        let (distances, coords, landmarks) = bent(50);
        for sample in
            [RowSample::uniform(50, 1, 3), RowSample::by_landmarks(&coords, &landmarks, 1.0, 1, 3).unwrap()]
        {
            let found = estimate_stress(&coords, &distances, &sample).unwrap();
            for interval in [found.interval, found.normalized_interval] {
                assert_eq!(interval, [0.0, f64::INFINITY]);
            }
        }
        let point = DistanceMatrix::from_rows(1, vec![0.0]).unwrap();
        let found = estimate_stress(&Matrix::zeros(1, 2), &point, &RowSample::uniform(1, 4, 0)).unwrap();
        assert_eq!((found.value, found.interval), (0.0, [0.0; 2]));
    }

    #[test]
    fn an_exact_embedding_has_no_stress() {
        let cloud = Cloud::new(60, 2, 4);
        let distances = DistanceMatrix::from_pairs(60, |i, j| cloud.distance(i, j)).unwrap();
        let coords = classical(&distances, 2, &()).unwrap().coords;
        let columns = Matrix::from_fn(60, 5, |i, j| distances.get(i, j));
        let landmarks = LandmarkDistances::new((0..5).collect(), columns).unwrap();
        let sample = RowSample::by_landmarks(&coords, &landmarks, 1.0, 4, 0).unwrap();
        let found = estimate_stress(&coords, &distances, &sample).unwrap();
        assert!(found.value < 1e-6 && found.interval[1] < 1e-6, "{found:?}");
    }

    #[test]
    fn quantiles_decrease_to_that_of_the_normal_distribution() {
        assert!((1..200).all(|f| t_99(f) > t_99(f + 1)));
        assert!((t_99(60) - 2.390).abs() < 0.003 && (t_99(120) - 2.358).abs() < 0.003);
    }
}
