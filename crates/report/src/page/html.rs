//! HTML elements. All text passes through [`escape`].

use std::fmt::Write;

use crate::results::ExpectationOutcome;
use crate::table::{Cell, Table};

/// Text with the special characters of HTML escaped, for elements and attributes.
pub fn escape(text: &str) -> String {
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

/// A template with every `{{name}}` replaced by its value, without escaping.
pub(super) fn fill(template: &str, values: &[(&str, &str)]) -> String {
    let mut parts = template.split("{{");
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for (name, rest) in parts.filter_map(|part| part.split_once("}}")) {
        filled.extend(values.iter().filter(|(key, _)| *key == name).map(|(_, value)| *value));
        filled.push_str(rest);
    }
    filled
}

/// A paragraph for each stretch of text between empty lines.
pub(super) fn paragraphs(text: &str) -> String {
    text.split("\n\n")
        .map(str::trim)
        .filter(|p| !p.is_empty())
        .map(|p| format!("<p>{}</p>\n", escape(p)))
        .collect()
}

/// The class and the sign of an outcome.
pub(super) fn marked(outcome: ExpectationOutcome) -> (&'static str, &'static str) {
    match outcome {
        ExpectationOutcome::Held => ("held", "✓"),
        ExpectationOutcome::Missed => ("goal", "○"),
        ExpectationOutcome::Failed => ("failed", "✗"),
    }
}

/// A table with its caption above it, folded if it says so.
pub(super) fn table(table: &Table) -> String {
    let mut html = format!("<p class=\"pale\">{}</p>\n", escape(&table.caption));
    if table.rows.is_empty() {
        return html;
    }
    html.push_str("<div class=\"wide\" tabindex=\"0\"><table>\n<thead><tr>");
    for (i, heading) in table.headings.iter().enumerate() {
        let class = if table.is_numeric(i) { " class=\"number\"" } else { "" };
        let _ = write!(html, "<th scope=\"col\"{class}>{}</th>", escape(heading));
    }
    html.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        html.push_str("<tr>");
        for cell in row {
            html.push_str(&match cell {
                Cell::Text(text) => format!("<td>{}</td>", escape(text)),
                Cell::Number(text) => format!("<td class=\"number\">{}</td>", escape(text)),
                Cell::Missing => "<td class=\"number\">–</td>".to_string(),
                Cell::Verdict(outcome) => {
                    let (class, sign) = marked(*outcome);
                    format!("<td class=\"{class}\">{sign} {}</td>", outcome.name())
                }
            });
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody></table></div>\n");
    match &table.folded {
        Some(line) => folded(line, &html),
        None => html,
    }
}

/// Content that opens on a click.
pub(super) fn folded(summary: &str, content: &str) -> String {
    format!("<details>\n<summary>{}</summary>\n{content}</details>\n", escape(summary))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_not_templates() {
        assert_eq!(fill("a {{x}} b {{y}}{{x}}", &[("x", "{{y}}"), ("y", "2")]), "a {{y}} b 2{{y}}");
    }

    #[test]
    fn text_never_becomes_markup() {
        assert_eq!(escape("<a href=\"x\" id='y'>&"), "&lt;a href=&quot;x&quot; id=&#39;y&#39;&gt;&amp;");
        assert_eq!(
            paragraphs("one\n\n\n\n<two>\nstill two\n"),
            "<p>one</p>\n<p>&lt;two&gt;\nstill two</p>\n"
        );
        let cells = vec![vec![Cell::text("<t>")], vec![Cell::number("<n>")]];
        let html = table(&Table::new("<c>", ["<h>"], cells).folded("<f>"));
        assert!(["<c>", "<h>", "<t>", "<n>", "<f>"].iter().all(|raw| !html.contains(raw)), "{html}");
    }
}
