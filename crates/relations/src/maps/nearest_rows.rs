//! Nearest rows of matrices with many columns.

use linalg::{Matrix, sq_distance};
use rayon::prelude::*;

/// Rows of the first matrix multiplied at a time. The result does not depend on it.
const BLOCK: usize = 128;

/// For each row of a block the nearest row of `y`, and for each row of `y` the nearest of the block with half of its gap.
type NearestOfBlock = (Vec<usize>, Vec<(usize, f64)>);

/// For every row of `x` the nearest row of `y`, and for every row of `y` the nearest of `x`; the first in case of a tie.
///
/// By products of blocks of the matrices: in tens of dimensions no search tree is faster. Cost `O(m n d)`; parallel, and
/// independent of the number of threads.
pub(super) fn nearest_rows(x: &Matrix, y: &Matrix) -> [Vec<usize>; 2] {
    let [of_x, of_y] = [x, y].map(half_squares);
    let starts: Vec<usize> = (0..x.nrows()).step_by(BLOCK).collect();
    let blocks: Vec<NearestOfBlock> = starts
        .into_par_iter()
        .map(|start| {
            let rows = start..(start + BLOCK).min(x.nrows());
            let products = y * x.rows_range(rows.clone()).transpose();
            let mut to_x = vec![(0, f64::INFINITY); y.nrows()];
            let mut to_y = Vec::with_capacity(rows.len());
            for (i, column) in (start..).zip(products.column_iter()) {
                let half = of_x[i];
                for (best, dot) in to_x.iter_mut().zip(column.iter()) {
                    if half - dot < best.1 {
                        *best = (i, half - dot);
                    }
                }
                to_y.push(least(column.iter().zip(&of_y).map(|(dot, half)| half - dot)).0);
            }
            (to_y, to_x)
        })
        .collect();
    let mut to_y = Vec::with_capacity(x.nrows());
    let mut to_x = vec![(0, f64::INFINITY); y.nrows()];
    for (block_to_y, block_to_x) in blocks {
        to_y.extend(block_to_y);
        to_x.iter_mut()
            .zip(block_to_x)
            .filter(|(best, found)| found.1 < best.1)
            .for_each(|(best, found)| *best = found);
    }
    [to_y, to_x.into_iter().map(|(i, _)| i).collect()]
}

/// Rows of a matrix in cells, each around one of them.
pub(super) struct Cells<'a> {
    /// All rows.
    pub(super) rows: &'a Matrix,
    /// Columns by which the nearest cells are found.
    pub(super) coarse: &'a [usize],
    /// The row in the middle of each cell.
    pub(super) centres: &'a [usize],
    /// The rows of each cell.
    pub(super) members: &'a [Vec<usize>],
}

/// Cells searched for each row.
const PROBED: usize = 8;

impl Cells<'_> {
    /// For every row of `x` the nearest row of the cells with the eight nearest centres; the one of the nearer centre, or
    /// the first, in case of a tie.
    ///
    /// Cost `O(m c d)` for `c` centres; parallel, and independent of the number of threads.
    pub(super) fn nearest(&self, x: &Matrix) -> Vec<usize> {
        let centres = self.rows.select_rows(self.centres).select_columns(self.coarse);
        let of_centres = half_squares(&centres);
        // Rows next to each other in memory.
        let (sources, targets) = (x.transpose(), self.rows.transpose());
        let coarse = sources.select_rows(self.coarse);
        let starts: Vec<usize> = (0..x.nrows()).step_by(BLOCK).collect();
        let blocks: Vec<Vec<usize>> = starts
            .into_par_iter()
            .map(|start| {
                let rows = start..(start + BLOCK).min(x.nrows());
                let products = &centres * coarse.columns_range(rows.clone());
                let one = |(i, column): (usize, nalgebra::DVectorView<'_, f64>)| {
                    let gaps = column.iter().zip(&of_centres).map(|(dot, half)| half - dot);
                    let order = first_of(gaps.zip(0..).collect(), PROBED);
                    let source = sources.column(i);
                    let members = order.iter().flat_map(|(_, cell): &(f64, usize)| &self.members[*cell]);
                    let mut best = (f64::INFINITY, 0);
                    for &v in members {
                        let gap = sq_distance(source.as_slice(), targets.column(v).as_slice());
                        if gap < best.0 {
                            best = (gap, v);
                        }
                    }
                    best.1
                };
                rows.zip(products.column_iter()).map(one).collect()
            })
            .collect();
        blocks.concat()
    }
}

/// The first `n` items by their numbers, and by what follows them where these are equal, in order.
pub(super) fn first_of<T: Ord>(mut items: Vec<(f64, T)>, n: usize) -> Vec<(f64, T)> {
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

/// The first position of the least value, and the value.
fn least(values: impl Iterator<Item = f64>) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (i, value) in values.enumerate() {
        if value < best.1 {
            best = (i, value);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(n: usize, d: usize, seed: f64) -> Matrix {
        Matrix::from_fn(n, d, |i, j| (seed + 1.7 * i as f64 + 0.3 * (i * j) as f64).sin())
    }

    fn by_hand(x: &Matrix, y: &Matrix) -> Vec<usize> {
        let gap = |i: usize, j: usize| (x.row(i) - y.row(j)).norm_squared();
        (0..x.nrows()).map(|i| least((0..y.nrows()).map(|j| gap(i, j))).0).collect()
    }

    #[test]
    fn nearest_rows_are_found_across_blocks() {
        let (x, y) = (rows(300, 7, 0.1), rows(170, 7, 0.9));
        assert_eq!(nearest_rows(&x, &y), [by_hand(&x, &y), by_hand(&y, &x)]);
    }

    #[test]
    fn cells_find_the_nearest_row_if_cells_are_compact() {
        // Points of a curve, in cells of ten neighbours.
        let curve = |n: usize, shift: f64| {
            Matrix::from_fn(n, 3, |i, j| {
                let t = (i as f64 + shift) / n as f64;
                [t, (3.0 * t).sin(), (5.0 * t).cos()][j]
            })
        };
        let (x, y) = (curve(230, 0.3), curve(400, 0.0));
        let members: Vec<Vec<usize>> = (0..40).map(|c| (10 * c..10 * c + 10).collect()).collect();
        let centres: Vec<usize> = (0..40).map(|c| 10 * c + 5).collect();
        let cells = Cells { rows: &y, coarse: &[0, 1], centres: &centres, members: &members };
        assert_eq!(cells.nearest(&x), by_hand(&x, &y));
    }
}
