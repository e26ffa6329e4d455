//! The smallest eigenpairs of a pencil of a sparse and a diagonal matrix.

mod inertia;
mod operator;

use base::{Budget, Observer};

use self::inertia::n_negative;
use self::operator::{ShiftInverse, shifted};
use crate::lanczos::{Lanczos, Ritz};
use crate::{EliminationOrder, LinalgError, Matrix, SparseSymmetric, SymmetricEigen, leading_sign};

/// Additional pairs to find, so that the count can be checked in a gap above the requested ones.
const SPARE: usize = 6;

/// Eigenvalues with a relative gap below this belong to one cluster: a safety margin over [`SymmetricEigen::ACCURATE`].
const CLUSTER: f64 = 1e-6;

/// Positions in a gap at which eigenvalues are counted; the next one is tried if a pivot happens to be zero.
const CUTS: [f64; 4] = [0.5, 0.45, 0.6, 0.37];

/// How often the search is extended without finding eigenvalues that a count says are there.
const MAX_ROUNDS: usize = 8;

impl SymmetricEigen {
    /// A tolerance of [`smallest_eigenpairs`] for eigenpairs that others build on.
    pub const ACCURATE: f64 = 1e-9;

    /// A tolerance of [`smallest_eigenpairs`] for what averages over eigenfunctions. The errors of eigenvalues are its square.
    pub const AVERAGED: f64 = 1e-2;
}

