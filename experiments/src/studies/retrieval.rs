//! Retrieval and classification by signatures and canonical forms.
//!
//! Measures `METHOD SCALE nn|ft|st|e|dcg|mAP|least mAP` for `METHOD` a signature, `aligned forms`,
//! `fused`, `fused and forms`, with `SCALE` either `raw` (size counts) or `normalized`; at scale `raw` also for `forms in
//! mesh units`. Each score but the last is also measured on the neighbor graph, as `METHOD SCALE
//! graph SCORE`.

use anyhow::Result;
use canonform::DescribeOptions;
use canonform::compare::form_alignments;
use canonform::embed::signature;
use canonform::index::Shape;
use descriptors::{CanonicalForm, Normalization, ShapeMetric, SignatureKind};
use linalg::DistanceMatrix;
use report::record::{Axis, Figure, FigurePanels, Plot};
use report::{Cell, Record, Table};
use retrieval::{Labels, QueryScores, RankBy, RankingEvaluation, evaluate, precision_recall};

use crate::context::Context;
use crate::gallery::Gallery;
use crate::sweep::{MeasuredNumbers, SCORES, best_e, curve, named, note, plot, point};

/// The number of recalls at which precision is measured.
const RECALLS: usize = 21;

/// Whether size counts, the name of that in expectations, and the title of its plot.
const SCALES: [(bool, &str, &str); 2] = [(false, "normalized", "size ignored"), (true, "raw", "size counts")];

pub(crate) fn retrieval(context: &Context<'_>) -> Result<Record> {
    let gallery = Gallery::new(context)?;
    let labels = &gallery.labels;
    let n = labels.n_points();
    let aligns = n <= context.options.aligned;
    let form = aligns.then(|| aligned(context, &gallery.described, Normalization::UnitArea)).transpose()?;
    let (mut measured, mut rows) = (MeasuredNumbers::new(), Vec::new());
    let mut plots: Vec<Plot> = Vec::new();
    for (counts_size, scale, title) in SCALES {
        let found = distances(context, &gallery.described, form.as_ref(), counts_size)?;
        context.observer.begin("scoring", found.len());
        let mut series = Vec::new();
        for (method, distances) in &found {
            rows.extend(rankings(context, method, scale, distances, labels, &mut measured)?);
            let precision = precision_recall(distances, labels, RECALLS)?;
            let points = precision.iter().enumerate();
            let points = points.map(|(i, &p)| point(i as f64 / (RECALLS - 1) as f64, &[p]));
            series.push(curve(method, points.collect()));
            context.observer.step();
        }
        let [x, y] = ["recall", "precision"].map(Axis::linear);
        plots.push(plot(title, x, y, series));
    }
    let caption = format!(
        "Precision over recall, averaged over queries among {n} shapes. Further right and up is better."
    );
    let figures = vec![Figure { part: "curves".to_owned(), caption, panels: FigurePanels::Plots(plots) }];
    let n_queries = (0..n).filter(|i| labels.is_query(*i)).count();
    measured.extend([("best e".to_owned(), best_e(labels)?), ("asked".to_owned(), n_queries as f64)]);
    let headings = ["method", "size", "ranking"].into_iter().chain(SCORES);
    let headings = headings.chain(["mAP interval", "k-NN", "least mAP"]);
    Ok(Record {
        tables: vec![Table::new("", headings, rows)],
        figures,
        ..context.record(&[("description", &gallery.options)], measured)
    })
}

/// The distances of aligned forms.
fn aligned(context: &Context<'_>, shapes: &[Shape], normalization: Normalization) -> Result<DistanceMatrix> {
    let forms: Vec<CanonicalForm> =
        shapes.iter().map(|shape| DescribeOptions::default().form_of(shape)).collect::<Result<_, _>>()?;
    Ok(form_alignments(&forms, normalization, context.observer)?)
}

