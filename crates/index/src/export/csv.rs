//! Comma-separated values: what fits into a spreadsheet.

use std::io::{self, Write};

use super::columns::{Column, columns, text_of};
use super::error::ExportError;
use crate::{Index, Shape};

pub(super) fn write(index: &Index, out: &mut dyn Write) -> Result<(), ExportError> {
    let columns = columns(index)?;
    let mut head: Vec<String> = Vec::new();
    for column in &columns {
        match column {
            Column::Text(name, _) => head.push((*name).to_owned()),
            Column::Fact(name) => head.push(csv_field(&format!("fact_{name}"))),
            Column::Floats(name, extents) if name == "fused" => {
                head.extend((0..extents[0]).map(|i| format!("fused_{i}")));
            }
            Column::Floats(..) => {}
        }
    }
    writeln!(out, "{}", head.join(","))?;
    index.each(|shape| row(out, &columns, &shape).map_err(ExportError::from))
}

fn row(out: &mut dyn Write, columns: &[Column], shape: &Shape) -> io::Result<()> {
    let mut cells: Vec<String> = Vec::new();
    for column in columns {
        match column {
            Column::Text(name, _) => cells.push(csv_field(&text_of(shape, name))),
            Column::Fact(name) => {
                cells.push(shape.entry.fact(name).map_or_else(String::new, |x| x.to_string()))
            }
            Column::Floats(name, _) if name == "fused" => {
                cells.extend(shape.vectors.fused.iter().map(f32::to_string));
            }
            Column::Floats(..) => {}
        }
    }
    writeln!(out, "{}", cells.join(","))
}

/// A field of comma-separated values (RFC 4180), in quotes where it must be.
#[must_use]
pub fn csv_field(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_fields_that_need_quotes_have_them() {
        for (field, expected) in
            [("cat 1", "cat 1"), ("a,b", "\"a,b\""), ("\"", "\"\"\"\""), ("a\nb", "\"a\nb\"")]
        {
            assert_eq!(csv_field(field), expected);
        }
    }
}
