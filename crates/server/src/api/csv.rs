//! Results as CSV (RFC 4180).

use canonform::{RankBy, SearchReport};

/// One line per result, under a header.
pub(super) fn of(query: &str, report: &SearchReport) -> String {
    let mut text = "query,rank,id,label,path,distance,signature_distance".to_owned();
    text += if report.rank_by == RankBy::Graph { ",rank_distance\r\n" } else { "\r\n" };
    for found in &report.results {
        let (rank, distance, fused) =
            (found.rank.to_string(), found.distance.to_string(), found.fused.to_string());
        let fields = [query, &rank, &found.id, &found.label, &found.path, &distance, &fused];
        let order = found.on_graph.map(|found| found.rank_distance.to_string());
        let fields: Vec<String> = fields.into_iter().chain(order.as_deref()).map(quoted).collect();
        text += &(fields.join(",") + "\r\n");
    }
    text
}

/// A field, in quotes where it must be.
fn quoted(field: &str) -> String {
    match field.contains([',', '"', '\r', '\n']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.to_owned(),
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
            assert_eq!(quoted(field), expected);
        }
    }
}
