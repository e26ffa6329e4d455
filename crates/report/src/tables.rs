//! Tables for the terminal.

use comfy_table::{CellAlignment, Table, presets};
use retrieval::Evaluation;

use crate::numbers::signed;
use crate::results::Figure4Record;

/// Headings of [`values`]; also those of the page's table.
pub(crate) const HEADINGS: [&str; 8] = ["NN", "FT", "ST", "E", "DCG", "mAP", "k-NN", "silhouette"];

/// The scores of one matrix, in the order of [`HEADINGS`].
pub(crate) fn values(s: &Evaluation) -> [f64; 8] {
    [s.nn, s.ft, s.st, s.e, s.dcg, s.map, s.knn_accuracy, s.silhouette]
}

/// A score for the terminal, with a minus sign that other programs read.
fn digits(value: f64) -> String {
    signed(value, 3).replace('\u{2212}', "-")
}

/// A text table of retrieval scores, one named row each, for people; no trailing newline.
#[must_use]
pub fn score_table<'a>(rows: impl IntoIterator<Item = (&'a str, &'a Evaluation)>) -> String {
    let rows =
        rows.into_iter().map(|(name, scores)| (vec![name.to_string()], values(scores).map(digits).to_vec()));
    table(&["scores of"], &HEADINGS, rows)
}

/// The scores of Figure 4, one row for each method and scale, with those of the map; no trailing newline.
#[must_use]
pub fn figure4_table(record: &Figure4Record) -> String {
    let headings = [HEADINGS.as_slice(), &["map silh.", "map stress"]].concat();
    let rows = record.panels.iter().map(|panel| {
        let mut numbers = values(&panel.scores).map(digits).to_vec();
        numbers.extend([panel.map_silhouette, panel.map_stress].map(digits));
        (vec![panel.method.clone(), panel.scale.name().to_string()], numbers)
    });
    table(&["method", "scale"], &headings, rows)
}

/// Names to the left, numbers to the right.
fn table(names: &[&str], numbers: &[&str], rows: impl Iterator<Item = (Vec<String>, Vec<String>)>) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header([names, numbers].concat());
    for (name, values) in rows {
        table.add_row([name, values].concat());
    }
    for column in table.column_iter_mut().skip(names.len()) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    if let Some(first) = table.column_mut(0) {
        first.set_padding((0, 1));
    }
    table.trim_fmt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{evaluation, figure4_record};

    #[test]
    fn every_score_stands_under_its_heading() {
        let scores = evaluation();
        let text = score_table([("NMDS", &scores), ("a longer name", &scores)]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3, "{text}");
        for (heading, value) in HEADINGS.iter().zip(values(&scores).map(digits)) {
            let end = lines[0].find(heading).map(|at| at + heading.len()).unwrap();
            assert!(lines[1][..end].ends_with(&value), "{heading} {value}\n{text}");
        }
    }

    #[test]
    fn figure_4_has_a_row_for_each_method_and_scale() {
        let record = figure4_record(&[("cat", 3), ("dog", 2)]);
        let text = figure4_table(&record);
        assert_eq!(text.lines().count(), 1 + record.panels.len());
        assert!(text.contains("normalized") && text.contains("map stress"), "{text}");
    }
}
