//! Nearest rows of matrices with many columns.

use std::ops::Range;

use linalg::{Matrix, sq_distance};
use rayon::prelude::*;

/// Rows of the first matrix multiplied at a time. The result does not depend on it.
const BLOCK: usize = 128;

/// For every row of `x` the nearest row of `y`, and for every row of `y` the nearest of `x`; the first in case of a tie.
///
/// By products of blocks of the matrices: in tens of dimensions no search tree is faster. Cost `O(m n d)`; parallel, and
/// independent of the number of threads.
pub(crate) fn nearest_rows(x: &Matrix, y: &Matrix) -> [Vec<usize>; 2] {
    let [of_x, of_y] = [x, y].map(half_squares);
    let one = |rows: Range<usize>| {
        let products = y * x.rows_range(rows.clone()).transpose();
        let mut to_x = vec![(f64::INFINITY, 0); y.nrows()];
        let mut to_y = Vec::with_capacity(rows.len());
        for (i, column) in rows.zip(products.column_iter()) {
            for (best, dot) in to_x.iter_mut().zip(column.iter()) {
                if of_x[i] - dot < best.0 {
                    *best = (of_x[i] - dot, i);
                }
            }
            to_y.push(least(column.iter().zip(&of_y).map(|(dot, half)| half - dot)));
        }
        (to_y, to_x)
    };
    let (to_y, to_x): (Vec<Vec<usize>>, Vec<_>) = blocks(x.nrows()).map(one).unzip();
    let nearest = |j: usize| to_x.iter().map(|of_block| of_block[j]).fold((f64::INFINITY, 0), nearer).1;
    [to_y.concat(), (0..y.nrows()).map(nearest).collect()]
}

/// Blocks of rows.
fn blocks(n: usize) -> impl ParallelIterator<Item = Range<usize>> {
    (0..n.div_ceil(BLOCK)).into_par_iter().map(move |b| b * BLOCK..((b + 1) * BLOCK).min(n))
}

/// The nearer of two, the first in case of a tie.
fn nearer(best: (f64, usize), next: (f64, usize)) -> (f64, usize) {
    if next.0 < best.0 { next } else { best }
}

/// Cells searched around each place. A safety limit.
pub(crate) const PROBED: usize = 8;

/// For every row of `x` the nearest row of `y` in the cells with the eight nearest centers, by some `coarse` columns; the
/// one of the nearer center, or the first, in case of a tie. A cell has a row in its middle, and members.
///
/// Cost `O(m c d)` for `c` centers; parallel, and independent of the number of threads.
pub(crate) fn nearest_in_cells(
    x: &Matrix,
    y: &Matrix,
    (centers, members): (&[usize], &[Vec<usize>]),
    coarse: &[usize],
) -> Vec<usize> {
    let centers = y.select_rows(centers).select_columns(coarse);
    let of_centers = half_squares(&centers);
    // Rows next to each other in memory.
    let (sources, targets) = (x.transpose(), y.transpose());
    let coarse = sources.select_rows(coarse);
    let one = |rows: Range<usize>| -> Vec<usize> {
        let products = &centers * coarse.columns_range(rows.clone());
        let nearest = |(i, column): (usize, nalgebra::DVectorView<'_, f64>)| {
            let gaps = column.iter().zip(&of_centers).map(|(dot, half)| half - dot);
            let cells = first_of(gaps.zip(0..).collect(), PROBED);
            let members = cells.iter().flat_map(|(_, cell): &(f64, usize)| &members[*cell]);
            let source = sources.column(i);
            let gap = |&v: &usize| (sq_distance(source.as_slice(), targets.column(v).as_slice()), v);
            members.map(gap).fold((f64::INFINITY, 0), nearer).1
        };
        rows.zip(products.column_iter()).map(nearest).collect()
    };
    blocks(x.nrows()).map(one).collect::<Vec<_>>().concat()
}

/// The first `n` items by their numbers, and by what follows them where these are equal, in order.
pub(crate) fn first_of<T: Ord>(mut items: Vec<(f64, T)>, n: usize) -> Vec<(f64, T)> {
    let by_number = |a: &(f64, T), b: &(f64, T)| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1));
    if items.len() > n {
        items.select_nth_unstable_by(n, by_number);
        items.truncate(n);
    }
    items.sort_unstable_by(by_number);
    items
}

/// Half of the squared length of every row.
fn half_squares(x: &Matrix) -> Vec<f64> {
    let mut halves = vec![0.0; x.nrows()];
    for column in x.column_iter() {
        halves.iter_mut().zip(column.iter()).for_each(|(half, v)| *half += 0.5 * v * v);
    }
    halves
}

/// The first position of the least value.
fn least(values: impl Iterator<Item = f64>) -> usize {
    values.zip(0..).fold((f64::INFINITY, 0), nearer).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(n: usize, d: usize, seed: f64) -> Matrix {
        Matrix::from_fn(n, d, |i, j| (seed + 1.7 * i as f64 + 0.3 * (i * j) as f64).sin())
    }

    fn by_hand(x: &Matrix, y: &Matrix) -> Vec<usize> {
        let gap = |i: usize, j: usize| (x.row(i) - y.row(j)).norm_squared();
        (0..x.nrows()).map(|i| least((0..y.nrows()).map(|j| gap(i, j)))).collect()
    }

    #[test]
    fn nearest_rows_are_found_across_blocks() {
        let (x, y) = (rows(300, 7, 0.1), rows(170, 7, 0.9));
        assert_eq!(nearest_rows(&x, &y), [by_hand(&x, &y), by_hand(&y, &x)]);
    }

    #[test]
    fn cells_find_the_nearest_row_if_cells_are_compact() {
        // Points of a curve, in cells of ten neighbors.
        let curve = |n: usize, shift: f64| {
            Matrix::from_fn(n, 3, |i, j| {
                let t = (i as f64 + shift) / n as f64;
                [t, (3.0 * t).sin(), (5.0 * t).cos()][j]
            })
        };
        let (x, y) = (curve(230, 0.3), curve(400, 0.0));
        let members: Vec<Vec<usize>> = (0..40).map(|c| (10 * c..10 * c + 10).collect()).collect();
        let centers: Vec<usize> = (0..40).map(|c| 10 * c + 5).collect();
        assert_eq!(nearest_in_cells(&x, &y, (&centers, &members), &[0, 1]), by_hand(&x, &y));
    }
}
