//! Results as CSV (RFC 4180).

use canonform::index::text_cell;
use canonform::search::{Answer, OrderedBy, SearchRank};

/// One line per result, under a header.
pub(super) fn of(query: &str, report: &Answer) -> String {
    let mut text = "query,rank,id,label,path,distance,signature_distance".to_owned();
    text += match report.rank_by {
        SearchRank::Plain => "\r\n",
        SearchRank::Graph => ",rank_distance\r\n",
        SearchRank::Part => ",part_distance,part_share\r\n",
        SearchRank::Forms => ",form_distance\r\n",
    };
    for found in &report.results {
        let (rank, distance, fused) =
            (found.rank.to_string(), found.distance.to_string(), found.fused.to_string());
        let [query, id, label, path] = [query, &found.id, &found.label, &found.path].map(text_cell);
        let mut fields = vec![query, rank, id, label, path, distance, fused];
        let order = match found.order {
            // Of a query with noise, lines say by their order what is first.
            None | Some(OrderedBy::Surface { .. }) => Vec::new(),
            Some(OrderedBy::Part { part_distance, part_share }) => vec![part_distance, part_share],
            Some(order) => vec![order.distance()],
        };
        fields.extend(order.iter().map(f64::to_string));
        text += &(fields.join(",") + "\r\n");
    }
    text
}
