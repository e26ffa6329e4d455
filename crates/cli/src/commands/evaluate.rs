//! `canonform evaluate`.

use std::process::ExitCode;

use anyhow::Result;
use canonform::retrieval::Evaluation;
use canonform::{LabelFile, evaluate_index, evaluate_matrix};
use mesh::io::extension;
use terminal::Bars;

use crate::args::{Common, EvaluateArgs};
use crate::input::named;
use crate::output::{facts, report};

/// Scores an index or a matrix.
pub(crate) fn evaluate(args: &EvaluateArgs, common: &Common) -> Result<ExitCode> {
    let labels = args.labels.as_deref().map(LabelFile::read).transpose()?;
    let scores = if extension(&args.input) == "csv" {
        evaluate_matrix(&args.input, labels.as_ref(), args.k)
    } else {
        evaluate_index(&args.input, args.by, labels.as_ref(), args.k, &Bars::new(common.quiet))
    };
    let scores = scores.map_err(|fault| named(&args.input, fault))?;
    report(common, &scores, table)
}

fn table(scores: &Evaluation) -> String {
    let rows = [
        ("nearest neighbour", scores.mean.nn),
        ("first tier", scores.mean.ft),
        ("second tier", scores.mean.st),
        ("E-measure", scores.mean.e),
        ("DCG", scores.mean.dcg),
        ("mAP", scores.mean.map),
        ("silhouette", scores.silhouette),
    ];
    let mut rows: Vec<_> = rows.into_iter().map(|(name, score)| (name, format!("{score:.4}"))).collect();
    let votes = format!("{:.4} (k = {})", scores.knn_accuracy, scores.knn_k);
    rows.push(("k-NN accuracy", votes));
    rows.push(("shapes, classes", format!("{}, {}", scores.n, scores.classes.len())));
    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    table.set_header(["true \\ predicted"].into_iter().chain(scores.classes.iter().map(String::as_str)));
    for (class, row) in scores.classes.iter().zip(&scores.confusion) {
        table.add_row([class.clone()].into_iter().chain(row.iter().map(usize::to_string)));
    }
    format!("{}\n{table}", facts(&rows))
}
