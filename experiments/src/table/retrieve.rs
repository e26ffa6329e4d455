//! Retrieval and classification by signatures and canonical forms.
//!
//! Measures `METHOD SCALE nn|ft|st|e|dcg|mAP|macro nn|macro mAP|knn|least mAP` for `METHOD` a signature, `aligned forms`,
//! `fused`, `fused and forms`, with `SCALE` either `raw` (size counts) or `normalized`; at scale `raw` also for `forms in
//! mesh units`; and `missed`, `mistaken`. Each score but the last is also measured on the neighbour graph, as `METHOD SCALE
//! graph SCORE`.

use std::io::Write;

use anyhow::Result;
use canonform::DescribeOptions;
use canonform::compare::form_alignments;
use canonform::embed::signature;
use canonform::index::Shape;
use descriptors::{CanonicalForm, Normalization, ShapeMetric, SignatureKind};
use linalg::DistanceMatrix;
use rayon::prelude::*;
use report::results::{
    BothRankings, Classification, Misclassified, RankedScores, RetrievalResults, RetrievalRow, Scale,
};
use retrieval::{
    Averaging, BootstrapOptions, GraphRankings, Labels, Neighbor, QueryScores, Rankings, Scores,
    SplitOptions, UnknownThreshold, bootstrap, precision_recall, rank, split_accuracy, vote,
};
use serde::Deserialize;

use crate::context::Context;
use crate::experiment::Experiment;
use crate::gallery::Gallery;
use crate::sweep::{MeasuredNumbers, best_e, named, note};

/// The number of recalls at which precision is measured.
const RECALLS: usize = 21;

/// The method that classifies.
const CLASSIFIER: &str = "fused and forms";

/// The method that classifies a collection too large for that.
const LARGE_CLASSIFIER: &str = "fused";

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RetrievalOptions {
    /// Number of nearest neighbours that vote.
    voters: usize,
    /// Training shapes of each class, for classification over random splits.
    training: Vec<usize>,
    /// Number of random splits.
    splits: usize,
    /// Most shapes whose forms are all aligned with each other.
    aligned: usize,
}

impl Experiment for RetrievalOptions {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let gallery = Gallery::new(context)?;
        let (shapes, labels) = (&gallery.described, &gallery.labels);
        let described = context.start.elapsed();
        let mut rows = Vec::new();
        let mut classification = Classification::default();
        let classifier = if shapes.len() <= self.aligned { CLASSIFIER } else { LARGE_CLASSIFIER };
        let found = self.distances(context, shapes)?;
        context.observer.begin("scoring", found.len());
        for (method, scale, distances) in found {
            rows.push(self.row(context, &method, scale, &distances, labels)?);
            context.observer.step();
            if method == classifier && scale == Scale::Normalized {
                classification = self.classified(context, &method, &distances, labels)?;
            }
        }
        let mut provenance = context.provenance(&[("description", &gallery.options)]);
        provenance.seconds.insert("describing".to_owned(), described.as_secs_f64());
        let measured = measured(&rows, &classification);
        let best_e = Some(best_e(labels)?);
        let protocol = self.protocol(context, labels);
        context.bars.finish();
        let mut out = std::io::stdout().lock();
        protocol.iter().try_for_each(|line| writeln!(out, "{line}"))?;
        drop(out);
        let published = context.published.cloned();
        let results = RetrievalResults {
            names: context.collection.names(),
            labels: context.collection.labels(),
            rows,
            best_e,
            classification,
            protocol,
            published,
        };
        context.publish(results, provenance, &measured)
    }
}

impl RetrievalOptions {
    /// How scores are measured.
    fn protocol(&self, context: &Context<'_>, labels: &Labels) -> Vec<String> {
        let n = labels.n_points();
        let n_queries = (0..n).filter(|i| labels.is_query(*i)).count();
        let n_classes = labels.classes().len();
        let BootstrapOptions { resamples, level, seed } = BootstrapOptions::default();
        let mut lines = vec![
            format!("{n} shapes in {n_classes} classes."),
            format!(
                "Each shape is a query against all {} others, its own class included; {} shapes in classes of one or two are \
                 in the gallery but are no queries, so there are {n_queries} queries.",
                n.saturating_sub(1),
                n - n_queries
            ),
            "Equal distances are ordered by the position of the shape in the collection.".to_owned(),
            "NN, FT, ST, E (at 32 results) and DCG as in the Princeton shape benchmark, mAP over the whole ranking; means \
             are over queries (micro) and over classes (macro)."
                .to_owned(),
            format!(
                "Intervals cover {:.0} % of {resamples} bootstrap resamples of the queries within classes, seed {seed}.",
                100.0 * level
            ),
            format!(
                "1-NN over {} random splits, seed {}: mean and standard deviation over the splits; classes with no more \
                 shapes than are trained with take no part.",
                self.splits, context.seed
            ),
            format!("k-NN: leave-one-out vote of {} neighbours.", self.voters),
            "Plain: ranked by distance alone. Graph: ranked on the graph of nearest neighbours of the whole collection, \
             without its classes."
                .to_owned(),
        ];
        if n > self.aligned {
            lines.push(format!(
                "Methods that align the forms of all pairs are left out: {n} shapes are more than {}.",
                self.aligned
            ));
        }
        lines
    }

