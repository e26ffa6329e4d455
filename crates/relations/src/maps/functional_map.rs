//! Maps of functions, and how maps of points follow from them.

use linalg::Matrix;
use nalgebra::Cholesky;

use super::nearest_rows::nearest_rows;

/// A map of points of a surface to those of another, and one back: positions in the lists of samples, or vertices.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct TwoWayMap {
    pub(super) forth: Vec<usize>,
    pub(super) back: Vec<usize>,
}

/// Eigenfunctions at the samples of two surfaces, evenly spread, one row for each sample.
#[derive(Debug)]
pub(super) struct SampledPair {
    pub(super) a: Matrix,
    pub(super) b: Matrix,
    /// Eigenfunctions at landmarks, which correspond row by row.
    pub(super) landmarks: [Matrix; 2],
}

impl SampledPair {
    pub(super) fn new(a: Matrix, b: Matrix) -> Self {
        let landmarks = [&a, &b].map(|of| Matrix::zeros(0, of.ncols()));
        Self { a, b, landmarks }
    }
}

/// The maps of functions that follow from maps of points, with `k` eigenfunctions on each side.
#[derive(Debug, Clone)]
pub(super) struct FunctionalMaps {
    /// `C`, k x k: coefficients on the first surface of the eigenfunctions of the second, pulled back by `forth`.
    pub(super) forth: Matrix,
    /// `D`, k x k: coefficients on the second surface of the eigenfunctions of the first, pulled back by `back`.
    pub(super) back: Matrix,
}

/// Leading eigenfunctions of each surface by which the nearest samples of a vertex are found. A safety limit.
const COARSE: usize = 40;

/// Two surfaces in one space, a row for each vertex.
pub(super) struct Placed {
    pub(super) on_a: Matrix,
    pub(super) on_b: Matrix,
    /// Leading columns, by which [`Cells`](super::nearest_rows::Cells) are found.
    pub(super) coarse: Vec<usize>,
}

/// The coefficients, by least squares over evenly spread samples, of as many functions in the first eigenfunctions.
pub(super) fn coefficients(eigenfunctions: &Matrix, functions: &Matrix) -> Matrix {
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
    pub(super) fn new(pair: &SampledPair, maps: &TwoWayMap, k: usize) -> Self {
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
    pub(super) fn k(&self) -> usize {
        self.forth.nrows()
    }

    /// How far both maps are from orthogonal ones: `(|C'C - I|² + |D'D - I|²) / k`. Isometries have 0.
    pub(super) fn defect(&self) -> f64 {
        let one = |map: &Matrix| (map.tr_mul(map) - Matrix::identity(self.k(), self.k())).norm_squared();
        (one(&self.forth) + one(&self.back)) / self.k() as f64
    }

    /// Places of points of the first surface, near those of the points of the second to which they correspond, by both
    /// maps: `[Φ, Φ D']`.
    pub(super) fn places_a(&self, rows: &Matrix) -> Matrix {
        let own = rows.columns(0, self.k());
        beside(own.into_owned(), own * self.back.transpose())
    }

    /// Places of points of the second surface: `[Ψ C', Ψ]`.
    pub(super) fn places_b(&self, rows: &Matrix) -> Matrix {
        let own = rows.columns(0, self.k());
        beside(own * self.forth.transpose(), own.into_owned())
    }

    /// All vertices of both surfaces, by their eigenfunctions.
    pub(super) fn placed(&self, [a, b]: [&Matrix; 2]) -> Placed {
        let k = self.k();
        let coarse = (0..k.min(COARSE)).flat_map(|j| [j, k + j]).collect();
        Placed { on_a: self.places_a(a), on_b: self.places_b(b), coarse }
    }

    /// A map of functions, and its transpose for the one back.
    pub(super) fn of_one(forth: &Matrix) -> Self {
        Self { back: forth.transpose(), forth: forth.clone() }
    }

    /// The maps of samples that follow.
    pub(super) fn sample_maps(&self, pair: &SampledPair) -> TwoWayMap {
        let [forth, back] = nearest_rows(&self.places_a(&pair.a), &self.places_b(&pair.b));
        TwoWayMap { forth, back }
    }

    /// These maps, followed by others.
    pub(super) fn then(&self, next: &Self) -> Self {
        let k = self.k().min(next.k());
        let product = |x: &Matrix, y: &Matrix| x.view((0, 0), (k, k)) * y.view((0, 0), (k, k));
        Self { forth: product(&self.forth, &next.forth), back: product(&next.back, &self.back) }
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

/// The numbers of eigenfunctions from `first` to `last`: each a step of a tenth, at least two, more than the one before.
pub(super) fn schedule(first: usize, last: usize) -> Vec<usize> {
    let next = |k: &usize| Some(k + (k / 10).max(2)).filter(|next| *next < last);
    let mut counts: Vec<usize> = std::iter::successors(Some(first.min(last)), next).collect();
    if counts.last() != Some(&last) {
        counts.push(last);
    }
    counts
}

/// Refines maps by taking in eigenfunctions of higher and higher frequency (ZoomOut, `melzi2019` in `REFERENCES.bib`).
/// Returns the maps, and the maps of functions that they follow from.
pub(super) fn zoom_out(
    pair: &SampledPair,
    start: TwoWayMap,
    counts: &[usize],
) -> (TwoWayMap, FunctionalMaps) {
    let mut maps = start;
    let mut functional = FunctionalMaps::new(pair, &maps, counts[0]);
    for &k in &counts[1..] {
        maps = functional.sample_maps(pair);
        functional = FunctionalMaps::new(pair, &maps, k);
    }
    (functional.sample_maps(pair), functional)
}
