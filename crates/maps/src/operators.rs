//! Maps of functions that are fitted to what two surfaces have in common, without a map of points to start from.

use linalg::Matrix;
use nalgebra::{Cholesky, DMatrix, DVector, DVectorView};

use crate::orientation::Oriented;
use descriptors::LaplaceSpectrum;

/// Eigenfunctions of a fitted map. Refinement that starts with fewer may turn people back to front (`melzi2019` in
/// `REFERENCES.bib`).
pub(crate) const FITTED: usize = 20;

/// Weight of the values of functions, beside 1 for their products and area forms: as `nogneng2017` in `REFERENCES.bib`.
const VALUES: f64 = 0.1;

/// Weights of the eigenvalues, relative to the largest: a map is fitted with each. Chosen on built-in people (`experiments run
/// matching`), where most starts with weights from 10 to 100 are right.
const EIGENVALUES: [f64; 2] = [10.0, 30.0];

/// Functions of a surface, and operators that follow from them, in its first eigenfunctions.
#[derive(Debug)]
pub(crate) struct Operators {
    /// Eigenvalues.
    values: DVector<f64>,
    /// The functions, a column each.
    functions: Matrix,
    /// For every function `f`, the operator `g -> f g`.
    products: Vec<Matrix>,
    /// For every function `f`, the operator `g -> df ∧ dg`, whose sign depends on the orientation of the surface.
    area_forms: Vec<Matrix>,
}

impl Operators {
    /// From functions at all vertices, a column each.
    pub(crate) fn new(spectrum: &LaplaceSpectrum, functions: Matrix, oriented: Option<&Oriented>) -> Self {
        let k = FITTED.min(spectrum.vectors.ncols());
        let basis = spectrum.vectors.columns(0, k);
        let mut weighted = basis.transpose();
        weighted.column_iter_mut().zip(&spectrum.masses).for_each(|(mut column, mass)| column *= *mass);
        let functions = standardized(functions, &spectrum.masses);
        let operator = |images: Matrix| &weighted * images;
        let product = |f: DVectorView<'_, f64>| {
            operator(Matrix::from_columns(
                &basis.column_iter().map(|g| f.component_mul(&g)).collect::<Vec<_>>(),
            ))
        };
        let products = functions.column_iter().map(product).collect();
        let all: Vec<usize> = (0..basis.nrows()).collect();
        let pairs: Vec<[usize; 2]> = (0..k).map(|j| [k, j]).collect();
        let area_form = |oriented: &Oriented, f: DVectorView<'_, f64>| {
            let columns: Vec<_> = basis.column_iter().chain([f]).collect();
            operator(oriented.area_forms(&Matrix::from_columns(&columns), &pairs, &all))
        };
        let area_forms = oriented.into_iter();
        let area_forms =
            area_forms.flat_map(|oriented| functions.column_iter().map(|f| area_form(oriented, f))).collect();
        Self {
            values: DVector::from_column_slice(&spectrum.values[..k]),
            functions: &weighted * functions,
            products: of_mean_norm_1(products),
            area_forms: of_mean_norm_1(area_forms),
        }
    }
}

/// The operators over their mean norm.
fn of_mean_norm_1(operators: Vec<Matrix>) -> Vec<Matrix> {
    let mean = operators.iter().map(Matrix::norm).sum::<f64>() / operators.len().max(1) as f64;
    operators.into_iter().map(|operator| operator / mean.max(f64::MIN_POSITIVE)).collect()
}

/// Columns of mean 0 and norm 1 over the surface.
fn standardized(mut functions: Matrix, masses: &[f64]) -> Matrix {
    let masses = DVectorView::from(masses);
    for mut column in functions.column_iter_mut() {
        let mean = column.dot(&masses) / masses.sum();
        column.add_scalar_mut(-mean);
        let norm = column.component_mul(&column).dot(&masses).sqrt();
        column /= norm.max(f64::MIN_POSITIVE);
    }
    functions
}

/// The maps of functions of the second surface to functions of the first, `C`, that fit pairs of operators best: they take
/// functions to each other, commute with the operators and with the Laplacians, and keep (`sign` 1) or reverse (-1) the
/// orientation (Nogneng and Ovsjanikov 2017, Ren et al. 2018, `nogneng2017` and `ren2018` in `REFERENCES.bib`). Their nearest
/// orthogonal matrices.
pub(crate) fn fitted(pairs: &[[&Operators; 2]], sign: f64) -> Vec<Matrix> {
    let Some([a, b]) = pairs.first() else { return Vec::new() };
    let k = a.values.len().min(b.values.len());
    let top = |x: &Matrix| x.view((0, 0), (k, k)).into_owned();
    let one = DMatrix::<f64>::identity(k, k);
    // The normal equations of the columns of C, one after the other; the diagonal is for surfaces on which all functions are
    // constant.
    let mut matrix = DMatrix::identity(k * k, k * k) * f64::EPSILON.sqrt();
    let mut right = DMatrix::zeros(k, k);
    for [a, b] in pairs {
        let [f, g] = [a, b].map(|of| of.functions.rows(0, k).into_owned());
        matrix += (&g * g.transpose()).kronecker(&one) * VALUES;
        right += f * g.transpose() * VALUES;
        let products = a.products.iter().zip(&b.products).map(|(x, y)| [top(x), top(y)]);
        let area_forms = a.area_forms.iter().zip(&b.area_forms).map(|(x, y)| [top(x), top(y) * sign]);
        matrix += commutators(k, products.chain(area_forms));
    }
    let largest = a.values[k - 1].max(b.values[k - 1]).max(f64::MIN_POSITIVE);
    let [x, y] = [a, b].map(|of| DMatrix::from_diagonal(&(of.values.rows(0, k) / largest)));
    let of_values = commutators(k, [[x, y]]);
    let solve = |weight: f64| {
        let factor = Cholesky::new(&matrix + &of_values * weight)?;
        let found = factor.solve(&DVector::from_column_slice(right.as_slice()));
        let svd = DMatrix::from_column_slice(k, k, found.as_slice()).svd(true, true);
        Some(svd.u? * svd.v_t?)
    };
    EIGENVALUES.into_iter().filter_map(solve).collect()
}

/// The matrix of the quadratic form `Σ |X C - C Y|²` of the columns of `C`, one after the other.
fn commutators(k: usize, pairs: impl IntoIterator<Item = [DMatrix<f64>; 2]>) -> DMatrix<f64> {
    let (mut of_x, mut of_y) = (DMatrix::zeros(k, k), DMatrix::zeros(k, k));
    let mut both = DMatrix::zeros(k * k, k * k);
    for [x, y] in pairs {
        of_x += x.transpose() * &x;
        of_y += &y * y.transpose();
        both += y.kronecker(&x);
    }
    let one = DMatrix::identity(k, k);
    of_y.kronecker(&one) + one.kronecker(&of_x) - both.transpose() - both
}