    /// Every method with its distances between all pairs.
    fn distances(
        &self,
        context: &Context<'_>,
        shapes: &[Shape],
    ) -> Result<Vec<(String, Scale, DistanceMatrix)>> {
        let n = shapes.len();
        let all = |distance: &dyn Fn(usize, usize) -> f64| DistanceMatrix::from_pairs(n, distance);
        let forms: Vec<CanonicalForm> =
            shapes.iter().map(|shape| DescribeOptions::default().form_of(shape)).collect::<Result<_, _>>()?;
        let aligned = |normalization| {
            let found = form_alignments(&forms, normalization, context.observer);
            found.map(|found| found.distances)
        };
        let aligns = n <= self.aligned;
        let form = if aligns { Some(aligned(Normalization::UnitArea)?) } else { None };
        let size_of = |i: usize| ShapeMetric::size_coordinate(shapes[i].entry.facts.area);
        let size = |i: usize, j: usize| size_of(i) - size_of(j);
        let unit = ShapeMetric::FORM_UNIT;
        let mut found = Vec::new();
        for scale in [Scale::Normalized, Scale::Raw] {
            let area = |shape: &Shape| Some(shape.entry.facts.area).filter(|_| scale == Scale::Raw);
            let mut add = |method: &str, distances| found.push((method.to_owned(), scale, distances));
            let fuse = |shape: &Shape| {
                let signatures =
                    SignatureKind::INTRINSIC.into_iter().filter_map(|kind| signature(shape, kind));
                ShapeMetric::fuse(&signatures.collect::<Vec<_>>(), area(shape))
            };
            let vectors: Vec<_> = shapes.iter().map(fuse).collect();
            let fused = all(&|i, j| ShapeMetric::fused(&vectors[i], &vectors[j]))?;
            if let Some(form) = &form {
                let robust = |i: usize, j: usize| ShapeMetric::robust(&vectors[i], &vectors[j]);
                add(CLASSIFIER, all(&|i, j| ShapeMetric::combined(robust(i, j), form.get(i, j)))?);
                let sized = all(&|i, j| (form.get(i, j) / unit).hypot(size(i, j)))?;
                add("aligned forms", if scale == Scale::Raw { sized } else { form.clone() });
            }
            add("fused", fused);
            for kind in SignatureKind::ALL {
                let of = |shape: &Shape| {
                    let own = signature(shape, kind)?;
                    Some(area(shape).map_or(own.clone(), |area| ShapeMetric::with_size(own, area)))
                };
                let signatures: Vec<_> = shapes.iter().filter_map(of).collect();
                // Only mechanical parts have a rigid one.
                if signatures.len() < n {
                    continue;
                }
                add(kind.name(), all(&|i, j| signatures[i].distance(&signatures[j]))?);
            }
            if scale == Scale::Raw && aligns {
                add("forms in mesh units", aligned(Normalization::Raw)?);
            }
        }
        Ok(found)
    }

    /// All scores of one ranking.
    fn ranked(
        &self,
        context: &Context<'_>,
        rankings: &KeptRankings,
        labels: &Labels,
    ) -> Result<RankedScores> {
        let scores = QueryScores::new(rankings, labels)?;
        let intervals = |averaging| bootstrap(&scores, labels, averaging, &BootstrapOptions::default());
        let (mut right, mut all) = (0, 0);
        for query in (0..labels.n_points()).filter(|i| labels.is_query(*i)) {
            let found = vote(&rankings.0[query], |i| labels.class(i), self.voters, None).class();
            right += usize::from(found == Some(labels.class(query)));
            all += 1;
        }
        let mut splits = Vec::new();
        for n_train in self.training.iter().copied() {
            let options = SplitOptions { n_train, runs: self.splits, seed: context.seed };
            splits.extend(split_accuracy(rankings, labels, &options)?);
        }
        Ok(RankedScores {
            micro: scores.mean(labels, Averaging::Micro),
            micro_intervals: intervals(Averaging::Micro)?,
            macro_average: scores.mean(labels, Averaging::Macro),
            macro_intervals: intervals(Averaging::Macro)?,
            knn_accuracy: f64::from(right as u32) / f64::from(all.max(1) as u32),
            splits,
        })
    }

