//! The smallest eigenpairs of a sparse matrix beside a diagonal one.

mod inertia;
mod lanczos;
mod operator;
mod strips;

use self::inertia::n_negative;
use self::lanczos::{Lanczos, Ritz};
use self::operator::{ShiftInverse, shifted};
use crate::{EliminationOrder, LinalgError, Matrix, SparseSymmetric};

/// Largest residual `|C x - theta x| / theta` of a pair that counts as found.
const TOLERANCE: f64 = 1e-9;

/// Pairs that are found beyond those asked for, so that the count can be checked in a gap behind them.
const SPARE: usize = 6;

/// Eigenvalues closer than this share are one cluster.
const CLUSTER: f64 = 1e-6;

/// Where in a gap eigenvalues below are counted; the next if a pivot happens to be zero there.
const CUTS: [f64; 4] = [0.5, 0.45, 0.6, 0.37];

/// How often the search is widened when eigenvalues were missed.
const MAX_ROUNDS: usize = 8;

/// Eigenvalues in ascending order and eigenvectors of `W x = lambda M x`, one column each.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralizedEigen {
    /// Eigenvalues, smallest first.
    pub values: Vec<f64>,
    /// Eigenvectors as columns, in the order of `values`: `X' M X = I`, the largest entry of each positive.
    pub vectors: Matrix,
}

/// The `m` smallest eigenpairs of `W x = lambda M x`, `W` sparse and positive semidefinite, `M` diagonal
/// with entries that are not negative (`masses`); fewer when there are no more.
///
/// A block Lanczos process on `(W + s M)^-1 M` with full orthogonalisation, from a fixed start
/// (Grimes, Lewis and Simon 1994).
///
/// * Residuals `|W x - lambda M x|` are at most `1e-9 (lambda + s)` in the norm of `M^-1`, beside rounding;
///   `s` is about a third of the mean distance between eigenvalues.
/// * Complete: a factorisation counts the eigenvalues below a gap behind those found (Sylvester's law of
///   inertia), and while some are missing, as in clusters larger than the block, the search goes on.
/// * Zero eigenvalues come out as zeros. Rows without mass belong to no pair; their entries follow from the
///   others.
/// * Runs on all threads and does not depend on their number.
///
/// Cost a sparse factorisation, about `2.5 m` solutions and `25 n m^2` operations; `O(n m)` memory.
///
/// # Errors
/// [`LinalgError::NotFactorised`]; [`LinalgError::NotConverged`]; [`LinalgError::MissedEigenvalues`].
///
/// # Panics
/// When there is not one mass for each row.
pub fn smallest_eigenpairs(
    stiffness: &SparseSymmetric,
    masses: &[f64],
    m: usize,
) -> Result<GeneralizedEigen, LinalgError> {
    let n = stiffness.order();
    assert_eq!(masses.len(), n, "one mass for each row");
    if m == 0 || masses.iter().all(|mass| *mass == 0.0) {
        return Ok(GeneralizedEigen { values: Vec::new(), vectors: Matrix::zeros(n, 0) });
    }
    let operator = ShiftInverse::new(stiffness, masses)?;
    let mut process = Lanczos::new(&operator);
    let mut schedule = Schedule::new(m + SPARE);
    let mut rounds = 0;
    loop {
        while process.dim() < schedule.next && !process.is_exhausted() {
            process.step();
        }
        let ritz = process.ritz()?;
        if process.is_exhausted() {
            return Ok(pairs(&operator, &process, &ritz, m));
        }
        if !schedule.is_done(process.dim(), &ritz) {
            continue;
        }
        let values: Vec<f64> = ritz.values()[..m + SPARE].iter().map(|t| operator.unshifted(*t)).collect();
        let gap = gap(&values, m, operator.shift());
        let missing = n_missing(stiffness, masses, operator.order(), gap)?;
        if missing == 0 {
            return Ok(pairs(&operator, &process, &ritz, m));
        }
        rounds += 1;
        if rounds > MAX_ROUNDS {
            return Err(LinalgError::MissedEigenvalues { n, missing, found: gap.0 });
        }
        process.add_random(missing.min(4 * rounds));
        schedule.restart(process.dim());
    }
}

