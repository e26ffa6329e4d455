//! Our numbers beside those of the paper: a section of a page of Markdown, `docs/paper.md`.
//!
//! `configs/paper.txt` (a text with `{EXPERIMENT/NAME: FORMAT}` for numbers, see [`text`](crate::text)) + records -> the
//! section, and beside the page the numbers that it states, as JSON. The rest of the page is written by hand.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use base::files::write_bytes;
use report::Record;
use serde::{Deserialize, Serialize};

use crate::sweep::MeasuredNumbers;
use crate::text::filled;

const TEMPLATE: &str = include_str!("../configs/paper.txt");

/// The experiments whose numbers it states.
const EXPERIMENTS: [&str; 7] =
    ["figure3", "figure4", "figure5a", "figure5b", "figure6", "figure7", "figure9"];

/// Stands for how the numbers were made.
const MADE: &str = "MADE";

/// The comments around the section in its page.
const BOUNDS: [&str; 2] = ["<!-- make paper begins -->\n", "<!-- make paper ends -->\n"];

/// The numbers of one experiment that the page states.
#[derive(Debug, Serialize, Deserialize)]
struct StatedNumbers {
    /// Version, commit, machine and day.
    made: String,
    measured: MeasuredNumbers,
}

/// The numbers by experiment.
type KnownNumbers = BTreeMap<String, StatedNumbers>;

/// Writes the section of the page and its numbers from the records in a folder.
pub(crate) fn write(folder: &Path, path: &Path) -> Result<()> {
    let mut known = KnownNumbers::new();
    for name in EXPERIMENTS {
        let Record { provenance: p, mut measured, .. } = Record::read(folder.join(format!("{name}.json")))?;
        let commit = if p.commit.is_empty() { String::new() } else { format!(", commit {}", p.commit) };
        let day = p.date.split(' ').next().unwrap_or_default();
        let made = format!("version {}{commit}, {}, {day}", p.version, p.machine);
        let is_stated = |number: &str| [":", "}"].map(|end| format!("{{{name}/{number}{end}"));
        measured.retain(|number, _| is_stated(number).iter().any(|field| TEMPLATE.contains(field)));
        known.insert(name.to_owned(), StatedNumbers { made, measured });
    }
    let page = std::fs::read_to_string(path)
        .with_context(|| format!("cannot read {}, whose section is to be written", path.display()))?;
    write_bytes(path, updated(&page, &section(&known)?)?.as_bytes())?;
    let mut json = serde_json::to_vec_pretty(&known)?;
    json.push(b'\n');
    Ok(write_bytes(&path.with_extension("json"), &json)?)
}

/// The page with another section.
fn updated(page: &str, section: &str) -> Result<String> {
    let [begin, end] = BOUNDS;
    let parts = page.split_once(begin).and_then(|(before, rest)| Some((before, rest.split_once(end)?.1)));
    let (before, after) = parts.ok_or_else(|| anyhow!("the page has no section `make paper`"))?;
    Ok([before, begin, section, end, after].concat())
}

/// The section with these numbers.
fn section(known: &KnownNumbers) -> Result<String> {
    let number = |name: &str| -> Option<f64> {
        let (experiment, number) = name.split_once('/')?;
        known.get(experiment)?.measured.get(number).copied()
    };
    let section = filled(TEMPLATE, number).map_err(|name| {
        anyhow!("nothing measures `{name}`; run the experiment on the shapes of the paper (--dataset)")
    })?;
    let mut made: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (experiment, numbers) in known {
        made.entry(&numbers.made).or_default().push(experiment);
    }
    let made = made.iter().map(|(made, experiments)| format!("* {made}: {}", experiments.join(", ")));
    Ok(section.replacen(MADE, &made.collect::<Vec<_>>().join("\n"), 1) + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_page_states_its_numbers() {
        let known = include_str!("../../docs/paper.json");
        let known: KnownNumbers = serde_json::from_str(known).unwrap();
        let page = include_str!("../../docs/paper.md");
        assert_eq!(updated(page, &section(&known).unwrap()).unwrap(), page, "run `make paper`");
    }
}
