//! Tables as data, and their text for terminals.

use crate::numbers::signed;
use comfy_table::{CellAlignment, presets};

use crate::results::ExpectationOutcome;

/// Rows of cells under headings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// What the table shows. Texts for terminals leave it out.
    pub caption: String,
    /// The line under which the page folds the table, if it does.
    pub folded: Option<String>,
    /// One heading per column.
    pub headings: Vec<String>,
    /// The rows, with one cell per column.
    pub rows: Vec<Vec<Cell>>,
}

/// One cell of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Cell {
    /// A name or remark, aligned to the left.
    Text(String),
    /// A number, aligned to the right.
    Number(String),
    /// A number that does not exist.
    Missing,
    /// What came of an expectation.
    Verdict(ExpectationOutcome),
}

impl Cell {
    /// A name or remark.
    pub fn text(text: impl ToString) -> Self {
        Self::Text(text.to_string())
    }

    /// A formatted number.
    pub fn number(text: impl ToString) -> Self {
        Self::Number(text.to_string())
    }

    /// A number that may not exist.
    pub fn optional(text: Option<impl ToString>) -> Self {
        text.map_or(Self::Missing, Self::number)
    }

    /// A score, with three decimals.
    #[must_use]
    pub fn score(value: f64) -> Self {
        Self::Number(signed(value, 3))
    }
}

impl Table {
    /// A table with a caption.
    pub fn new<'a>(
        caption: impl Into<String>,
        headings: impl IntoIterator<Item = &'a str>,
        rows: Vec<Vec<Cell>>,
    ) -> Self {
        let headings = headings.into_iter().map(str::to_owned).collect();
        Self { caption: caption.into(), folded: None, headings, rows }
    }

    /// The table, folded on the page under a line.
    #[must_use]
    pub fn folded(self, line: impl Into<String>) -> Self {
        Self { folded: Some(line.into()), ..self }
    }

    /// Whether a column holds numbers.
    #[must_use]
    pub fn is_numeric(&self, column: usize) -> bool {
        self.rows.iter().any(|row| matches!(row.get(column), Some(Cell::Number(_))))
    }

    /// The table as text in aligned columns, with ASCII minus signs and without a trailing newline.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut table = comfy_table::Table::new();
        table.load_style(presets::NOTHING).set_header(&self.headings);
        for row in &self.rows {
            table.add_row(row.iter().map(|cell| match cell {
                Cell::Text(text) => text.clone(),
                Cell::Number(text) => text.replace('\u{2212}', "-"),
                Cell::Missing => "-".to_owned(),
                Cell::Verdict(outcome) => outcome.name().to_owned(),
            }));
        }
        for (i, column) in table.column_iter_mut().enumerate() {
            if self.is_numeric(i) {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        if let Some(first) = table.column_mut(0) {
            first.set_padding((0, 1));
        }
        table.trim_fmt()
    }
}

/// The headings of [`scores`] in tables, as in the paper.
pub(crate) const SCORES: [&str; 6] = ["NN", "FT", "ST", "E", "DCG", "mAP"];

/// The meaning of [`SCORES`], as the beginning of a caption. `best_e` is the E-measure of a ranking without error.
pub(crate) fn scores_caption(best_e: Option<f64>) -> String {
    let best = match best_e {
        Some(best) if best < 0.9995 => format!(
            "The best value is 1, but {} for E: the classes are smaller than the 32 results that E examines.",
            signed(best, 3)
        ),
        _ => "The best value is 1; E, which examines 32 results, cannot reach it if classes are smaller."
            .to_owned(),
    };
    format!(
        "NN: nearest neighbour; FT and ST: first and second tier; E: E-measure; DCG: discounted cumulative gain; mAP: \
         mean average precision. {best}"
    )
}

/// A number with three significant digits, as short as possible.
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

/// A stress with about four significant digits.
pub(crate) fn stress(stress: f64) -> String {
    match stress.abs() {
        s if s >= 1000.0 => format!("{stress:.0}"),
        s if s >= 10.0 => format!("{stress:.1}"),
        s if s >= 0.1 || s == 0.0 => format!("{stress:.3}"),
        _ => format!("{stress:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_aligns_names_left_and_numbers_right() {
        let row = |name: &str, value| vec![Cell::text(name), value, Cell::text("remark")];
        let rows = vec![row("a", Cell::Missing), row("longer", Cell::score(-0.125))];
        let text = Table::new("caption", ["name", "value", "note"], rows).to_text();
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        assert_eq!(lines, ["name     value  note", "a            -  remark", "longer  -0.125  remark"]);
    }

    #[test]
    fn digits_suit_the_size_of_the_number() {
        let written: Vec<_> = [0.0, 12345.0, 123.4, 12.34, 1.234, 0.1234, 1.2e-5].map(significant).to_vec();
        assert_eq!(written, ["0", "1.2e4", "123", "12.3", "1.23", "0.1234", "1.2e-5"]);
        let written: Vec<_> = [395.94, 12345.6, 0.5, 0.0, 1.234e-5].map(stress).to_vec();
        assert_eq!(written, ["395.9", "12346", "0.500", "0.000", "1.23e-5"]);
    }
}