    fn row(
        &self,
        context: &Context<'_>,
        method: &str,
        scale: Scale,
        distances: &DistanceMatrix,
        labels: &Labels,
    ) -> Result<RetrievalRow> {
        let plain = self.ranked(context, &KeptRankings::new(distances), labels)?;
        let graph = self.ranked(context, &KeptRankings::new(&GraphRankings::new(distances)), labels)?;
        let mut held_out_map = plain.micro.map;
        for class in 0..labels.classes().len() {
            // Without one of two classes there is nothing to distinguish.
            let (rest, rest_labels) = without(distances, labels, class)?;
            if rest_labels.classes().len() > 1
                && let Ok(scores) = QueryScores::new(&rest, &rest_labels)
            {
                held_out_map = held_out_map.min(scores.mean(&rest_labels, Averaging::Micro).map);
            }
        }
        Ok(RetrievalRow {
            method: method.to_owned(),
            scale,
            micro: plain.micro,
            macro_average: plain.macro_average,
            knn_accuracy: plain.knn_accuracy,
            held_out_map,
            precision: precision_recall(distances, labels, Averaging::Micro, RECALLS)?,
            rankings: Some(BothRankings { plain, graph }),
        })
    }

    /// The classification of every shape by the others, and the error rates for unknown shapes.
    fn classified(
        &self,
        context: &Context<'_>,
        method: &str,
        distances: &DistanceMatrix,
        labels: &Labels,
    ) -> Result<Classification> {
        let (voters, shapes) = (self.voters, &context.collection.shapes);
        let classes = labels.classes();
        let mut misclassified = Vec::new();
        let threshold = UnknownThreshold::leave_one_out(distances, labels);
        let limit = threshold.map(|threshold| threshold.distance);
        let mut confusion = vec![vec![0; classes.len() + 1]; classes.len()];
        for i in 0..labels.n_points() {
            let ranking = rank(distances, i);
            let found = vote(&ranking, |i| labels.class(i), voters, limit).class();
            confusion[labels.class(i)][found.unwrap_or(classes.len())] += 1;
            if found != Some(labels.class(i)) {
                let nearest = ranking.first();
                misclassified.push(Misclassified {
                    name: shapes[i].name.clone(),
                    label: shapes[i].label.clone(),
                    predicted: found.map(|class| classes[class].clone()),
                    nearest: nearest.map_or_else(String::new, |near| shapes[near.index].name.clone()),
                    distance: nearest.map_or(0.0, |near| near.distance),
                });
            }
        }
        let (mut missed, mut mistaken) = ([0usize; 2], [0usize; 2]);
        for class in 0..classes.len() {
            let (rest, rest_labels) = without(distances, labels, class)?;
            let Some(threshold) = UnknownThreshold::leave_one_out(&rest, &rest_labels) else { continue };
            for i in (0..labels.n_points()).filter(|&i| labels.class(i) == class) {
                let ranking = rank(distances, i);
                for (same, [errors, all]) in [(true, &mut missed), (false, &mut mistaken)] {
                    let nearest = ranking.iter().find(|n| (labels.class(n.index) == class) == same);
                    let Some(nearest) = nearest else { continue };
                    let near = nearest.distance <= threshold.distance;
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
            misclassified,
            threshold: limit.unwrap_or(0.0),
            missed: share(missed),
            mistaken: share(mistaken),
        })
    }
}

/// Rankings of all shapes, made once.
struct KeptRankings(Vec<Vec<Neighbor>>);

impl KeptRankings {
    fn new(rankings: &impl Rankings) -> Self {
        Self((0..rankings.n_points()).into_par_iter().map(|query| rankings.ranking(query)).collect())
    }
}

impl Rankings for KeptRankings {
    fn n_points(&self) -> usize {
        self.0.len()
    }

    fn ranking(&self, query: usize) -> Vec<Neighbor> {
        self.0[query].clone()
    }
}

/// The collection without one class.
fn without(distances: &DistanceMatrix, labels: &Labels, class: usize) -> Result<(DistanceMatrix, Labels)> {
    let kept: Vec<usize> = (0..labels.n_points()).filter(|&i| labels.class(i) != class).collect();
    let names: Vec<&str> = kept.iter().map(|&i| labels.classes()[labels.class(i)].as_str()).collect();
    let rest = DistanceMatrix::from_pairs(kept.len(), |i, j| distances.get(kept[i], kept[j]))?;
    Ok((rest, Labels::new(&names)))
}

/// Numbers by their names in the configuration.
fn measured(rows: &[RetrievalRow], classification: &Classification) -> MeasuredNumbers {
    let mut found = MeasuredNumbers::new();
    for row in rows {
        let of = format!("{} {}", row.method, row.scale.name());
        let averages =
            |average: &Scores, knn| [("macro nn", average.nn), ("macro mAP", average.map), ("knn", knn)];
        note(&mut found, &of, named(&row.micro));
        note(&mut found, &of, averages(&row.macro_average, row.knn_accuracy));
        note(&mut found, &of, [("least mAP", row.held_out_map)]);
        if let Some(BothRankings { graph, .. }) = &row.rankings {
            note(&mut found, &format!("{of} graph"), named(&graph.micro));
            note(&mut found, &format!("{of} graph"), averages(&graph.macro_average, graph.knn_accuracy));
        }
    }
    found.insert("missed".to_owned(), classification.missed);
    found.insert("mistaken".to_owned(), classification.mistaken);
    found
}