/// The `m` smallest eigenpairs of `W x = lambda M x` (fewer if there are no more), with `W` sparse and positive
/// semidefinite (`stiffness`) and `M` diagonal with entries that are not negative (`masses`).
///
/// A block Lanczos process on `(W + s M)^-1 M` with full orthogonalisation, from a fixed start (Grimes, Lewis and Simon
/// 1994).
///
/// * Eigenvalues ascend; `X' M X = I`, and the largest entry of every eigenvector is positive.
/// * Residuals `|W x - lambda M x|` are at most `tolerance (lambda + s)` in the norm of `M^-1`, up to rounding; `s` is about a
///   third of the mean gap between eigenvalues.
/// * Complete: a factorization counts the eigenvalues below a gap above those found (Sylvester's law of inertia), and
///   the search continues while some are missing, as in clusters larger than the block. It ends if several random vectors,
///   each of which has a part of every eigenvector, lead to none: entries of needles differ by so many orders that a pivot can
///   have the wrong sign by rounding.
/// * Zero eigenvalues are returned as zeros. Rows without mass contribute no pair; their entries follow from the others.
/// * Parallel; the result does not depend on the number of threads.
///
/// Cost: a sparse factorization, about `2.5 m` solutions and `25 n m^2` operations; `O(n m)` memory.
///
/// # Errors
/// [`LinalgError::NotFactorized`], [`LinalgError::NotConverged`]; [`LinalgError::Exceeded`] if the budget of the observer is.
///
/// # Panics
/// If the number of masses differs from the order of `stiffness`.
///
/// ```
/// use canonform_linalg::{SparseSymmetric, SymmetricEigen, smallest_eigenpairs};
///
/// // Three unit masses in a row, joined by two unit springs: eigenvalues 0, 1 and 3.
/// let springs = [(0, 0, 1.0), (1, 1, 2.0), (2, 2, 1.0), (0, 1, -1.0), (1, 2, -1.0)];
/// let eigen = smallest_eigenpairs(&SparseSymmetric::from_entries(3, springs), &[1.0; 3], 2, SymmetricEigen::ACCURATE, &())?;
/// assert!(eigen.values[0].abs() < 1e-12 && (eigen.values[1] - 1.0).abs() < 1e-9);
/// # Ok::<(), canonform_linalg::LinalgError>(())
/// ```
pub fn smallest_eigenpairs(
    stiffness: &SparseSymmetric,
    masses: &[f64],
    m: usize,
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<SymmetricEigen, LinalgError> {
    let budget = &observer.budget();
    let n = stiffness.order();
    let m = m.min(n);
    // The basis has at least twice as many vectors as there are pairs.
    budget.check_memory((2 * m).min(n).saturating_mul(n).saturating_mul(size_of::<f64>()))?;
    assert_eq!(masses.len(), n, "one mass for each row");
    if m == 0 || masses.iter().all(|mass| *mass == 0.0) {
        return Ok(SymmetricEigen { values: Vec::new(), vectors: Matrix::zeros(n, 0) });
    }
    let operator = ShiftInverse::new(stiffness, masses, budget)?;
    let mut process = Lanczos::new(&operator);
    let mut schedule = Schedule::new(m + SPARE, tolerance);
    let (mut least, mut rounds) = (usize::MAX, 0);
    loop {
        while process.dim() < schedule.next && !process.is_exhausted() {
            budget.check()?;
            process.step();
        }
        budget.check()?;
        let ritz = process.ritz()?;
        if process.is_exhausted() {
            return Ok(pairs(&operator, &process, &ritz, m));
        }
        if !schedule.is_done(process.dim(), &ritz) {
            continue;
        }
        let values: Vec<f64> =
            ritz.eigen.values[..m + SPARE].iter().map(|t| operator.unshifted(*t)).collect();
        let gap = gap(&values, m, operator.shift);
        let missing = n_missing(stiffness, masses, operator.factor.order(), gap, budget)?;
        if missing < least {
            (least, rounds) = (missing, 0);
        }
        if missing == 0 || rounds == MAX_ROUNDS {
            return Ok(pairs(&operator, &process, &ritz, m));
        }
        rounds += 1;
        process.add_random(missing.min(4 * rounds));
        schedule.restart(process.dim());
    }
}

/// Decides when to compute the pairs of the projected matrix.
#[derive(Debug)]
struct Schedule {
    wanted: usize,
    /// Residual `|C x - theta x| / theta` up to which a pair counts as found.
    tolerance: f64,
    /// Dimension of the basis at which to compute them next.
    next: usize,
    /// Dimension and largest residual of the last time.
    last: Option<(usize, f64)>,
}

impl Schedule {
    fn new(wanted: usize, tolerance: f64) -> Self {
        Self { wanted, tolerance, next: 2 * wanted + 20, last: None }
    }

    /// Whether all wanted pairs are found. If not, schedules the next check, assuming that residuals fall exponentially
    /// with the dimension.
    fn is_done(&mut self, dim: usize, ritz: &Ritz) -> bool {
        let worst = (0..self.wanted).map(|j| ritz.residual(j)).fold(0.0, f64::max);
        if worst <= self.tolerance {
            return true;
        }
        let more = match self.last.replace((dim, worst)) {
            Some((before, residual)) if residual > worst => {
                let rate = (residual / worst).ln() / (dim - before) as f64;
                (1.1 * (worst / self.tolerance).ln() / rate) as usize
            }
            _ => dim / 8,
        };
        self.next = dim + more.clamp(dim / 32 + 1, dim / 4 + 1);
        false
    }

    /// Schedules a check after the search was extended at dimension `dim`.
    fn restart(&mut self, dim: usize) {
        self.next = dim + dim / 8 + 1;
        self.last = None;
    }
}

/// An interval without eigenvalues, and the number of ascending `values` below it: above the `m` smallest if there is a
/// gap, otherwise below the cluster of number `m`.
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

/// The number of eigenvalues below an empty interval that are missing from the `found` ones.
fn n_missing(
    stiffness: &SparseSymmetric,
    masses: &[f64],
    order: &EliminationOrder,
    (found, [from, to]): (usize, [f64; 2]),
    budget: &Budget,
) -> Result<usize, LinalgError> {
    for share in CUTS {
        let matrix = shifted(stiffness, masses, -(from + share * (to - from)));
        if let Some(below) = n_negative(order, &matrix, budget)? {
            return Ok(below.saturating_sub(found));
        }
    }
    Err(LinalgError::NotConverged(stiffness.order()))
}

/// The `m` smallest pairs that the process found, with rows in the order of the matrix.
fn pairs(operator: &ShiftInverse, process: &Lanczos<'_>, ritz: &Ritz, m: usize) -> SymmetricEigen {
    let m = m.min(ritz.eigen.values.len());
    let values = ritz.eigen.values[..m].iter().map(|theta| operator.unshifted(*theta).max(0.0)).collect();
    // Orthonormal in `s M`.
    let ordered = process.vectors(ritz, m) * operator.shift.sqrt();
    let mut vectors = Matrix::zeros(ordered.nrows(), m);
    for (from, mut to) in ordered.column_iter().zip(vectors.column_iter_mut()) {
        for (value, &row) in from.iter().zip(operator.factor.order().rows()) {
            to[row] = *value;
        }
        let sign = leading_sign(to.as_slice());
        to *= sign;
    }
    SymmetricEigen { values, vectors }
}
