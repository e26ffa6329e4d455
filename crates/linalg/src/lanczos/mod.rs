//! A block Lanczos process with full orthogonalisation.

mod strips;

use base::SplitMix;

use self::strips::Strips;
use crate::{LinalgError, Matrix, SymmetricEigen, SymmetricOperator, symmetric_eigen};

/// Vectors in the first block. A block of this size finds as many copies of a multiple eigenvalue at once. Larger blocks
/// make products faster but need a larger basis.
const BLOCK: usize = 4;

/// A vector that orthogonalisation reduces below this share of its length is rounding error.
const ROUNDING: f64 = 1e-13;

/// A vector that orthogonalisation reduces below this share of its length has lost a digit to rounding and is
/// orthogonalised again.
const CANCELLED: f64 = 0.1;

/// `M W`.
pub(crate) fn weighted(operator: &dyn SymmetricOperator, columns: &Matrix) -> Matrix {
    let mut result = columns.clone();
    if let Some(masses) = operator.masses() {
        for column in result.as_mut_slice().chunks_exact_mut(masses.len().max(1)) {
            column.iter_mut().zip(masses).for_each(|(x, m)| *x *= m);
        }
    }
    result
}

/// A block Lanczos process for the largest eigenvalues of an operator `C` that is symmetric in the inner product
/// `x' M y` of its masses.
///
/// | symbol | here | meaning |
/// |---|---|---|
/// | `V` | `basis` | M-orthonormal vectors: the blocks `X_1 .. X_k` |
/// | `T` | [`projected`](Self::projected) | `V' M C V`, block tridiagonal |
/// | `X` | `next` | the next block, M-orthonormal too |
/// | `B` | last coupling | the coefficients of `X` in `C X_k` |
///
/// **Invariant.** `C V = V T + X B E'` up to rounding, with `E'` the last rows of the identity.
///
/// Blocks may grow: a vector of `X` that is not in `C X_k` has a zero row in `B`. They shrink when directions are
/// exhausted, and are empty once the basis spans the whole space.
#[derive(Debug)]
pub(crate) struct Lanczos<'a> {
    operator: &'a dyn SymmetricOperator,
    /// The diagonal of `M`.
    masses: Vec<f64>,
    basis: Strips,
    /// For each block `X_k` of the basis, `X_k' M C X_k` and its coupling `B` to the next block.
    blocks: Vec<[Matrix; 2]>,
    /// The last block of the basis.
    last: Matrix,
    next: Matrix,
    random: SplitMix,
}

impl<'a> Lanczos<'a> {
    /// A process that starts from a fixed set of random vectors.
    pub(crate) fn new(operator: &'a dyn SymmetricOperator) -> Self {
        let n = operator.order();
        let none = || Matrix::zeros(n, 0);
        let random = SplitMix(0x9e37_79b9_7f4a_7c15);
        let masses = operator.masses().map_or_else(|| vec![1.0; n], <[f64]>::to_vec);
        let (basis, blocks) = (Strips::new(n), Vec::new());
        let mut process = Self { operator, masses, basis, blocks, last: none(), next: none(), random };
        process.add_random(BLOCK);
        process
    }

    /// Number of vectors in the basis.
    pub(crate) fn dim(&self) -> usize {
        self.basis.n_columns()
    }

