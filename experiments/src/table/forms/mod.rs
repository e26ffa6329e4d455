//! Forms: retrieval by canonical forms alone, with size ignored, for every method that makes forms and every way to compare them;
//! and what a perfect alignment of two forms of one class would give.
//!
//! Measures `METHOD COMPARISON nn|ft|st|e|dcg|mAP|silhouette|2D silhouette|seconds` and `METHOD form seconds`, with the methods of
//! [`made::FormMaker`] and the comparisons of [`compared::FormComparison`]; for built-in shapes, whose points correspond, also
//! `METHOD partners|ideal|aligned|between`, see [`ideal::IdealAlignments`].

mod compared;
mod ideal;
mod made;

use anyhow::Result;
use canonform::compare::embedded_distances;
use linalg::DistanceMatrix;
use nmds::classical_full;
use report::results::{Axis, AxisScale, CurvesPanel, Mark, RecordedTable, Series, SeriesPoint, TableEntry};
use retrieval::{
    Averaging, BootstrapOptions, Labels, QueryScores, ScoreIntervals, Scores, bootstrap, silhouette,
};
use serde::Deserialize;

use self::compared::FormComparison;
use self::ideal::IdealAlignments;
pub(crate) use self::made::FormMaker;
use self::made::{MadeForm, ShapeDistances};
use crate::collection::LabeledSurface;
use crate::context::Context;
use crate::experiment::Experiment;
use crate::sweep::{MeasuredNumbers, linear, mean, named, note, panel};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FormsOptions {
    /// Samples of a form.
    samples: usize,
    /// Samples of the form with more of them.
    more_samples: usize,
    /// Most vertices of shapes whose distances between all pairs of vertices are measured.
    all_pairs: usize,
    /// Most shapes whose forms are all aligned with each other.
    aligned: usize,
}

/// The scores of one comparison of the forms by one method.
struct FormScores {
    maker: FormMaker,
    comparison: FormComparison,
    mean: Scores,
    intervals: ScoreIntervals,
    /// Of the classes, by the distances and on their map in the plane.
    silhouettes: [f64; 2],
    /// Seconds of a shape: for its form, and for its signature.
    seconds: [f64; 2],
}

impl Experiment for FormsOptions {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let shapes = context.collection.all();
        let labels = Labels::new(&context.collection.labels());
        let distances = ShapeDistances::of(&shapes, self.more_samples, context)?;
        let (mut rows, mut ideals) = (Vec::new(), Vec::new());
        let is_small = |shape: &&LabeledSurface| shape.surface.mesh().n_vertices() <= self.all_pairs;
        let is_few = shapes.len() <= self.aligned && shapes.iter().all(is_small);
        for maker in FormMaker::ALL.into_iter().filter(|maker| is_few || !maker.needs_all_pairs()) {
            let made = maker.forms(&shapes, &distances, [self.samples, self.more_samples], context)?;
            for comparison in FormComparison::ALL {
                let is_slow = comparison == FormComparison::Aligned && shapes.len() > self.aligned;
                if !is_slow && (comparison.any_dimension() || !maker.has_many_dimensions()) {
                    rows.push(FormScores::new(maker, comparison, &made, &labels, context)?);
                }
            }
            if context.collection.is_built_in() && !maker.has_many_dimensions() {
                ideals.push((maker, IdealAlignments::measure(&shapes, &made, context)?));
            }
        }
        let mut measured = MeasuredNumbers::new();
        for row in &rows {
            let of = format!("{} {}", row.maker.name(), row.comparison.name());
            note(&mut measured, &of, named(&row.mean));
            let [own, plane] = row.silhouettes;
            let [form, signature] = row.seconds;
            note(&mut measured, &of, [("silhouette", own), ("2D silhouette", plane), ("seconds", signature)]);
            note(&mut measured, row.maker.name(), [("form seconds", form)]);
        }
        let mut tables = vec![table(&rows)];
        for (maker, ideal) in &ideals {
            note(&mut measured, maker.name(), ideal.numbers());
        }
        if !ideals.is_empty() {
            tables.push(ideal::table(&ideals));
        }
        context.publish_with_tables(vec![figure(&rows)], tables, context.provenance(&[]), &measured)
    }
}

impl FormScores {
    fn new(
        maker: FormMaker,
        comparison: FormComparison,
        made: &[MadeForm],
        labels: &Labels,
        context: &Context<'_>,
    ) -> Result<Self> {
        let (distances, seconds) = comparison.distances(made, context)?;
        let scores = QueryScores::new(&distances, labels)?;
        let options = BootstrapOptions::default();
        Ok(Self {
            maker,
            comparison,
            mean: scores.mean(labels, Averaging::Micro),
            intervals: bootstrap(&scores, labels, Averaging::Micro, &options)?,
            silhouettes: [silhouette(&distances, labels), silhouette(&in_the_plane(&distances)?, labels)],
            seconds: [mean(made.iter().map(|made| made.seconds)), seconds],
        })
    }
}

/// Distances on the map of a collection in the plane.
fn in_the_plane(distances: &DistanceMatrix) -> Result<DistanceMatrix> {
    Ok(embedded_distances(&classical_full(distances, 2)?.coords)?)
}

fn table(rows: &[FormScores]) -> RecordedTable {
    let level = rows.first().map_or(0.0, |row| 100.0 * row.intervals.level);
    let scores = ["NN", "FT", "ST", "E", "DCG", "mAP"];
    let headings = ["form", "compared by"].into_iter().chain(scores);
    let headings = headings.chain(["silhouette", "2D silhouette", "form, ms", "signature, ms"]);
    let one = |row: &FormScores| {
        let FormScores { mean, intervals, silhouettes, seconds, .. } = row;
        let ends = intervals.low.to_array().into_iter().zip(intervals.high.to_array());
        let score = |(score, (low, high)): (f64, (f64, f64))| {
            format!("{score:.3} ({low:.2}-{high:.2})").as_str().into()
        };
        let mut entries: Vec<TableEntry> = vec![row.maker.name().into(), row.comparison.name().into()];
        entries.extend(mean.to_array().into_iter().zip(ends).map(score));
        entries.extend(silhouettes.map(TableEntry::from));
        entries.extend(seconds.map(|seconds| TableEntry::from(1000.0 * seconds)));
        entries
    };
    RecordedTable {
        caption: format!(
            "Retrieval by forms alone, size ignored; intervals cover {level:.0} % of the resampled queries."
        ),
        folded: None,
        headings: headings.map(str::to_owned).collect(),
        rows: rows.iter().map(one).collect(),
    }
}

/// The mean average precision of every comparison, a curve for each method.
fn figure(rows: &[FormScores]) -> CurvesPanel {
    let place = |comparison: FormComparison| FormComparison::ALL.iter().position(|c| *c == comparison);
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        let name = row.maker.name();
        let (mean, intervals) = (row.mean.map, row.intervals);
        let x = place(row.comparison).map_or(0.0, |place| place as f64);
        let point =
            SeriesPoint { x, median: mean, low: intervals.low.map, high: intervals.high.map, runs: 1 };
        match series.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => series.push(Series { name: name.to_owned(), points: vec![point] }),
        }
    }
    let mark = |comparison: FormComparison| {
        let x = place(comparison).map_or(0.0, |place| place as f64);
        Mark { x, name: comparison.name().to_owned() }
    };
    let x = Axis { scale: AxisScale::Category, ..linear("compared by") };
    let plain = panel("Mean average precision", x, linear("mAP"), series);
    CurvesPanel { marks: FormComparison::ALL.map(mark).to_vec(), ..plain }
}