/// Every method with its distances between all pairs; `form` holds those of aligned forms of unit area.
fn distances(
    context: &Context<'_>,
    shapes: &[Shape],
    form: Option<&DistanceMatrix>,
    counts_size: bool,
) -> Result<Vec<(String, DistanceMatrix)>> {
    let n = shapes.len();
    let all = |distance: &(dyn Fn(usize, usize) -> f64 + Sync)| DistanceMatrix::from_pairs(n, distance);
    let size_of = |i: usize| ShapeMetric::size_coordinate(shapes[i].entry.facts.area);
    let area = |shape: &Shape| Some(shape.entry.facts.area).filter(|_| counts_size);
    let fuse = |shape: &Shape| {
        let signatures = SignatureKind::INTRINSIC.into_iter().filter_map(|kind| signature(shape, kind));
        ShapeMetric::fuse(&signatures.collect::<Vec<_>>(), area(shape))
    };
    let vectors: Vec<_> = shapes.iter().map(fuse).collect();
    let mut found = Vec::new();
    let mut add = |method: &str, distances| found.push((method.to_owned(), distances));
    if let Some(form) = form {
        let robust = |i: usize, j: usize| ShapeMetric::robust(&vectors[i], &vectors[j]);
        add("fused and forms", all(&|i, j| ShapeMetric::combined(robust(i, j), form.get(i, j)))?);
        let sized =
            |i: usize, j: usize| (form.get(i, j) / ShapeMetric::FORM_UNIT).hypot(size_of(i) - size_of(j));
        add("aligned forms", if counts_size { all(&sized)? } else { form.clone() });
    }
    add("fused", all(&|i, j| ShapeMetric::fused(&vectors[i], &vectors[j]))?);
    for kind in SignatureKind::ALL {
        let of = |shape: &Shape| {
            let mut own = signature(shape, kind)?;
            // A difference of 5 % in size is as much as between two poses.
            let size = area(shape).map(ShapeMetric::size_coordinate);
            own.values.extend(size.map(|size| size * ShapeMetric::unit(kind)));
            Some(own)
        };
        let signatures: Vec<_> = shapes.iter().filter_map(of).collect();
        // Only mechanical parts have a rigid one.
        if signatures.len() == n {
            add(kind.name(), all(&|i, j| signatures[i].distance(&signatures[j]))?);
        }
    }
    if counts_size && form.is_some() {
        add("forms in mesh units", aligned(context, shapes, Normalization::Raw)?);
    }
    Ok(found)
}

/// The rows of a method in the table, by distance and on the graph.
fn rankings(
    context: &Context<'_>,
    method: &str,
    scale: &str,
    distances: &DistanceMatrix,
    labels: &Labels,
    measured: &mut MeasuredNumbers,
) -> Result<Vec<Vec<Cell>>> {
    let mut least = f64::INFINITY;
    for class in 0..labels.classes().len() {
        // Without one of two classes there is nothing to distinguish.
        let (rest, rest_labels) = without(distances, labels, class)?;
        if rest_labels.classes().len() > 1
            && let Ok(scores) = QueryScores::new(&rest, &rest_labels)
        {
            least = least.min(scores.mean().map);
        }
    }
    let found = evaluate(distances, labels, context.options.voters, RankBy::Graph)?;
    let least = least.min(found.plain.mean.map);
    let of = format!("{method} {scale}");
    note(measured, &of, [("least mAP", least)]);
    let mut row = |ranking: &str, of: &str, found: &RankingEvaluation, least: Option<f64>| {
        note(measured, of, named(&found.mean));
        let mut row: Vec<Cell> = [method, scale, ranking].map(Cell::from).to_vec();
        row.extend(found.mean.to_array().map(Cell::from));
        row.push(format!("{:.3} to {:.3}", found.intervals.low.map, found.intervals.high.map).into());
        row.extend([Cell::from(found.knn_accuracy), least.into()]);
        row
    };
    let mut rows = vec![row("plain", &of, &found.plain, Some(least))];
    rows.extend(found.graph.iter().map(|graph| row("graph", &format!("{of} graph"), graph, None)));
    Ok(rows)
}

/// The collection without one class.
fn without(distances: &DistanceMatrix, labels: &Labels, class: usize) -> Result<(DistanceMatrix, Labels)> {
    let kept: Vec<usize> = (0..labels.n_points()).filter(|&i| labels.class(i) != class).collect();
    let names: Vec<&str> = kept.iter().map(|&i| labels.classes()[labels.class(i)].as_str()).collect();
    let rest = DistanceMatrix::from_pairs(kept.len(), |i, j| distances.get(kept[i], kept[j]))?;
    Ok((rest, Labels::new(&names)))
}
