//! Curves of repeated runs, and numbers by the names that expectations use.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::time::Instant;

use anyhow::Result;
use linalg::DistanceMatrix;
use nmds::Regularization;
use report::record::{Axis, Figure, FigurePanels, Plot, PlotPoint, Series, SeriesKind};
use retrieval::{Labels, QueryScores, Scores};

pub(crate) type MeasuredNumbers = BTreeMap<String, f64>;

/// Notes numbers under `OF NAME`.
pub(crate) fn note<N: Display>(
    measured: &mut MeasuredNumbers,
    of: &str,
    numbers: impl IntoIterator<Item = (N, f64)>,
) {
    measured.extend(numbers.into_iter().map(|(name, number)| (format!("{of} {name}"), number)));
}

/// The measured numbers by their names.
pub(crate) fn numbers<const N: usize>(named: [(&str, f64); N]) -> MeasuredNumbers {
    named.map(|(name, number)| (name.to_owned(), number)).into()
}

/// What work gives, and the seconds that it takes.
pub(crate) fn timed<T, E>(work: impl FnOnce() -> Result<T, E>) -> Result<(T, f64), E> {
    let start = Instant::now();
    let made = work()?;
    Ok((made, start.elapsed().as_secs_f64()))
}

/// The mean; not a number without values.
pub(crate) fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, n) = values.into_iter().fold((0.0, 0usize), |(sum, n), value| (sum + value, n + 1));
    sum / n as f64
}

/// The share of the elements of which something is true.
pub(crate) fn share<T>(all: &[T], is: impl Fn(&T) -> bool) -> f64 {
    mean(all.iter().map(|one| f64::from(u8::from(is(one)))))
}

/// All pairs, each of a later element and an earlier one.
pub(crate) fn pairs<T>(all: &[T]) -> impl Iterator<Item = (&T, &T)> {
    all.iter().enumerate().flat_map(|(i, a)| all[..i].iter().map(move |b| (a, b)))
}

/// The headings of retrieval scores in tables, as in the paper.
pub(crate) const SCORES: [&str; 6] = ["NN", "FT", "ST", "E", "DCG", "mAP"];

