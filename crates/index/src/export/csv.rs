//! Comma-separated values: what fits into a spreadsheet.

use std::io::{self, Write};

use super::columns::{Columns, TEXTS, texts};
use super::error::ExportError;
use crate::{Index, Shape};

pub(super) fn write(index: &Index, out: &mut dyn Write) -> Result<(), ExportError> {
    let columns = Columns::of(index)?;
    let mut head: Vec<String> = TEXTS.map(str::to_owned).to_vec();
    head.extend(columns.facts.iter().map(|name| quoted(&format!("fact_{name}"))));
    head.extend((0..columns.fused).map(|i| format!("fused_{i}")));
    writeln!(out, "{}", head.join(","))?;
    index.each(|shape| row(out, &columns, &shape).map_err(ExportError::from))
}

fn row(out: &mut dyn Write, columns: &Columns, shape: &Shape) -> io::Result<()> {
    write!(out, "{}", texts(shape).map(|text| quoted(&text)).join(","))?;
    for name in &columns.facts {
        match shape.entry.fact(name) {
            Some(value) => write!(out, ",{value}")?,
            None => write!(out, ",")?,
        }
    }
    for i in 0..columns.fused {
        match shape.vectors.fused.get(i) {
            Some(value) => write!(out, ",{value}")?,
            None => write!(out, ",")?,
        }
    }
    writeln!(out)
}

/// A text in quotes, if it needs them.
fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}
