//! The few pieces of HTML the page is made of. Every text passes through [`escape`].

use std::fmt::Write;

/// Text with the characters that mean something in HTML replaced; safe in attributes too.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
    }
    escaped
}

/// A paragraph for each stretch of text between empty lines.
pub(super) fn paragraphs(text: &str) -> String {
    text.split("\n\n")
        .map(str::trim)
        .filter(|p| !p.is_empty())
        .map(|p| format!("<p>{}</p>\n", escape(p)))
        .collect()
}

/// One cell of a [`table`].
pub(super) enum Cell {
    /// Read from the left.
    Text(String),
    /// Compared by the right edge.
    Number(String),
    /// The outcome of an expectation.
    Verdict(bool),
}

/// A table with a line of explanation above it and a heading row; the columns are aligned like the cells of the first row.
pub(super) fn table(caption: &str, headings: &[&str], rows: &[Vec<Cell>]) -> String {
    let mut html =
        format!("<p class=\"pale\">{}</p>\n<div class=\"wide\"><table>\n<thead><tr>", escape(caption));
    for (i, heading) in headings.iter().enumerate() {
        let number = rows.first().and_then(|row| row.get(i)).is_some_and(|c| matches!(c, Cell::Number(_)));
        let class = if number { " class=\"number\"" } else { "" };
        let _ = write!(html, "<th scope=\"col\"{class}>{}</th>", escape(heading));
    }
    html.push_str("</tr></thead>\n<tbody>\n");
    for row in rows {
        html.push_str("<tr>");
        for cell in row {
            html.push_str(&match cell {
                Cell::Text(text) => format!("<td>{}</td>", escape(text)),
                Cell::Number(text) => format!("<td class=\"number\">{}</td>", escape(text)),
                Cell::Verdict(true) => "<td class=\"held\">✓ held</td>".to_string(),
                Cell::Verdict(false) => "<td class=\"failed\">✗ failed</td>".to_string(),
            });
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody></table></div>\n");
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_a_text_holds_becomes_markup() {
        assert_eq!(escape("<a href=\"x\" id='y'>&"), "&lt;a href=&quot;x&quot; id=&#39;y&#39;&gt;&amp;");
        assert_eq!(
            paragraphs("one\n\n\n\n<two>\nstill two\n"),
            "<p>one</p>\n<p>&lt;two&gt;\nstill two</p>\n"
        );
        let html =
            table("<c>", &["<h>"], &[vec![Cell::Text("<t>".into())], vec![Cell::Number("<n>".into())]]);
        assert!(["<c>", "<h>", "<t>", "<n>"].iter().all(|raw| !html.contains(raw)), "{html}");
    }
}
