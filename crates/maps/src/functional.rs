//! Maps of functions, and how maps of points follow from them.

use linalg::Matrix;
use nalgebra::Cholesky;

use crate::nearest_rows::nearest_rows;

/// A map of points of a surface to those of another, and one back: positions in the lists of samples, or vertices.
pub(crate) type TwoWayMap = [Vec<usize>; 2];

/// Eigenfunctions at points of two surfaces, evenly spread, one row for each point.
#[derive(Debug)]
pub(crate) struct SampledPair {
    pub(crate) rows: [Matrix; 2],
    /// Eigenfunctions at landmarks, which correspond row by row.
    pub(crate) landmarks: [Matrix; 2],
}

impl SampledPair {
    pub(crate) fn new(rows: [Matrix; 2]) -> Self {
        let landmarks = rows.each_ref().map(|of| Matrix::zeros(0, of.ncols()));
        Self { rows, landmarks }
    }

    /// The number of points of the side that has fewer.
    pub(crate) fn n_points(&self) -> usize {
        self.rows[0].nrows().min(self.rows[1].nrows())
    }

    /// The number of eigenfunctions of the side that has fewer.
    pub(crate) fn n_functions(&self) -> usize {
        self.rows[0].ncols().min(self.rows[1].ncols())
    }
}

/// The maps of functions that follow from maps of points, with `k` eigenfunctions on each side.
///
/// * `C`, k x k: coefficients on the first surface of the eigenfunctions of the second, pulled back by the map to the second;
/// * `D`, k x k: coefficients on the second surface of the eigenfunctions of the first, pulled back by the map to the first.
#[derive(Debug, Clone)]
pub(crate) struct FunctionalMaps([Matrix; 2]);

/// The coefficients, by least squares over evenly spread samples, of as many functions in the first eigenfunctions.
fn coefficients(eigenfunctions: &Matrix, functions: &Matrix) -> Matrix {
    let own = eigenfunctions.columns(0, functions.ncols());
    let transposed = own.transpose();
    let (gram, right) = (&transposed * own, transposed * functions);
    match Cholesky::new(gram) {
        Some(factor) => factor.solve(&right),
        // As many functions as samples, or more.
        None => right / functions.nrows() as f64,
    }
}

impl FunctionalMaps {
    /// The maps of functions by least squares over the samples.
    pub(crate) fn new(pair: &SampledPair, maps: &TwoWayMap, k: usize) -> Self {
        let one = |side: usize| {
            let [own, other] = [side, 1 - side].map(|side| pair.rows[side].columns(0, k));
            let [x, y] = [side, 1 - side].map(|side| pair.landmarks[side].columns(0, k));
            coefficients(&below(own.into_owned(), &x), &below(other.select_rows(&maps[side]), &y))
        };
        Self([one(0), one(1)])
    }

    /// `C`.
    pub(crate) fn to_first(&self) -> &Matrix {
        &self.0[0]
    }

    /// Number of eigenfunctions.
    pub(crate) fn k(&self) -> usize {
        self.0[0].nrows()
    }

    /// How far both maps are from orthogonal ones: `(|C'C - I|² + |D'D - I|²) / k`. Isometries have 0.
    pub(crate) fn defect(&self) -> f64 {
        let one = |map: &Matrix| (map.tr_mul(map) - Matrix::identity(self.k(), self.k())).norm_squared();
        self.0.iter().map(one).sum::<f64>() / self.k() as f64
    }

    /// Places of points of one surface, near those of the points of the other to which they correspond, by both maps: `[Φ, Φ D']`
    /// of the first (0), `[Ψ C', Ψ]` of the second (1).
    pub(crate) fn places(&self, side: usize, rows: &Matrix) -> Matrix {
        let own = rows.columns(0, self.k());
        let other = own * self.0[1 - side].transpose();
        if side == 0 { beside(own.into_owned(), other) } else { beside(other, own.into_owned()) }
    }

    /// The same for points of both surfaces.
    pub(crate) fn placed(&self, rows: [&Matrix; 2]) -> [Matrix; 2] {
        [0, 1].map(|side| self.places(side, rows[side]))
    }

    /// The maps of samples that follow.
    pub(crate) fn sample_maps(&self, pair: &SampledPair) -> TwoWayMap {
        let [a, b] = self.placed(pair.rows.each_ref());
        nearest_rows(&a, &b)
    }

    /// These maps, followed by others.
    pub(crate) fn then(&self, next: &Self) -> Self {
        let k = self.k().min(next.k());
        let product = |x: &Matrix, y: &Matrix| x.view((0, 0), (k, k)) * y.view((0, 0), (k, k));
        Self([product(&self.0[0], &next.0[0]), product(&next.0[1], &self.0[1])])
    }
}

/// A map of functions, and its transpose for the one back.
impl From<Matrix> for FunctionalMaps {
    fn from(map: Matrix) -> Self {
        let back = map.transpose();
        Self([map, back])
    }
}

/// The rows of both matrices.
fn below(upper: Matrix, lower: &nalgebra::DMatrixView<'_, f64>) -> Matrix {
    let n = upper.nrows();
    let mut both = upper.resize_vertically(n + lower.nrows(), 0.0);
    both.rows_mut(n, lower.nrows()).copy_from(lower);
    both
}

/// The columns of both matrices.
fn beside(left: Matrix, right: Matrix) -> Matrix {
    let k = left.ncols();
    let mut both = left.resize_horizontally(k + right.ncols(), 0.0);
    both.columns_mut(k, right.ncols()).copy_from(&right);
    both
}
