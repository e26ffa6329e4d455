//! Solving with a triangular factor stored as dense panels of columns with a common pattern (supernodes).
//!
//! The factor is faer's. Its own solver is made for many right-hand sides: it takes 1.7 times as long for one and
//! four times as long for four (a surface of 43,000 vertices), and it visits all panels for a right-hand side with
//! a single nonzero entry.

use std::ops::Range;

/// Right-hand sides side by side, the numbers of a row next to each other: the factor is read once for all of them.
pub(crate) type Lanes<const K: usize> = [f64; K];

/// The pattern of a factor: panels of consecutive columns that share the rows below them.
#[derive(Debug)]
pub(crate) struct Panels {
    panels: Vec<Panel>,
    /// Rows below the panels, panel by panel, ascending in each.
    rows: Vec<u32>,
    /// Largest number of rows below a panel.
    tallest: usize,
}

#[derive(Debug)]
struct Panel {
    columns: Range<usize>,
    /// Its part of `rows`.
    rows: Range<usize>,
    /// Its part of the values: `columns.len() + rows.len()` numbers per column. The triangle above the diagonal is
    /// unused.
    values: Range<usize>,
}

/// A panel with its rows and values.
struct PanelView<'a> {
    columns: Range<usize>,
    rows: &'a [u32],
    values: &'a [f64],
}

impl Panels {
    /// The panels with the given column ranges, rows below, and ranges of values.
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

    /// The panels with the values of a factor.
    fn views<'a>(&'a self, factor: &'a [f64]) -> impl DoubleEndedIterator<Item = PanelView<'a>> {
        self.panels.iter().map(|panel| PanelView {
            columns: panel.columns.clone(),
            rows: &self.rows[panel.rows.clone()],
            values: &factor[panel.values.clone()],
        })
    }

    /// The diagonal of a factor stored in this pattern, in elimination order.
    pub(crate) fn diagonal(&self, factor: &[f64]) -> Vec<f64> {
        let of = |panel: PanelView<'_>| {
            (0..panel.columns.len()).map(move |j| panel.values[j * panel.height() + j]).collect::<Vec<_>>()
        };
        self.views(factor).flat_map(of).collect()
    }

    /// Overwrites `x` with the solution `y` of `L L' y = x`, in elimination order.
    pub(crate) fn solve<const K: usize>(&self, factor: &[f64], x: &mut [Lanes<K>]) {
        let mut below = vec![[0.0; K]; self.tallest];
        for panel in self.views(factor) {
            panel.forward(x, &mut below[..panel.rows.len()]);
        }
        for panel in self.views(factor).rev() {
            panel.backward(x, &mut below[..panel.rows.len()]);
        }
    }
}

/// `y += a x`, lane by lane.
#[inline(always)]
fn add<const K: usize>(y: &mut Lanes<K>, a: f64, x: &Lanes<K>) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

impl PanelView<'_> {
    /// Numbers per column.
    fn height(&self) -> usize {
        self.columns.len() + self.rows.len()
    }

    /// Eliminates the panel's columns from `x`. `below` is scratch memory for its rows.
    fn forward<const K: usize>(&self, x: &mut [Lanes<K>], below: &mut [Lanes<K>]) {
        let (width, height) = (self.columns.len(), self.height());
        let top = &mut x[self.columns.clone()];
        // A right-hand side with one nonzero entry reaches only the panels on the path to the root.
        if top.iter().flatten().all(|v| *v == 0.0) {
            return;
        }
        for j in 0..width {
            let column = &self.values[j * height..][..width];
            let inverse = 1.0 / column[j];
            let solved = top[j].map(|v| v * inverse);
            top[j] = solved;
            for (y, a) in top[j + 1..].iter_mut().zip(&column[j + 1..]) {
                add(y, -*a, &solved);
            }
        }
        if self.rows.is_empty() {
            return;
        }
        below.fill([0.0; K]);
        let mut columns = self.values.chunks_exact(height).map(|column| &column[width..]);
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
                add(y, *a, one);
            }
        }
        for (row, y) in self.rows.iter().zip(below) {
            add(&mut x[*row as usize], -1.0, y);
        }
    }

    /// Solves for the panel's rows of `x`; those below are already solved.
    fn backward<const K: usize>(&self, x: &mut [Lanes<K>], below: &mut [Lanes<K>]) {
        let (width, height) = (self.columns.len(), self.height());
        for (row, y) in self.rows.iter().zip(below.iter_mut()) {
            *y = x[*row as usize];
        }
        let top = &mut x[self.columns.clone()];
        for j in (0..width).rev() {
            let (here, under) = self.values[j * height..][..height].split_at(width);
            let mut sum = dot(under, below);
            for (a, y) in here[j + 1..].iter().zip(&top[j + 1..]) {
                add(&mut sum, *a, y);
            }
            let inverse = 1.0 / here[j];
            for (y, sum) in top[j].iter_mut().zip(sum) {
                *y = (*y - sum) * inverse;
            }
        }
    }
}

/// The product of a row vector with the lanes, as four partial sums for any number of lanes, so that a lane's result
/// does not depend on the others.
#[inline(always)]
fn dot<const K: usize>(a: &[f64], x: &[Lanes<K>]) -> Lanes<K> {
    let mut sums = [[0.0; K]; 4];
    let (mut a, mut x) = (a.chunks_exact(4), x.chunks_exact(4));
    for (a, x) in (&mut a).zip(&mut x) {
        for ((sum, a), x) in sums.iter_mut().zip(a).zip(x) {
            add(sum, *a, x);
        }
    }
    for ((sum, a), x) in sums.iter_mut().zip(a.remainder()).zip(x.remainder()) {
        add(sum, *a, x);
    }
    std::array::from_fn(|k| (sums[0][k] + sums[1][k]) + (sums[2][k] + sums[3][k]))
}
