//! How well signatures and forms bring together what belongs together.
//!
//! Measures, for `METHOD` a signature, `aligned forms`, `fused`, `fused and forms` and `SCALE` in `raw`, where size
//! counts, and `normalized`: `METHOD SCALE nn|ft|st|e|dcg|map|macro nn|macro map|knn|least map`; at scale `raw` also
//! `forms in mesh units`; and `missed`, `mistaken`.

use std::collections::BTreeMap;
use std::time::Instant;

use anyhow::Result;
use canonform::{DescribeOptions, ShapeDescription, describe, form_matches};
use descriptors::{CanonicalForm, FormDistance, MatchOptions, Normalization, ShapeMetric, SignatureKind};
use linalg::DistanceMatrix;
use report::results::{Classification, RetrievalRecord, RetrievalRow, Scale, write};
use report::retrieval::retrieval;
use report::tables::retrieval_table;
use retrieval::{
    Averaging, Labels, Neighbor, UnknownThreshold, confusion_matrix, mean_scores, precision_recall, rank,
    vote,
};

use crate::collection::map;
use crate::run::Context;

/// Recalls at which precision is measured.
const RECALLS: usize = 21;

/// The way to compare that classifies.
const CLASSIFIER: &str = "fused and forms";

/// Runs the experiment, writes `retrieval.json` and its pictures and prints the scores.
pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let start = Instant::now();
    let options = DescribeOptions::default();
    let shapes = map(&context.collection.all(), "describing", context.observer, |shape| {
        Ok(describe(&shape.surface, &options)?)
    })?;
    let described = start.elapsed();
    let names = context.collection.labels();
    let labels = Labels::new(&names);
    let mut rows = Vec::new();
    let mut classification = Classification::default();
    for (method, scale, distances) in distances(context, &shapes)? {
        rows.push(row(&method, scale, &distances, &labels, context.config.knn)?);
        if method == CLASSIFIER && scale == Scale::Normalized {
            classification = classified(&method, &distances, &labels, &names, context.config.knn)?;
        }
    }
    let mut provenance = context.provenance(
        serde_json::json!({ "description": options.text(), "matching": format!("{:?}", MatchOptions::default()) }),
        start.elapsed(),
    );
    provenance.seconds.insert("describing".to_owned(), described.as_secs_f64());
    let measured = measured(&rows, &classification);
    let record = RetrievalRecord {
        expectations: context.check(|name| measured.get(name).copied())?,
        analysis: context.config.analysis.trim().to_owned(),
        provenance,
        names: context.collection.names(),
        labels: names,
        rows,
        classification,
    };
    retrieval(&record, context.output("retrieval"))?;
    write(&record, context.output("retrieval.json"))?;
    context.say(&retrieval_table(&record))
}

/// Every way to compare, with its distances between all pairs.
fn distances(
    context: &Context<'_>,
    shapes: &[ShapeDescription],
) -> Result<Vec<(String, Scale, DistanceMatrix)>> {
    let n = shapes.len();
    let all = |distance: &dyn Fn(usize, usize) -> f64| DistanceMatrix::from_pairs(n, distance);
    let forms: Vec<CanonicalForm> = shapes.iter().map(|shape| shape.form.clone()).collect();
    let aligned = |normalization| {
        let found = form_matches(&forms, normalization, &MatchOptions::default(), context.observer);
        found.map(|found| found.distances)
    };
    let form = aligned(Normalization::UnitArea)?;
    let size_of = |i: usize| ShapeMetric::size_coordinate(shapes[i].area);
    let size = |i: usize, j: usize| size_of(i) - size_of(j);
    let unit = ShapeMetric::form_unit(FormDistance::NearestNeighborRms);
    let mut found = Vec::new();
    for scale in [Scale::Normalized, Scale::Raw] {
        let area = |shape: &ShapeDescription| Some(shape.area).filter(|_| scale == Scale::Raw);
        let mut add = |method: &str, distances| found.push((method.to_owned(), scale, distances));
        let vectors: Vec<_> =
            shapes.iter().map(|shape| ShapeMetric::fuse(&shape.signatures, area(shape))).collect();
        let fused = all(&|i, j| ShapeMetric::fused(&vectors[i], &vectors[j]))?;
        add(CLASSIFIER, all(&|i, j| ShapeMetric::combined(fused.get(i, j), form.get(i, j)))?);
        add("fused", fused);
        match scale {
            Scale::Normalized => add("aligned forms", form.clone()),
            Scale::Raw => {
                add("aligned forms", all(&|i, j| (form.get(i, j) / unit).hypot(size(i, j)))?);
            }
        }
        for kind in SignatureKind::ALL {
            let signature = |shape: &ShapeDescription| {
                let signature = shape.signature(kind)?.clone();
                Some(match area(shape) {
                    Some(area) => ShapeMetric::with_size(signature, area),
                    None => signature,
                })
            };
            let signatures: Vec<_> = shapes.iter().filter_map(signature).collect();
            add(kind.name(), all(&|i, j| signatures[i].distance(&signatures[j]))?);
        }
        if scale == Scale::Raw {
            add("forms in mesh units", aligned(Normalization::Raw)?);
        }
    }
    Ok(found)
}