/// Retrieval scores by the names that expectations use.
pub(crate) fn named(s: &Scores) -> [(&'static str, f64); 6] {
    [("nn", s.nn), ("ft", s.ft), ("st", s.st), ("e", s.e), ("dcg", s.dcg), ("mAP", s.map)]
}

/// The E-measure of rankings without error.
pub(crate) fn best_e(labels: &Labels) -> Result<f64> {
    let apart = |i: usize, j: usize| f64::from(u8::from(labels.class(i) != labels.class(j)));
    let ideal = DistanceMatrix::from_pairs(labels.n_points(), apart)?;
    Ok(QueryScores::new(&ideal, labels)?.mean().e)
}

/// The low-rank regularization that keeps half of `n` eigenpairs.
pub(crate) fn half(n: usize) -> Regularization {
    Regularization::LowRank { rank: Some(n.div_ceil(2)) }
}

/// The index and the value of the median; of two in the middle, the lower one.
pub(crate) fn median(values: &[f64]) -> (usize, f64) {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    order.get(values.len().saturating_sub(1) / 2).map_or((0, f64::NAN), |&i| (i, values[i]))
}

/// Median and range of the runs at one value of `x`.
pub(crate) fn point(x: f64, runs: &[f64]) -> PlotPoint {
    PlotPoint {
        x,
        y: median(runs).1,
        low: runs.iter().copied().fold(f64::INFINITY, f64::min),
        high: runs.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        note: if runs.len() > 1 { format!("{} runs", runs.len()) } else { String::new() },
    }
}

/// A curve through these points.
pub(crate) fn curve(name: &str, points: Vec<PlotPoint>) -> Series {
    Series { name: name.to_owned(), kind: SeriesKind::Curve, points }
}

/// The curve of `runs[run][place]` over the places.
pub(crate) fn series(name: &str, places: &[f64], runs: &[Vec<f64>]) -> Series {
    let at = |place: usize| runs.iter().map(|run| run[place]).collect::<Vec<_>>();
    curve(name, places.iter().enumerate().map(|(i, &x)| point(x, &at(i))).collect())
}

/// A curve for each name over the places, from `runs[run][place][name]`.
pub(crate) fn curves(names: &[&str], places: &[f64], runs: &[Vec<Vec<f64>>]) -> Vec<Series> {
    let of =
        |i: usize| runs.iter().map(|run| run.iter().map(|values| values[i]).collect()).collect::<Vec<_>>();
    names.iter().enumerate().map(|(i, name)| series(name, places, &of(i))).collect()
}

/// The last median of a curve.
pub(crate) fn last(series: &Series) -> f64 {
    series.points.last().map_or(f64::NAN, |p| p.y)
}

/// The medians of a curve.
pub(crate) fn medians(series: &Series) -> Vec<f64> {
    series.points.iter().map(|p| p.y).collect()
}

/// The place of the least median of a curve, and that median.
pub(crate) fn least(series: &Series) -> (f64, f64) {
    let points = series.points.iter().map(|p| (p.x, p.y));
    points.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((f64::NAN, f64::NAN))
}

/// The share of places where the median of `a` is at most that of every other curve.
pub(crate) fn share_lowest(a: &Series, others: &[&Series]) -> f64 {
    let lowest = |i: &usize| others.iter().all(|other| a.points[*i].y <= other.points[*i].y);
    (0..a.points.len()).filter(lowest).count() as f64 / a.points.len().max(1) as f64
}

/// A plot without marks.
pub(crate) fn plot(title: impl Into<String>, x: Axis, y: Axis, series: Vec<Series>) -> Plot {
    Plot { title: title.into(), x, y, series, marks: Vec::new() }
}

/// Plots and their series in the order in which they were first added to.
#[derive(Default)]
pub(crate) struct Panels(pub(crate) Vec<Plot>);

impl Panels {
    /// Adds a point to the series of this name and kind in the plot of this title.
    pub(crate) fn add(
        &mut self,
        title: &str,
        axes: [Axis; 2],
        (name, kind): (&str, SeriesKind),
        point: PlotPoint,
    ) {
        let Self(plots) = self;
        let place = plots.iter().position(|plot| plot.title == title).unwrap_or(plots.len());
        if place == plots.len() {
            let [x, y] = axes;
            plots.push(plot(title, x, y, Vec::new()));
        }
        let all = &mut plots[place].series;
        match all.iter_mut().find(|series| series.name == name && series.kind == kind) {
            Some(series) => series.points.push(point),
            None => all.push(Series { name: name.to_owned(), kind, points: vec![point] }),
        }
    }
}

/// Plots under the caption of the configuration.
pub(crate) fn plots(part: &str, plots: Vec<Plot>) -> Figure {
    Figure { part: part.to_owned(), caption: String::new(), panels: FigurePanels::Plots(plots) }
}

/// The vertical axis of reconstruction errors, in the paper's unit: the fourth power of the mesh unit.
pub(crate) fn error_axis() -> Axis {
    Axis::log("reconstruction error", "mesh units⁴")
}

/// Whole numbers as values on an axis.
pub(crate) fn places(counts: &[usize]) -> Vec<f64> {
    counts.iter().map(|&n| n as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_e_measure_depends_on_the_sizes_of_classes() {
        // Four others of the class among the nine other shapes: precision 4/9, recall 1.
        let labels = Labels::new(&["a", "a", "a", "a", "a", "b", "b", "b", "b", "b"]);
        assert!((best_e(&labels).unwrap() - 2.0 * (4.0 / 9.0) / (1.0 + 4.0 / 9.0)).abs() < 1e-12);
    }

    #[test]
    fn the_median_is_one_of_the_runs() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), (2, 2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), (2, 2.0));
        let found = series("a", &[1.0, 2.0], &[vec![5.0, 1.0], vec![7.0, 3.0], vec![6.0, 2.0]]);
        let first = PlotPoint { x: 1.0, y: 6.0, low: 5.0, high: 7.0, note: "3 runs".to_owned() };
        assert_eq!(found.points[0], first);
        assert_eq!(medians(&found), [6.0, 2.0]);
        assert_eq!(share_lowest(&found, &[&found]), 1.0);
        let lower = series("b", &[1.0, 2.0], &[vec![5.0, 2.5]]);
        assert_eq!(share_lowest(&found, &[&lower]), 0.5);
    }
}
