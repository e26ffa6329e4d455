//! Solving with a triangular factor stored as dense panels of columns with a common pattern.
//!
//! The factor is faer's. Its own solver is made for many right-hand sides and takes 1.7 times as long
//! for one, four times as long for four (a surface of 43,000 vertices), and goes through all panels
//! for a right-hand side of a single entry.

use std::ops::Range;

/// Right-hand sides side by side, a row's numbers next to each other: the factor is read once for
/// all of them.
pub(crate) type Lanes<const K: usize> = [f64; K];

/// The pattern of a factor: panels of consecutive columns that share the rows below them.
#[derive(Debug)]
pub(crate) struct Panels {
    panels: Vec<Panel>,
    /// Rows below the panels, one panel after the other, ascending in each.
    rows: Vec<u32>,
    /// Most rows below a panel.
    tallest: usize,
}

#[derive(Debug)]
struct Panel {
    columns: Range<usize>,
    /// Its part of `rows`.
    rows: Range<usize>,
    /// Its part of the values: `columns.len() + rows.len()` numbers a column, the triangle above
    /// the diagonal unused.
    values: Range<usize>,
}

impl Panels {
    /// The panels with the given column ranges, rows below and ranges of values.
    pub(crate) fn new<'a>(panels: impl Iterator<Item = (Range<usize>, &'a [usize], Range<usize>)>) -> Self {
        let mut result = Self { panels: Vec::new(), rows: Vec::new(), tallest: 0 };
        for (columns, below, values) in panels {
            let start = result.rows.len();
            result.rows.extend(below.iter().map(|&row| row as u32));
            result.tallest = result.tallest.max(below.len());
            result.panels.push(Panel { columns, rows: start..result.rows.len(), values });
        }
        result
    }

    /// The diagonal of a factor stored in this pattern, in elimination order.
    pub(crate) fn diagonal(&self, factor: &[f64]) -> Vec<f64> {
        let of = |panel: &Panel| {
            let height = panel.columns.len() + panel.rows.len();
            let values = &factor[panel.values.clone()];
            (0..panel.columns.len()).map(move |j| values[j * height + j]).collect::<Vec<_>>()
        };
        self.panels.iter().flat_map(of).collect()
    }

    /// Overwrites `x` with the solution `y` of `L L' y = x`, all in elimination order.
    pub(crate) fn solve<const K: usize>(&self, factor: &[f64], x: &mut [Lanes<K>]) {
        let mut below = vec![[0.0; K]; self.tallest];
        for panel in &self.panels {
            let rows = &self.rows[panel.rows.clone()];
            panel.forward(&factor[panel.values.clone()], rows, x, &mut below[..rows.len()]);
        }
        for panel in self.panels.iter().rev() {
            let rows = &self.rows[panel.rows.clone()];
            panel.backward(&factor[panel.values.clone()], rows, x, &mut below[..rows.len()]);
        }
    }
}

/// `y - a x`, lane by lane.
#[inline(always)]
fn subtract<const K: usize>(y: &mut Lanes<K>, a: f64, x: &Lanes<K>) {
    for (y, x) in y.iter_mut().zip(x) {
        *y -= a * x;
    }
}

impl Panel {
    /// Eliminates the panel's columns from `x`.
    fn forward<const K: usize>(
        &self,
        values: &[f64],
        rows: &[u32],
        x: &mut [Lanes<K>],
        below: &mut [Lanes<K>],
    ) {
        let width = self.columns.len();
        let top = &mut x[self.columns.clone()];
        // A source is one entry: it reaches only the panels on its way to the root.
        if top.iter().flatten().all(|v| *v == 0.0) {
            return;
        }
        let height = width + rows.len();
        for j in 0..width {
            let column = &values[j * height..][..width];
            let inverse = 1.0 / column[j];
            let solved = top[j].map(|v| v * inverse);
            top[j] = solved;
            for (y, a) in top[j + 1..].iter_mut().zip(&column[j + 1..]) {
                subtract(y, *a, &solved);
            }
        }
        if rows.is_empty() {
            return;
        }
        below.fill([0.0; K]);
        let mut columns = values.chunks_exact(height).map(|column| &column[width..]);
        let mut solved = top.chunks_exact(4);
        for four in &mut solved {
            let (Some(a), Some(b), Some(c), Some(d)) =
                (columns.next(), columns.next(), columns.next(), columns.next())
            else {
                break;
            };
            for ((((y, a), b), c), d) in below.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                for (k, y) in y.iter_mut().enumerate() {
                    *y += (a * four[0][k] + b * four[1][k]) + (c * four[2][k] + d * four[3][k]);
                }
            }
        }
        for (one, column) in solved.remainder().iter().zip(columns) {
            for (y, a) in below.iter_mut().zip(column) {
                for (y, x) in y.iter_mut().zip(one) {
                    *y += a * x;
                }
            }
        }
        for (row, y) in rows.iter().zip(below) {
            subtract(&mut x[*row as usize], 1.0, y);
        }
    }

    /// Solves for the panel's rows of `x`, those below being solved.
    fn backward<const K: usize>(
        &self,
        values: &[f64],
        rows: &[u32],
        x: &mut [Lanes<K>],
        below: &mut [Lanes<K>],
    ) {
        let width = self.columns.len();
        let height = width + rows.len();
        for (row, y) in rows.iter().zip(below.iter_mut()) {
            *y = x[*row as usize];
        }
        let top = &mut x[self.columns.clone()];
        for j in (0..width).rev() {
            let (here, under) = values[j * height..][..height].split_at(width);
            let mut sum = dot(under, below);
            for (a, y) in here[j + 1..].iter().zip(&top[j + 1..]) {
                for (sum, y) in sum.iter_mut().zip(y) {
                    *sum += a * y;
                }
            }
            let inverse = 1.0 / here[j];
            for (y, sum) in top[j].iter_mut().zip(sum) {
                *y = (*y - sum) * inverse;
            }
        }
    }
}

/// The product of a row vector with the lanes; four partial sums, whatever the number of lanes, so
/// that a lane's result does not depend on its company.
#[inline(always)]
fn dot<const K: usize>(a: &[f64], x: &[Lanes<K>]) -> Lanes<K> {
    let mut sums = [[0.0; K]; 4];
    let (mut a, mut x) = (a.chunks_exact(4), x.chunks_exact(4));
    for (a, x) in (&mut a).zip(&mut x) {
        for ((sum, a), x) in sums.iter_mut().zip(a).zip(x) {
            for (sum, x) in sum.iter_mut().zip(x) {
                *sum += a * x;
            }
        }
    }
    for ((sum, a), x) in sums.iter_mut().zip(a.remainder()).zip(x.remainder()) {
        for (sum, x) in sum.iter_mut().zip(x) {
            *sum += a * x;
        }
    }
    std::array::from_fn(|k| (sums[0][k] + sums[1][k]) + (sums[2][k] + sums[3][k]))
}
