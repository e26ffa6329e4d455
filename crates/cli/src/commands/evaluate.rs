//! `canonform evaluate`.

use std::process::ExitCode;

use anyhow::Result;
use base::terminal::Bars;
use canonform::collection::LabelSource;
use canonform::library::{EvaluateOptions, IndexEvaluation, evaluate_index, evaluate_matrix};
use canonform::mesh::io::extension;
use canonform::retrieval::{RankingEvaluation, ScoreIntervals, Scores};

use crate::args::{Common, EvaluateArgs};
use crate::input::named;
use crate::output::{Answer, Fact, count, facts, report, row_of, table_of};

/// Scores an index or a matrix.
pub(crate) fn evaluate(args: &EvaluateArgs, common: &Common) -> Result<ExitCode> {
    let labels = args.labels.as_deref().map(LabelSource::read).transpose()?;
    let options =
        EvaluateOptions { measure: args.by, labels: labels.as_ref(), knn_k: args.k, rank_by: args.rank };
    let scores = if extension(&args.input) == "csv" {
        evaluate_matrix(&args.input, &options).map(|scores| IndexEvaluation { scores, agreement: None })
    } else {
        evaluate_index(&args.input, &options, &Bars::new(common.quiet))
    };
    let scores = scores.map_err(|fault| named(&args.input, fault))?;
    report(common, &scores, |scores| text(scores, common))
}

/// The mean scores of a ranking with their intervals, and its votes.
fn column(ranking: &RankingEvaluation, knn_k: usize) -> [Fact; 7] {
    type Score = fn(&Scores) -> f64;
    let scores: [(&str, Score); 6] = [
        ("nearest neighbor", |s| s.nn),
        ("first tier", |s| s.ft),
        ("second tier", |s| s.st),
        ("E-measure", |s| s.e),
        ("DCG", |s| s.dcg),
        ("mAP", |s| s.map),
    ];
    let RankingEvaluation { mean, intervals: ScoreIntervals { low, high, .. }, knn_accuracy, .. } = ranking;
    let [nn, first_tier, second_tier, e, dcg, map] = scores
        .map(|(name, score)| (name, format!("{:.4} ({:.4} to {:.4})", score(mean), score(low), score(high))));
    [nn, first_tier, second_tier, e, dcg, map, ("k-NN accuracy", format!("{knn_accuracy:.4} (k = {knn_k})"))]
}

fn confusion(title: &str, classes: &[String], counts: &[Vec<usize>]) -> comfy_table::Table {
    let mut table = table_of([title].into_iter().chain(classes.iter().map(String::as_str)));
    for (class, row) in classes.iter().zip(counts) {
        table.add_row(row_of([class.clone()].into_iter().chain(row.iter().map(usize::to_string))));
    }
    table
}

/// The number of queries whose nearest shape is of their class, and the scores that say more.
fn answer(IndexEvaluation { scores, agreement }: &IndexEvaluation) -> Answer {
    let (shapes, classes) = (count(scores.n, "shape"), count(scores.classes.len(), "class"));
    let [nn, first_tier, second_tier, e, dcg, map, votes] = column(&scores.plain, scores.knn_k);
    let explained = |(name, value): Fact, words: &str| (name, format!("{value}: {words}"));
    let mut facts = vec![
        explained(first_tier, "share of the class among as many results as it has shapes"),
        explained(map, "1 if every shape finds its whole class first"),
        votes,
        ("silhouette", format!("{:.4}: from -1 to 1, above 0 if classes are apart", scores.silhouette)),
    ];
    facts.extend(agreement.map(|it| {
        let (share, at, hits) = (100.0 * it.agree, it.boundary, it.same_class + it.other_classes);
        (
            "classes",
            format!("distances agree with {share:.0} % of {hits} hits; those of one class end at {at:.2}"),
        )
    }));
    let ScoreIntervals { level, resamples, .. } = scores.plain.intervals;
    let level = 100.0 * level;
    let intervals = format!("{level:.0} % intervals of the mean over queries, from {resamples} resamples");
    Answer {
        sentence: format!(
            "the nearest neighbor is of the same class for {:.1} % of {shapes} in {classes}",
            100.0 * scores.plain.mean.nn
        ),
        facts,
        details: vec![nn, second_tier, e, dcg, ("in parentheses", intervals)],
    }
}

fn text(found: &IndexEvaluation, common: &Common) -> String {
    let (mut text, scores) = (answer(found).text(common), &found.scores);
    if let Some(graph) = &scores.graph {
        text += "\n  ranked on the graph of nearest neighbors, instead of plain:\n";
        text += &facts(&column(graph, scores.knn_k));
    }
    if common.details {
        let graph = scores.graph.iter().map(|graph| ("true \\ predicted (graph)", graph));
        for (title, ranking) in [("true \\ predicted", &scores.plain)].into_iter().chain(graph) {
            text += &format!("\n{}", confusion(title, &scores.classes, &ranking.confusion));
        }
    }
    text
}