fn row(
    method: &str,
    scale: Scale,
    distances: &DistanceMatrix,
    labels: &Labels,
    knn: usize,
) -> Result<RetrievalRow> {
    let micro = mean_scores(distances, labels, Averaging::Micro)?;
    let votes = confusion_matrix(distances, labels, knn)?;
    let (mut right, mut total) = (0, 0);
    for (class, row) in votes.iter().enumerate() {
        right += row[class];
        total += row.iter().sum::<usize>();
    }
    let mut held_out_map = micro.map;
    for class in 0..labels.classes().len() {
        // A collection of two classes has nothing to tell apart without one.
        let (rest, rest_labels) = without(distances, labels, class)?;
        if rest_labels.classes().len() > 1
            && let Ok(scores) = mean_scores(&rest, &rest_labels, Averaging::Micro)
        {
            held_out_map = held_out_map.min(scores.map);
        }
    }
    Ok(RetrievalRow {
        method: method.to_owned(),
        scale,
        micro,
        macro_average: mean_scores(distances, labels, Averaging::Macro)?,
        knn_accuracy: right as f64 / total.max(1) as f64,
        held_out_map,
        precision: precision_recall(distances, labels, Averaging::Micro, RECALLS)?,
    })
}

/// The collection less one class.
fn without(distances: &DistanceMatrix, labels: &Labels, class: usize) -> Result<(DistanceMatrix, Labels)> {
    let kept: Vec<usize> = (0..labels.n_points()).filter(|&i| labels.class(i) != class).collect();
    let names: Vec<&str> = kept.iter().map(|&i| labels.classes()[labels.class(i)].as_str()).collect();
    let rest = DistanceMatrix::from_pairs(kept.len(), |i, j| distances.get(kept[i], kept[j]))?;
    Ok((rest, Labels::new(&names)))
}

/// Every shape classified by the others, and the unknown: how many are called so in error, and how many are not.
fn classified(
    method: &str,
    distances: &DistanceMatrix,
    labels: &Labels,
    names: &[String],
    voters: usize,
) -> Result<Classification> {
    let classes = labels.classes();
    let threshold = UnknownThreshold::leave_one_out(distances, labels);
    let mut confusion = vec![vec![0; classes.len() + 1]; classes.len()];
    for i in 0..names.len() {
        let ranking = rank(distances, i);
        let neighbors: Vec<Neighbor> = ranking
            .order
            .iter()
            .zip(&ranking.distances)
            .map(|(&index, &distance)| Neighbor { index, distance })
            .collect();
        let found = vote(&neighbors, |i| labels.class(i), voters, threshold).class;
        confusion[labels.class(i)][found.unwrap_or(classes.len())] += 1;
    }
    let (mut missed, mut mistaken) = ([0usize; 2], [0usize; 2]);
    for class in 0..classes.len() {
        let (rest, rest_labels) = without(distances, labels, class)?;
        let Some(threshold) = UnknownThreshold::leave_one_out(&rest, &rest_labels) else { continue };
        for i in (0..names.len()).filter(|&i| labels.class(i) == class) {
            let ranking = rank(distances, i);
            for (same, [errors, all]) in [(true, &mut missed), (false, &mut mistaken)] {
                let is = |j: &usize| (labels.class(*j) == class) == same;
                let Some(at) = ranking.order.iter().position(is) else { continue };
                let near = ranking.distances[at] <= threshold.distance;
                *errors += usize::from(near != same);
                *all += 1;
            }
        }
    }
    let share = |[errors, all]: [usize; 2]| errors as f64 / all.max(1) as f64;
    Ok(Classification {
        method: method.to_owned(),
        voters,
        classes: classes.to_vec(),
        confusion,
        threshold: threshold.map_or(0.0, |threshold| threshold.distance),
        missed: share(missed),
        mistaken: share(mistaken),
    })
}

/// Numbers by the names that configurations use.
fn measured(rows: &[RetrievalRow], classification: &Classification) -> BTreeMap<String, f64> {
    let mut found = BTreeMap::new();
    for row in rows {
        let (s, m) = (&row.micro, &row.macro_average);
        let scores = [
            ("nn", s.nn),
            ("ft", s.ft),
            ("st", s.st),
            ("e", s.e),
            ("dcg", s.dcg),
            ("map", s.map),
            ("macro nn", m.nn),
            ("macro map", m.map),
            ("knn", row.knn_accuracy),
            ("least map", row.held_out_map),
        ];
        for (score, value) in scores {
            found.insert(format!("{} {} {score}", row.method, row.scale.name()), value);
        }
    }
    found.insert("missed".to_owned(), classification.missed);
    found.insert("mistaken".to_owned(), classification.mistaken);
    found
}
