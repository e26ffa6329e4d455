//! HTML elements. All text passes through [`escape`].

use crate::markup::escape;
use crate::record::Expectation;
use crate::table::Table;

/// A paragraph for each stretch of text between empty lines.
pub(super) fn paragraphs(text: &str) -> String {
    let paragraphs = text.split("\n\n").map(str::trim).filter(|p| !p.is_empty());
    paragraphs.map(|p| format!("<p>{}</p>\n", escape(p))).collect()
}

/// The class of what came of an expectation, and the text for it.
pub(super) fn outcome(e: &Expectation) -> (&'static str, &'static str) {
    match (e.held, e.goal) {
        (true, _) => ("held", "✓ held"),
        (false, true) => ("goal", "○ goal missed"),
        (false, false) => ("failed", "✗ failed"),
    }
}

/// A table with its caption above it.
pub(super) fn table(table: &Table) -> String {
    let class = |column: usize| if table.is_numeric(column) { " class=\"number\"" } else { "" };
    let row = |row: &[String], open: &str, close: &str| -> String {
        let cell = |(i, text): (usize, &String)| format!("<{open}{}>{}</{close}>", class(i), escape(text));
        let cells: String = row.iter().enumerate().map(cell).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let mut html = format!("<p class=\"pale\">{}</p>\n", escape(&table.caption));
    if !table.rows.is_empty() {
        let head = row(&table.headings, "th scope=\"col\"", "th");
        let body: String = table.texts().iter().map(|cells| row(cells, "td", "td")).collect();
        html += &wide(&head, &body);
    }
    html
}

/// A table that may be wider than the page.
pub(super) fn wide(head: &str, body: &str) -> String {
    format!(
        "<div class=\"wide\" tabindex=\"0\"><table>\n<thead>{head}</thead>\n<tbody>\n{body}</tbody></table></div>\n"
    )
}

/// Content that opens on a click.
pub(super) fn folded(summary: &str, content: &str) -> String {
    format!("<details>\n<summary>{}</summary>\n{content}</details>\n", escape(summary))
}
