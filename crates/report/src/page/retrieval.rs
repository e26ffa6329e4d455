//! The section on retrieval.

use std::fmt::Write;
use std::path::Path;

use serde_json::json;

use super::chart::{Plot, chart};
use super::html::{Cell, paragraphs, table};
use super::{Section, expectations, folded, picture, provenance};
use crate::curves::PART;
use crate::results::{RetrievalRecord, RetrievalRow, Scale, read};
use crate::retrieval::CONFUSION_PART;
use crate::{ReportError, tables};
use view::numbers::signed;

/// Scores, curves and confusion of all ways to compare.
pub(super) fn retrieval_section(folder: &Path) -> Result<Section, ReportError> {
    let (name, title) = ("retrieval", "Retrieval and classification by signatures and forms");
    let path = folder.join("retrieval.json");
    if !path.exists() {
        return Ok(Section::missing(name, title));
    }
    let record: RetrievalRecord = read(path)?;
    let mut body = paragraphs(&record.analysis);
    let curves = format!(
        "Precision over recall, means over the queries among {} shapes: further right and up is better.",
        record.names.len()
    );
    let mut still = picture(folder, name, PART, &curves)?;
    let c = &record.classification;
    let caption = format!(
        "What the vote of the {} nearest by {} takes every shape for, itself left out; a shape is unknown \
         when nothing is nearer than {:.3}.",
        c.voters, c.method, c.threshold
    );
    still += &picture(folder, name, CONFUSION_PART, &caption)?;
    let mut scales: Vec<Scale> = record.rows.iter().map(|row| row.scale).collect();
    scales.dedup();
    let plot = |(i, scale): (usize, &Scale)| {
        Plot::new("precision", i, format!("Precision over recall of all ways to compare, {}", scale.name()))
    };
    let mut plots: Vec<Plot> = scales.iter().enumerate().map(plot).collect();
    plots.push(Plot::new("confusion", 0, "True classes against predicted ones"));
    let rows = record.rows.iter().map(|row| {
        json!({"method": row.method, "scale": row.scale, "precision": row.precision, "map": row.micro.map})
    });
    let classification = json!({"classes": c.classes, "confusion": c.confusion});
    let data = json!({"rows": rows.collect::<Vec<_>>(), "classification": classification});
    body.push_str(&chart(name, &plots, &format!("{curves} {caption}"), &data, &still));
    body.push_str(&expectations(&record.expectations));
    body.push_str("<h3>Numbers</h3>\n");
    let caption = "NN nearest neighbour, FT and ST first and second tier, E E-measure, DCG discounted cumulative gain, \
                   mAP mean average precision: 1 is best. Means over queries; macro means over classes. Least mAP: with \
                   whichever class left out of the collection it is worst.";
    body.push_str(&table(
        caption,
        &tables::RETRIEVAL_HEADINGS,
        &record.rows.iter().map(row).collect::<Vec<_>>(),
    ));
    let unknown = [c.missed, c.mistaken, c.threshold].map(|v| Cell::Number(signed(v, 3)));
    let headings = ["missed", "mistaken", "threshold"];
    let caption = "Unknown shapes. Missed: share of shapes called unknown although others of their class are there; \
                   mistaken: share given a class while no other of theirs is there; by thresholds found without that class.";
    let _ = write!(body, "{}", folded("unknown shapes", &table(caption, &headings, &[unknown.into()])));
    body.push_str(&provenance(&record.provenance));
    Ok(Section { name, title, body, expectations: record.expectations })
}

fn row(row: &RetrievalRow) -> Vec<Cell> {
    let size = match row.scale {
        Scale::Raw => "counts",
        Scale::Normalized => "ignored",
    };
    let mut cells = vec![Cell::Text(row.method.clone()), Cell::Text(size.to_owned())];
    cells.extend(tables::retrieval_values(row).map(|v| Cell::Number(signed(v, 3))));
    cells
}
