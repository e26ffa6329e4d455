//! The sentences with which the page begins: what is seen, and what was found.
//!
//! `configs/lead.txt` has a paragraph for each experiment that can begin a page, the most telling first, with
//! `{EXPERIMENT/NAME: FORMAT}` for numbers (see [`prose`](crate::prose)). `NAME` is a number that the experiment measured,
//! the name of a list in its record, which stands for its length, or `classes`.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;

use report::ReportError;
use report::results::read;
use serde_json::Value;

use crate::prose::filled;

const TEMPLATE: &str = include_str!("../configs/lead.txt");

/// How a page of built-in shapes begins.
const GENERATED: &str = "The shapes on this page are generated; its figures are those of the paper by Shamai, Zibulevsky and Kimmel (3DOR 2015). ";

/// The first paragraph whose numbers are all in the records of a folder; empty if there is none.
pub(crate) fn lead(folder: &Path) -> Result<String, ReportError> {
    let records = Records { folder, known: RefCell::default() };
    for paragraph in TEMPLATE.split("\n\n") {
        let fault = RefCell::new(None);
        let number = |name: &str| records.number(name).unwrap_or_else(|e| fault.replace(Some(e)).and(None));
        let text = filled(paragraph, number);
        if let Some(fault) = fault.into_inner() {
            return Err(fault);
        }
        if let Ok(text) = text {
            let generated = if records.are_generated() { GENERATED } else { "" };
            return Ok(format!("{generated}{text}"));
        }
    }
    Ok(String::new())
}

/// The records of a folder, each read at first use.
struct Records<'a> {
    folder: &'a Path,
    /// By experiment; null if there is no record.
    known: RefCell<BTreeMap<String, Value>>,
}

impl Records<'_> {
    /// Whether the shapes of a record that was read are built in.
    fn are_generated(&self) -> bool {
        let of = |record: &Value| {
            record["provenance"]["dataset"].as_str().is_some_and(|d| d.starts_with("built-in"))
        };
        self.known.borrow().values().any(of)
    }

    /// The number `EXPERIMENT/NAME`.
    fn number(&self, name: &str) -> Result<Option<f64>, ReportError> {
        let Some((experiment, name)) = name.split_once('/') else { return Ok(None) };
        let mut known = self.known.borrow_mut();
        if !known.contains_key(experiment) {
            let path = self.folder.join(format!("{experiment}.json"));
            let record = if path.exists() { read(path)? } else { Value::Null };
            known.insert(experiment.to_owned(), record);
        }
        Ok(known.get(experiment).and_then(|record| stated(record, name)))
    }
}

/// What a record states under a name.
fn stated(record: &Value, name: &str) -> Option<f64> {
    let length = |list: &Value| list.as_array().map(|list| list.len() as f64);
    match name {
        "classes" => length(&record["provenance"]["classes"]),
        _ => record["measured"][name].as_f64().or_else(|| length(&record[name])),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_page_begins_with_the_most_telling_experiment_that_ran() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, record: Value| {
            std::fs::write(folder.path().join(name), record.to_string()).unwrap();
        };
        assert_eq!(lead(folder.path()).unwrap(), "");
        let made = json!({"classes": ["cat", "dog"], "dataset": "built-in articulated families"});
        let measured = json!({"largest stress ratio": 0.125});
        write("figure1.json", json!({"provenance": made, "measured": measured, "shapes": [1, 2, 3]}));
        let text = lead(folder.path()).unwrap();
        assert!(text.starts_with("The shapes on this page are generated"), "{text}");
        assert!(text.contains("3 shapes of 2 classes") && text.ends_with("12.5 % of their squared size."));
        // A record without a number of the paragraph does not begin the page.
        write("figure4.json", json!({"provenance": made, "names": [1, 2, 3, 4]}));
        assert_eq!(lead(folder.path()).unwrap(), text);
        let measured = json!({
            "NMDS raw nn": 1.0, "NMDS raw mAP": 0.9876, "KPCA-Nystrom raw nn": 0.75, "KPCA-Nystrom raw mAP": 0.5,
        });
        write("figure4.json", json!({"provenance": made, "measured": measured, "names": [1, 2, 3, 4]}));
        let text = lead(folder.path()).unwrap();
        assert!(text.contains("4 shapes of 2 classes") && text.contains("precision of 0.988"), "{text}");
        std::fs::write(folder.path().join("figure4.json"), "{").unwrap();
        assert!(lead(folder.path()).unwrap_err().to_string().contains("figure4.json"));
    }

    #[test]
    fn every_paragraph_has_two_sentences() {
        for paragraph in TEMPLATE.split("\n\n") {
            let text = filled(paragraph, |_| Some(0.5)).unwrap();
            assert_eq!(text.matches(". ").count() + 1, 2, "{text}");
        }
    }
}
