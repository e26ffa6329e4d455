//! `canonform evaluate`.

use std::process::ExitCode;

use anyhow::Result;
use canonform::retrieval::{Evaluation, ScoreIntervals, Scores};
use canonform::{EvaluateOptions, LabelFile, evaluate_index, evaluate_matrix};
use mesh::io::extension;
use terminal::Bars;

use crate::args::{Common, EvaluateArgs};
use crate::input::named;
use crate::output::report;

/// Scores an index or a matrix.
pub(crate) fn evaluate(args: &EvaluateArgs, common: &Common) -> Result<ExitCode> {
    let labels = args.labels.as_deref().map(LabelFile::read).transpose()?;
    let options =
        EvaluateOptions { measure: args.by, labels: labels.as_ref(), knn_k: args.k, rank_by: args.rank };
    let scores = if extension(&args.input) == "csv" {
        evaluate_matrix(&args.input, &options)
    } else {
        evaluate_index(&args.input, &options, &Bars::new(common.quiet))
    };
    let scores = scores.map_err(|fault| named(&args.input, fault))?;
    report(common, &scores, table)
}

/// One column of scores: names, and values with their intervals.
fn column(mean: &Scores, intervals: Option<&ScoreIntervals>) -> [(&'static str, String); 6] {
    type Score = fn(&Scores) -> f64;
    let scores: [(&str, Score); 6] = [
        ("nearest neighbour", |s| s.nn),
        ("first tier", |s| s.ft),
        ("second tier", |s| s.st),
        ("E-measure", |s| s.e),
        ("DCG", |s| s.dcg),
        ("mAP", |s| s.map),
    ];
    scores.map(|(name, score)| {
        let interval = intervals.map(|i| format!(" ({:.4} to {:.4})", score(&i.low), score(&i.high)));
        (name, format!("{:.4}{}", score(mean), interval.unwrap_or_default()))
    })
}

fn confusion(title: &str, classes: &[String], counts: &[Vec<usize>]) -> comfy_table::Table {
    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    table.set_header([title].into_iter().chain(classes.iter().map(String::as_str)));
    for (class, row) in classes.iter().zip(counts) {
        table.add_row([class.clone()].into_iter().chain(row.iter().map(usize::to_string)));
    }
    table
}

fn table(scores: &Evaluation) -> String {
    let votes = |accuracy: f64| format!("{accuracy:.4} (k = {})", scores.knn_k);
    let plain = column(&scores.mean, scores.intervals.as_ref());
    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    let mut rows: Vec<Vec<String>> =
        plain.into_iter().map(|(name, value)| vec![name.to_owned(), value]).collect();
    rows.push(vec!["k-NN accuracy".to_owned(), votes(scores.knn_accuracy)]);
    if let Some(graph) = &scores.graph {
        table.set_header(["", "plain", "graph"]);
        let values = column(&graph.mean, Some(&graph.intervals)).into_iter().map(|(_, value)| value);
        let values = values.chain([votes(graph.knn_accuracy)]);
        rows.iter_mut().zip(values).for_each(|(row, value)| row.push(value));
    }
    rows.push(vec!["silhouette".to_owned(), format!("{:.4}", scores.silhouette)]);
    rows.push(vec!["shapes, classes".to_owned(), format!("{}, {}", scores.n, scores.classes.len())]);
    rows.into_iter().for_each(|row| {
        table.add_row(row);
    });
    let mut text = table.to_string();
    if let Some(intervals) = &scores.intervals {
        let percent = 100.0 * intervals.level;
        text += &format!(
            "\n  in parentheses: {percent:.0} % intervals of the mean over queries, from {} resamples",
            intervals.resamples
        );
    }
    text += &format!("\n{}", confusion("true \\ predicted", &scores.classes, &scores.confusion));
    if let Some(graph) = &scores.graph {
        text += &format!("\n{}", confusion("true \\ predicted (graph)", &scores.classes, &graph.confusion));
    }
    text
}
