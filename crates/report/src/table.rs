//! Tables as data, and their text for terminals.

use comfy_table::{CellAlignment, presets};
use serde::{Deserialize, Serialize};

use crate::numbers::significant;

/// Rows of cells under headings.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Table {
    /// What the table shows, in a sentence or two.
    pub caption: String,
    /// One heading per column.
    pub headings: Vec<String>,
    /// The rows, with one cell per column.
    pub rows: Vec<Vec<Cell>>,
}

/// One cell of a table: a JSON number, text or null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// A number, aligned to the right.
    Number(f64),
    /// A name or remark, aligned to the left.
    Text(String),
    /// Nothing.
    Missing,
}

impl From<f64> for Cell {
    /// A number, or nothing if it is not finite.
    fn from(value: f64) -> Self {
        if value.is_finite() { Self::Number(value) } else { Self::Missing }
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Number(count as f64)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Missing, Into::into)
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
        Self { caption: caption.into(), headings, rows }
    }

    /// The numbers of a column.
    fn numbers(&self, column: usize) -> impl Iterator<Item = f64> {
        self.rows.iter().filter_map(move |row| match row.get(column) {
            Some(Cell::Number(value)) => Some(*value),
            _ => None,
        })
    }

    /// Whether a column holds numbers.
    pub fn is_numeric(&self, column: usize) -> bool {
        self.numbers(column).next().is_some()
    }

    /// The texts of all cells. Columns of shares and scores have three decimals, other numbers four significant digits.
    pub fn texts(&self) -> Vec<Vec<String>> {
        let is_share = |column: usize| {
            let numbers = || self.numbers(column);
            numbers().all(|v| v.abs() <= 1.0) && numbers().any(|v| v.abs() >= 0.1)
        };
        let shares: Vec<bool> = (0..self.headings.len()).map(is_share).collect();
        let text = |(column, cell): (usize, &Cell)| match cell {
            Cell::Number(value) if shares.get(column) == Some(&true) => format!("{value:.3}"),
            Cell::Number(value) => significant(*value, 4),
            Cell::Text(text) => text.clone(),
            Cell::Missing => "-".to_owned(),
        };
        self.rows.iter().map(|row| row.iter().enumerate().map(text).collect()).collect()
    }

    /// The table as text in aligned columns, without its caption and without a trailing newline.
    pub fn to_text(&self) -> String {
        let mut table = comfy_table::Table::new();
        table.load_style(presets::NOTHING).set_header(&self.headings).add_rows(self.texts());
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
