//! Experiments whose results are tables.

use crate::error::ReportError;
use crate::figure::Figure;
use crate::record::Results;
use crate::results::{RecordedTable, TableEntry, TablesResults};
use crate::table::{Cell, Table, significant};

fn cell(entry: &TableEntry) -> Cell {
    match entry {
        TableEntry::Number(value) if value.fract() == 0.0 && value.abs() < 1e15 => Cell::number(value),
        TableEntry::Number(value) => Cell::number(significant(*value)),
        TableEntry::Text(text) => Cell::text(text),
        TableEntry::Missing => Cell::Missing,
    }
}

/// The table of a record.
pub(crate) fn shown(table: &RecordedTable) -> Table {
    let rows = table.rows.iter().map(|row| row.iter().map(cell).collect()).collect();
    let headings = table.headings.iter().map(String::as_str);
    Table { folded: table.folded.clone(), ..Table::new(&table.caption, headings, rows) }
}

impl Results for TablesResults {
    fn validate(&self) -> Result<(), ReportError> {
        if self.tables.iter().all(|table| table.rows.is_empty()) {
            return Err(ReportError::Empty { figure: "an experiment of tables", unit: "row" });
        }
        for RecordedTable { caption, headings, rows, .. } in &self.tables {
            for (i, row) in rows.iter().enumerate() {
                let what = format!("row {} of the table `{caption}`", i + 1);
                ReportError::check_length(what, row.len(), headings.len(), "column")?;
            }
        }
        Ok(())
    }

    fn figures(&self) -> Vec<Figure> {
        vec![]
    }

    fn tables(&self) -> Vec<Table> {
        self.tables.iter().map(shown).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> TablesResults {
        let rows = vec![
            vec!["moved".into(), 0.0123.into(), 12000.0.into()],
            vec!["mirrored".into(), f64::NAN.into(), 0.0.into()],
        ];
        let headings = ["change", "error", "shapes"].map(str::to_owned).into();
        TablesResults {
            tables: vec![RecordedTable { caption: "Errors.".into(), folded: None, headings, rows }],
        }
    }

    #[test]
    fn entries_are_text_numbers_or_missing_and_read_back() {
        let record = record();
        record.validate().unwrap();
        let text = record.summary().unwrap().to_text();
        assert!(text.contains("0.0123") && text.contains("12000"), "{text}");
        assert!(text.lines().nth(2).is_some_and(|line| line.contains('-')), "{text}");
        let json = serde_json::to_string(&record).unwrap();
        assert!(json.contains(r#"["mirrored",null,0.0]"#), "{json}");
        assert_eq!(serde_json::from_str::<TablesResults>(&json).unwrap(), record);
    }

    #[test]
    fn tables_without_rows_and_short_rows_are_errors() {
        assert!(TablesResults::default().validate().unwrap_err().to_string().contains("nothing to draw"));
        let mut short = record();
        short.tables[0].rows[1].pop();
        let fault = short.validate().unwrap_err().to_string();
        assert!(fault.starts_with("row 2 of the table `Errors.` has 2 entries instead of 3"), "{fault}");
    }
}