/// When to look at the pairs again.
#[derive(Debug)]
struct Schedule {
    wanted: usize,
    /// Dimension of the basis at which to look next.
    next: usize,
    /// Dimension and largest residual when last looked.
    last: Option<(usize, f64)>,
}

impl Schedule {
    fn new(wanted: usize) -> Self {
        Self { wanted, next: 2 * wanted + 20, last: None }
    }

    /// Whether all wanted pairs are found; when not, sets when to look next: residuals fall exponentially with
    /// the dimension.
    fn is_done(&mut self, dim: usize, ritz: &Ritz) -> bool {
        let worst = (0..self.wanted).map(|j| ritz.residual(j)).fold(0.0, f64::max);
        if worst <= TOLERANCE {
            return true;
        }
        let more = match self.last.replace((dim, worst)) {
            Some((before, residual)) if residual > worst => {
                let rate = (residual / worst).ln() / (dim - before) as f64;
                (1.1 * (worst / TOLERANCE).ln() / rate) as usize
            }
            _ => dim / 8,
        };
        self.next = dim + more.clamp(dim / 32 + 1, dim / 4 + 1);
        false
    }

    /// Looks again after the search was widened at dimension `dim`.
    fn restart(&mut self, dim: usize) {
        self.next = dim + dim / 8 + 1;
        self.last = None;
    }
}

/// An interval without eigenvalues, and how many of the ascending `values` are below it: behind the `m`
/// smallest if there is a gap, else before the cluster that number `m` is in.
fn gap(values: &[f64], m: usize, shift: f64) -> (usize, [f64; 2]) {
    let wide = |i: usize| values[i] - values[i - 1] > CLUSTER * (values[i] + shift);
    match (m..values.len()).find(|&i| wide(i)) {
        Some(i) => (i, [values[i - 1], values[i]]),
        None => {
            let start = (1..m).rev().find(|&i| wide(i)).unwrap_or(0);
            (start, [values[start] - CLUSTER * (values[start] + shift), values[start]])
        }
    }
}

/// How many eigenvalues were missed of those below an interval without any, where `found` were found.
fn n_missing(
    stiffness: &SparseSymmetric,
    masses: &[f64],
    order: &EliminationOrder,
    (found, [from, to]): (usize, [f64; 2]),
) -> Result<usize, LinalgError> {
    for share in CUTS {
        let matrix = shifted(stiffness, masses, -(from + share * (to - from)));
        if let Some(below) = n_negative(order, &matrix)? {
            return Ok(below.saturating_sub(found));
        }
    }
    Err(LinalgError::NotConverged { n: stiffness.order() })
}

/// The `m` smallest pairs of what the process found, rows in the order of the matrix.
fn pairs(operator: &ShiftInverse, process: &Lanczos<'_>, ritz: &Ritz, m: usize) -> GeneralizedEigen {
    let m = m.min(ritz.values().len());
    let values = ritz.values()[..m].iter().map(|theta| operator.unshifted(*theta).max(0.0)).collect();
    // Orthonormal in `s M`.
    let ordered = process.vectors(ritz, m) * operator.shift().sqrt();
    let mut vectors = Matrix::zeros(ordered.nrows(), m);
    for (from, mut to) in ordered.column_iter().zip(vectors.column_iter_mut()) {
        // The first of several entries of the same size decides, so that rounding cannot.
        for (value, &row) in from.iter().zip(operator.order().rows()) {
            to[row] = *value;
        }
        let largest = to.amax();
        if to.iter().find(|x| x.abs() >= 0.999 * largest).is_some_and(|lead| *lead < 0.0) {
            to.neg_mut();
        }
    }
    GeneralizedEigen { values, vectors }
}

#[cfg(test)]
mod tests;