    /// Whether the basis spans the whole space.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.next.ncols() == 0
    }

    /// Takes the next block into the basis.
    pub(crate) fn step(&mut self) {
        let block = std::mem::replace(&mut self.next, Matrix::zeros(self.operator.order(), 0));
        self.basis.append(&block);
        let mut image = self.operator.apply(&block);
        let lengths = self.lengths(&image);
        // First subtracts the components that exist in exact arithmetic, then those due to rounding.
        if let Some([_, coupling]) = self.blocks.last() {
            image -= &self.last * coupling.transpose();
        }
        let within = block.tr_mul(&weighted(self.operator, &image));
        let within = (&within + within.transpose()) * 0.5;
        image -= &block * &within;
        self.last = block;
        let coupling = self.orthonormalize(&mut image, &lengths);
        self.next = image;
        self.blocks.push([within, coupling]);
        if self.is_exhausted() {
            self.add_random(BLOCK);
        }
    }

    /// Adds up to `count` random vectors to the next block (fewer if there are no more directions), to find eigenvectors
    /// that are orthogonal to the start.
    pub(crate) fn add_random(&mut self, count: usize) {
        let n = self.operator.order();
        let random = Matrix::from_fn(n, count, |_, _| self.random.uniform());
        let mut fresh = self.operator.apply(&random);
        let lengths = self.lengths(&fresh);
        self.orthonormalize(&mut fresh, &lengths);
        let old = self.next.ncols();
        self.next = Matrix::from_fn(n, old + fresh.ncols(), |i, j| {
            if j < old { self.next[(i, j)] } else { fresh[(i, j - old)] }
        });
        if let Some([_, coupling]) = self.blocks.last_mut() {
            *coupling = coupling.clone().resize_vertically(self.next.ncols(), 0.0);
        }
    }

    /// Makes the columns of `w` orthonormal, and orthogonal to the basis and the next block. Drops columns that are
    /// rounding error compared with their original `lengths`. Returns `R` such that the columns were `V h + w R`, with
    /// `w` the result and some `h`.
    fn orthonormalize(&self, w: &mut Matrix, lengths: &[f64]) -> Matrix {
        let mut r = Matrix::identity(w.ncols(), w.ncols());
        let mut lengths = lengths.to_vec();
        // Once is enough unless most of a vector cancels; three times are always enough.
        for _ in 0..3 {
            let before = self.lengths(w);
            let weighted = weighted(self.operator, w);
            self.basis.add_combinations(w, &self.basis.products(&weighted), -1.0);
            *w -= &self.next * (self.next.tr_mul(&weighted));
            let (factor, left) = self.gram_schmidt(w, &lengths);
            r = factor * r;
            let cancelled = left.iter().zip(&before).any(|(left, before)| *left < CANCELLED * before);
            lengths = vec![1.0; w.ncols()];
            if !cancelled {
                break;
            }
        }
        r
    }

    /// Makes the columns of `w` orthonormal among themselves, and drops those that are rounding error. Returns `R` such
    /// that the old columns are `w R`, and the length of each column before normalization.
    fn gram_schmidt(&self, w: &mut Matrix, lengths: &[f64]) -> (Matrix, Vec<f64>) {
        let (n, m) = w.shape();
        let mut r = Matrix::zeros(m, m);
        let mut left = Vec::with_capacity(m);
        let mut kept = 0;
        for j in 0..m {
            let (done, rest) = w.as_mut_slice().split_at_mut(j * n);
            let column = &mut rest[..n];
            for _ in 0..2 {
                for (i, other) in done[..kept * n].chunks_exact(n).enumerate() {
                    let share = self.inner(other, column);
                    column.iter_mut().zip(other).for_each(|(x, y)| *x -= share * y);
                    r[(i, j)] += share;
                }
            }
            let length = self.inner(column, column).sqrt();
            left.push(length);
            if length > ROUNDING * lengths[j] {
                column.iter_mut().for_each(|x| *x /= length);
                r[(kept, j)] = length;
                w.as_mut_slice().copy_within(j * n..(j + 1) * n, kept * n);
                kept += 1;
            }
        }
        *w = w.columns(0, kept).into_owned();
        (r.rows(0, kept).into_owned(), left)
    }

    /// `x' M y`, in eight independent chains of additions.
    fn inner(&self, x: &[f64], y: &[f64]) -> f64 {
        let mut sums = [0.0; 8];
        let ((x, last_x), (y, last_y)) = (x.as_chunks::<8>(), y.as_chunks::<8>());
        let (masses, last_masses) = self.masses.as_chunks::<8>();
        for ((x, y), m) in x.iter().zip(y).zip(masses) {
            for lane in 0..8 {
                sums[lane] += x[lane] * y[lane] * m[lane];
            }
        }
        let last = last_x.iter().zip(last_y).zip(last_masses).map(|((x, y), m)| x * y * m);
        sums.iter().sum::<f64>() + last.sum::<f64>()
    }

    /// The M-norm of each column.
    fn lengths(&self, w: &Matrix) -> Vec<f64> {
        w.column_iter().map(|x| self.inner(x.as_slice(), x.as_slice()).sqrt()).collect()
    }

    /// The matrix `T`.
    fn projected(&self) -> Matrix {
        let dim = self.dim();
        let mut t = Matrix::zeros(dim, dim);
        let mut start = 0;
        for [within, coupling] in &self.blocks {
            let width = within.ncols();
            t.view_mut((start, start), (width, width)).copy_from(within);
            if start + width < dim {
                let below = coupling.nrows();
                t.view_mut((start + width, start), (below, width)).copy_from(coupling);
                t.view_mut((start, start + width), (width, below)).copy_from(&coupling.transpose());
            }
            start += width;
        }
        t
    }

    /// The eigenpairs of `T`, largest first.
    ///
    /// # Errors
    /// [`LinalgError::NotConverged`].
    pub(crate) fn ritz(&self) -> Result<Ritz, LinalgError> {
        let dim = self.dim();
        let eigen = match dim {
            0 => SymmetricEigen { values: Vec::new(), vectors: Matrix::zeros(0, 0) },
            _ => symmetric_eigen(&self.projected())?,
        };
        let outside = match self.blocks.last() {
            Some([within, coupling]) => {
                let width = within.ncols();
                coupling * eigen.vectors.rows(dim - width, width)
            }
            None => Matrix::zeros(0, 0),
        };
        Ok(Ritz { eigen, outside })
    }

    /// The M-orthonormal vectors `C V y / theta` of the first `m` pairs of `T`: a step of inverse iteration on `V y`
    /// without extra cost for positive `theta`, since `C V y = theta V y + X B E' y`.
    pub(crate) fn vectors(&self, ritz: &Ritz, m: usize) -> Matrix {
        let mut result = Matrix::zeros(self.operator.order(), m);
        self.basis.add_combinations(&mut result, &ritz.eigen.vectors.columns(0, m).into_owned(), 1.0);
        for (j, mut vector) in result.column_iter_mut().enumerate() {
            let theta = ritz.eigen.values[j];
            if theta > 0.0 {
                vector += &self.next * ritz.outside.column(j) / theta;
                vector /= 1.0f64.hypot(ritz.residual(j));
            }
        }
        result
    }
}

/// The eigenpairs of `T`, largest first.
#[derive(Debug)]
pub(crate) struct Ritz {
    pub(crate) eigen: SymmetricEigen,
    /// `B E' y` for each eigenvector `y` of `T`.
    outside: Matrix,
}

impl Ritz {
    /// `|C x - theta x|` of pair `j`, with `x = V y`.
    pub(crate) fn absolute_residual(&self, j: usize) -> f64 {
        self.outside.column(j).norm()
    }

    /// The same over `theta`; infinite unless that is positive.
    pub(crate) fn residual(&self, j: usize) -> f64 {
        let theta = self.eigen.values[j];
        if theta > 0.0 { self.absolute_residual(j) / theta } else { f64::INFINITY }
    }
}
