//! Maps of functions, and how maps of points follow from them.

use linalg::Matrix;
use nalgebra::Cholesky;

use crate::nearest_rows::nearest_rows;

/// A map of points of a surface to those of another, and one back: positions in the lists of samples, or vertices.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TwoWayMap {
    pub(crate) forth: Vec<usize>,
    pub(crate) back: Vec<usize>,
}

/// Eigenfunctions at the samples of two surfaces, evenly spread, one row for each sample.
#[derive(Debug)]
pub(crate) struct SampledPair {
    pub(crate) a: Matrix,
    pub(crate) b: Matrix,
    /// Eigenfunctions at landmarks, which correspond row by row.
    pub(crate) landmarks: [Matrix; 2],
}

impl SampledPair {
    pub(crate) fn new(a: Matrix, b: Matrix) -> Self {
        let landmarks = [&a, &b].map(|of| Matrix::zeros(0, of.ncols()));
        Self { a, b, landmarks }
    }
}

/// The maps of functions that follow from maps of points, with `k` eigenfunctions on each side.
#[derive(Debug, Clone)]
pub(crate) struct FunctionalMaps {
    /// `C`, k x k: coefficients on the first surface of the eigenfunctions of the second, pulled back by `forth`.
    pub(crate) forth: Matrix,
    /// `D`, k x k: coefficients on the second surface of the eigenfunctions of the first, pulled back by `back`.
    pub(crate) back: Matrix,
}

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
        let [of_a, of_b] = &pair.landmarks;
        let one = |own: &Matrix, other: &Matrix, map: &[usize], [x, y]: [&Matrix; 2]| {
            let (own, other) = (own.columns(0, k).into_owned(), other.columns(0, k).select_rows(map));
            coefficients(&below(own, &x.columns(0, k)), &below(other, &y.columns(0, k)))
        };
        Self {
            forth: one(&pair.a, &pair.b, &maps.forth, [of_a, of_b]),
            back: one(&pair.b, &pair.a, &maps.back, [of_b, of_a]),
        }
    }

    /// Number of eigenfunctions.
    pub(crate) fn k(&self) -> usize {
        self.forth.nrows()
    }

    /// How far both maps are from orthogonal ones: `(|C'C - I|² + |D'D - I|²) / k`. Isometries have 0.
    pub(crate) fn defect(&self) -> f64 {
        let one = |map: &Matrix| (map.tr_mul(map) - Matrix::identity(self.k(), self.k())).norm_squared();
        (one(&self.forth) + one(&self.back)) / self.k() as f64
    }

    /// Places of points of the first surface, near those of the points of the second to which they correspond, by both
    /// maps: `[Φ, Φ D']`.
    pub(crate) fn places_a(&self, rows: &Matrix) -> Matrix {
        let own = rows.columns(0, self.k());
        beside(own.into_owned(), own * self.back.transpose())
    }

    /// Places of points of the second surface: `[Ψ C', Ψ]`.
    pub(crate) fn places_b(&self, rows: &Matrix) -> Matrix {
        let own = rows.columns(0, self.k());
        beside(own * self.forth.transpose(), own.into_owned())
    }

    /// Places of all vertices of both surfaces, by their eigenfunctions.
    pub(crate) fn placed(&self, [a, b]: [&Matrix; 2]) -> [Matrix; 2] {
        [self.places_a(a), self.places_b(b)]
    }

    /// The maps of samples that follow.
    pub(crate) fn sample_maps(&self, pair: &SampledPair) -> TwoWayMap {
        let [forth, back] = nearest_rows(&self.places_a(&pair.a), &self.places_b(&pair.b));
        TwoWayMap { forth, back }
    }

    /// These maps, followed by others.
    pub(crate) fn then(&self, next: &Self) -> Self {
        let k = self.k().min(next.k());
        let product = |x: &Matrix, y: &Matrix| x.view((0, 0), (k, k)) * y.view((0, 0), (k, k));
        Self { forth: product(&self.forth, &next.forth), back: product(&next.back, &self.back) }
    }
}

/// A map of functions, and its transpose for the one back.
impl From<Matrix> for FunctionalMaps {
    fn from(forth: Matrix) -> Self {
        Self { back: forth.transpose(), forth }
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
