//! Tables for the terminal.

use ::retrieval::Evaluation;
use comfy_table::{CellAlignment, Table, presets};

use crate::figure1::stress_digits;
use crate::results::{
    CurvesRecord, Figure3Record, Figure4Record, Figure9Record, RetrievalRecord, RetrievalRow,
};
use view::numbers::signed;

/// Headings of [`values`]; also those of the page's table.
pub(crate) const HEADINGS: [&str; 8] = ["NN", "FT", "ST", "E", "DCG", "mAP", "k-NN", "silhouette"];

/// The scores of one matrix, in the order of [`HEADINGS`].
pub(crate) fn values(s: &Evaluation) -> [f64; 8] {
    [s.mean.nn, s.mean.ft, s.mean.st, s.mean.e, s.mean.dcg, s.mean.map, s.knn_accuracy, s.silhouette]
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

/// The stresses of Figure 3, one row for each shape, way of measuring and method; no trailing newline.
#[must_use]
pub fn figure3_table(record: &Figure3Record) -> String {
    let rows = record.stresses.iter().map(|s| {
        let mut numbers = [s.median, s.low, s.high].map(stress_digits).to_vec();
        numbers.push(s.paper.map_or_else(|| "-".to_string(), |v| v.to_string()));
        ([&s.shape, &s.distances, &s.method].map(Clone::clone).to_vec(), numbers)
    });
    table(&["shape", "distances", "method"], &["stress", "least", "greatest", "paper"], rows)
}

/// The medians of a figure of curves: one row for each panel and place across, one column for each
/// curve; no trailing newline.
#[must_use]
pub fn curves_table(record: &CurvesRecord) -> String {
    let mut names: Vec<&str> = Vec::new();
    for series in record.panels.iter().flat_map(|panel| &panel.series) {
        if !names.contains(&series.name.as_str()) {
            names.push(&series.name);
        }
    }
    let rows = record.panels.iter().flat_map(|panel| {
        let mut places: Vec<f64> = panel.series.iter().flat_map(|s| s.points.iter().map(|p| p.x)).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let names = &names;
        places.into_iter().map(move |x| {
            let median = |name: &&str| {
                let series = panel.series.iter().find(|s| s.name == **name);
                let point = series.and_then(|s| s.points.iter().find(|p| p.x == x));
                point.map_or_else(|| "-".to_string(), |p| significant(p.median))
            };
            (vec![panel.title.clone(), significant(x)], names.iter().map(median).collect())
        })
    });
    let across = record.panels.first().map_or("", |panel| panel.x.name.as_str());
    table(&["", across], &names, rows)
}

/// The times of Figure 9; no trailing newline.
#[must_use]
pub fn figure9_table(record: &Figure9Record) -> String {
    let rows = record.rows.iter().map(|row| {
        let number = |value: Option<String>| value.unwrap_or_else(|| "-".to_string());
        let m = row.measured;
        let numbers = vec![
            number(m.map(|m| seconds_digits(m.geodesics))),
            number(m.map(|m| seconds_digits(m.embedding))),
            number(m.map(|m| seconds_digits(m.total()))),
            number(m.map(|m| bytes_digits(m.peak_bytes))),
            number(row.paper_seconds.map(|s| s.to_string())),
        ];
        (vec![row.n_vertices.to_string(), row.method.clone()], numbers)
    });
    table(&["vertices", "method"], &["distances", "algebra", "total", "memory", "paper"], rows)
}

/// Headings of the table of retrieval: method, size, then [`retrieval_values`].
pub(crate) const RETRIEVAL_HEADINGS: [&str; 12] =
    ["method", "size", "NN", "FT", "ST", "E", "DCG", "mAP", "macro NN", "macro mAP", "k-NN", "least mAP"];

/// The scores of one way to compare, in the order of [`RETRIEVAL_HEADINGS`].
pub(crate) fn retrieval_values(row: &RetrievalRow) -> [f64; 10] {
    let (s, m) = (&row.micro, &row.macro_average);
    [s.nn, s.ft, s.st, s.e, s.dcg, s.map, m.nn, m.map, row.knn_accuracy, row.held_out_map]
}

/// The scores of every way to compare; no trailing newline.
#[must_use]
pub fn retrieval_table(record: &RetrievalRecord) -> String {
    let rows = record.rows.iter().map(|row| {
        let numbers = retrieval_values(row).map(digits).to_vec();
        (vec![row.method.clone(), row.scale.name().to_string()], numbers)
    });
    table(&RETRIEVAL_HEADINGS[..2], &RETRIEVAL_HEADINGS[2..], rows)
}

/// A number with three digits, as short as it can be.
pub(crate) fn significant(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_string(),
        v if !(1e-3..1e4).contains(&v) => format!("{value:.1e}"),
        v if v >= 100.0 || value.fract() == 0.0 => format!("{value:.0}"),
        v if v >= 10.0 => format!("{value:.1}"),
        v if v >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.4}"),
    }
}

/// Seconds with at least two digits.
#[must_use]
pub fn seconds_digits(seconds: f64) -> String {
    match seconds {
        s if s >= 10.0 => format!("{s:.1}"),
        s if s >= 1.0 => format!("{s:.2}"),
        s if s >= 0.01 => format!("{s:.3}"),
        s => format!("{s:.4}"),
    }
}

/// An amount of memory in a unit that suits it.
#[must_use]
pub fn bytes_digits(bytes: usize) -> String {
    let mib = bytes as f64 / f64::from(1 << 20);
    match mib {
        m if m >= 1024.0 => format!("{:.2} GiB", m / 1024.0),
        m if m >= 100.0 => format!("{m:.0} MiB"),
        m => format!("{m:.1} MiB"),
    }
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
    use crate::fixtures::{curves_record, evaluation, figure3_record, figure4_record, figure9_record};

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

    #[test]
    fn curves_stand_side_by_side_and_gaps_are_dashes() {
        let mut record = curves_record();
        record.panels[1].series[1].points.remove(0);
        let text = curves_table(&record);
        assert_eq!(text.lines().count(), 1 + 6, "{text}");
        assert!(text.contains("samples n") && text.contains("1.0e4"), "{text}");
        assert!(text.lines().nth(4).is_some_and(|line| line.ends_with('-')), "{text}");
    }

    #[test]
    fn what_was_not_run_has_dashes_for_numbers() {
        let text = figure9_table(&figure9_record());
        assert!(text.contains("0.025") && text.contains("3.0 MiB") && text.contains("0.24"), "{text}");
        assert!(text.lines().nth(2).is_some_and(|line| line.matches(" - ").count() >= 4), "{text}");
        let text = figure3_table(&figure3_record());
        assert!(text.contains("386.2") && text.contains("394.41"), "{text}");
    }

    #[test]
    fn numbers_have_the_digits_that_suit_their_size() {
        let written: Vec<_> = [0.0, 12345.0, 123.4, 12.34, 1.234, 0.1234, 1.2e-5].map(significant).to_vec();
        assert_eq!(written, ["0", "1.2e4", "123", "12.3", "1.23", "0.1234", "1.2e-5"]);
        assert_eq!([123.0, 1.5, 0.5, 0.0012].map(seconds_digits), ["123.0", "1.50", "0.500", "0.0012"]);
        assert_eq!([1 << 19, 200 << 20, 3 << 30].map(bytes_digits), ["0.5 MiB", "200 MiB", "3.00 GiB"]);
    }
}
