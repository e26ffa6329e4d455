//! The record of an experiment whose results are tables.

use serde::{Deserialize, Serialize};

/// Tables, in reading order.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TablesResults {
    /// The tables.
    pub tables: Vec<RecordedTable>,
}

/// Rows of entries under headings.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RecordedTable {
    /// What the table shows, in a sentence or two.
    pub caption: String,
    /// The line under which the page folds the table; `None` if it is always open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub folded: Option<String>,
    /// One heading per column.
    pub headings: Vec<String>,
    /// The rows, with one entry per column.
    pub rows: Vec<Vec<TableEntry>>,
}

/// One entry of a table: a JSON number, text or null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum TableEntry {
    /// A number, shown with three significant digits; a whole number is shown in full.
    Number(f64),
    /// A name or remark.
    Text(String),
    /// Nothing.
    Missing,
}

impl From<f64> for TableEntry {
    /// A number, or nothing if it is not finite.
    fn from(value: f64) -> Self {
        if value.is_finite() { Self::Number(value) } else { Self::Missing }
    }
}

impl From<&str> for TableEntry {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}
