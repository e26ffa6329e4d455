//! Passes over the rows of squared distances, a block at a time, so that the columns need not fit into memory.
//!
//! Blocks are processed in parallel and combined in their order, so results do not depend on the number of threads. Nor do
//! they depend on where the columns are.

use linalg::{LandmarkDistances, LinalgError, Matrix, triangular_factor};
use rayon::prelude::*;

/// Blocks that are combined into one triangular factor before factors are combined with each other.
const GROUP: usize = 8;

/// Blocks of coordinates that wait for their place.
const BATCH: usize = 256;

/// The squared distances of the points of a range, p x n, in units of `unit²`.
fn squares(
    distances: &LandmarkDistances,
    unit: f64,
    rows: std::ops::Range<usize>,
) -> Result<Matrix, LinalgError> {
    let mut block = distances.rows(rows)?;
    block.apply(|d| *d = (*d / unit).powi(2));
    Ok(block)
}

/// The mean of each column of squared distances, in units of `unit²`.
pub(crate) fn sq_means(distances: &LandmarkDistances, unit: f64) -> Result<Vec<f64>, LinalgError> {
    let sums = |rows| Ok(squares(distances, unit, rows)?.row_sum());
    let sums = distances.blocks().into_par_iter().map(sums).collect::<Result<Vec<_>, LinalgError>>()?;
    let mut means = vec![0.0; distances.n_landmarks()];
    for block in &sums {
        means.iter_mut().zip(block.iter()).for_each(|(mean, sum)| *mean += sum);
    }
    means.iter_mut().for_each(|mean| *mean /= distances.n_points().max(1) as f64);
    Ok(means)
}

/// The rows of squared distances minus `shift`, times `basis` (n x m).
fn transformed(
    distances: &LandmarkDistances,
    unit: f64,
    shift: &[f64],
    basis: &Matrix,
    rows: std::ops::Range<usize>,
) -> Result<Matrix, LinalgError> {
    let mut block = squares(distances, unit, rows)?;
    for (mut column, shift) in block.column_iter_mut().zip(shift) {
        column.add_scalar_mut(-shift);
    }
    Ok(block * basis)
}

/// The triangular factor `W` of the QR decomposition of `(R - 1 shift') basis`, with `R` the squared distances, up to the
/// signs of its rows: from the factors of blocks, stacked and decomposed again (tall and skinny QR; Demmel, Grigori,
/// Hoemmen and Langou 2012, `demmel2012` in `REFERENCES.bib`). As accurate as the decomposition of the whole.
pub(crate) fn triangle(
    distances: &LandmarkDistances,
    unit: f64,
    shift: &[f64],
    basis: &Matrix,
) -> Result<Matrix, LinalgError> {
    let blocks = distances.blocks();
    let of_group = |group: &[std::ops::Range<usize>]| {
        let mut factor: Option<Matrix> = None;
        for rows in group {
            let block = transformed(distances, unit, shift, basis, rows.clone())?;
            factor = Some(triangular_factor(&stacked(factor.as_slice().iter().chain([&block]))));
        }
        Ok(factor.into_iter().collect())
    };
    let factors =
        blocks.par_chunks(GROUP).map(of_group).collect::<Result<Vec<Vec<Matrix>>, LinalgError>>()?;
    let mut factors: Vec<Matrix> = factors.into_iter().flatten().collect();
    while factors.len() > 1 {
        factors = factors.par_chunks(GROUP).map(|group| triangular_factor(&stacked(group.iter()))).collect();
    }
    Ok(factors.pop().unwrap_or_else(|| Matrix::zeros(0, basis.ncols())))
}

/// Matrices on top of each other.
fn stacked<'a>(parts: impl Iterator<Item = &'a Matrix> + Clone) -> Matrix {
    let n_rows = parts.clone().map(Matrix::nrows).sum();
    let n_columns = parts.clone().map(Matrix::ncols).max().unwrap_or(0);
    let mut stack = Matrix::zeros(n_rows, n_columns);
    let mut first = 0;
    for part in parts {
        stack.rows_mut(first, part.nrows()).copy_from(part);
        first += part.nrows();
    }
    stack
}

/// `(R - 1 shift') basis` with `R` the squared distances, p x m.
pub(crate) fn product(
    distances: &LandmarkDistances,
    unit: f64,
    shift: &[f64],
    basis: &Matrix,
) -> Result<Matrix, LinalgError> {
    let mut result = Matrix::zeros(distances.n_points(), basis.ncols());
    for batch in distances.blocks().chunks(BATCH) {
        let of_block = |rows: &std::ops::Range<usize>| {
            Ok((rows.start, transformed(distances, unit, shift, basis, rows.clone())?))
        };
        let blocks = batch.par_iter().map(of_block).collect::<Result<Vec<_>, LinalgError>>()?;
        for (start, block) in blocks {
            result.rows_mut(start, block.nrows()).copy_from(&block);
        }
    }
    Ok(result)
}
