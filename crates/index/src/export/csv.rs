//! Comma-separated values: what fits into a spreadsheet.

use std::borrow::Cow;
use std::io::{self, Write};

use super::columns::{Value, values};
use crate::Index;

pub(super) fn write(index: &Index, out: &mut dyn Write) -> io::Result<()> {
    let mut is_begun = false;
    index.each(|shape| {
        let (names, cells): (Vec<_>, Vec<_>) = values(&shape).into_iter().flat_map(cells).unzip();
        if !std::mem::replace(&mut is_begun, true) {
            writeln!(out, "{}", names.join(","))?;
        }
        writeln!(out, "{}", cells.join(","))
    })?;
    if is_begun { Ok(()) } else { writeln!(out) }
}

/// The cells of a value, with the names of their columns.
fn cells((name, value): (Cow<'static, str>, Value<'_>)) -> Vec<(String, String)> {
    match value {
        Value::Text(text) => vec![(csv_field(&name), csv_field(&text))],
        Value::Fact(fact) => vec![(csv_field(&name), fact.to_string())],
        Value::Floats(numbers, _) if name == "fused" => {
            numbers.iter().enumerate().map(|(i, x)| (format!("fused_{i}"), x.to_string())).collect()
        }
        Value::Floats(..) => Vec::new(),
    }
}

/// A field of comma-separated values (RFC 4180), in quotes where it must be.
pub fn csv_field(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

/// A field of text in a table for people: what a spreadsheet would take for a formula begins with an apostrophe. An export that
/// programs read says names as they are.
pub fn text_cell(text: &str) -> String {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠']);
    let field = csv_field(&format!("{}{text}", if is_formula { "'" } else { "" }));
    // Some spreadsheets separate fields by semicolons or tabs.
    if field.contains([';', '\t']) && !field.starts_with('"') { format!("\"{field}\"") } else { field }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_fields_that_need_quotes_have_them() {
        for (field, expected) in
            [("cat 1", "cat 1"), ("a,b", "\"a,b\""), ("\"", "\"\"\"\""), ("a\nb", "\"a\nb\"")]
        {
            assert_eq!((csv_field(field), text_cell(field)), (expected.to_owned(), expected.to_owned()));
        }
        for (text, expected) in [
            ("=cmd|' /C calc'!A0", "'=cmd|' /C calc'!A0"),
            ("-1+1", "'-1+1"),
            ("@SUM(1,2)", "\"'@SUM(1,2)\""),
            ("\t=1", "\"'\t=1\""),
            ("a;=1", "\"a;=1\""),
            ("＝1", "'＝1"),
        ] {
            assert_eq!(text_cell(text), expected);
            assert!(!csv_field(text).starts_with(['\'']), "an export says names as they are");
        }
    }
}
