//! The comparison with the paper as a page of Markdown, `docs/paper.md`.
//!
//! `paper.md` (a text with `{EXPERIMENT/NAME: FORMAT}` for numbers, see [`prose`](crate::prose)) + records -> the page, and
//! beside it the numbers that it states, as JSON.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Result, anyhow};
use files::write_bytes;
use report::results::{Provenance, read};
use serde::{Deserialize, Serialize};

use crate::prose::filled;
use crate::sweep::Measured;

const TEMPLATE: &str = include_str!("../paper.md");

/// Stands for how the numbers were made.
const MADE: &str = "MADE";

/// The numbers of one experiment that the page states.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Numbers {
    /// Version, commit, machine and day.
    made: String,
    measured: Measured,
}

/// The numbers by experiment.
type Known = BTreeMap<String, Numbers>;

/// Writes the page and its numbers from the records in a folder.
pub(crate) fn write(folder: &Path, path: &Path) -> Result<()> {
    #[derive(Deserialize)]
    struct Made {
        provenance: Provenance,
        #[serde(default)]
        measured: Measured,
    }
    let names = RefCell::new(BTreeSet::new());
    filled(TEMPLATE, |name| {
        names.borrow_mut().insert(name.to_owned());
        Some(0.0)
    })
    .map_err(|field| anyhow!("experiments/paper.md: `{field}` is not closed"))?;
    let mut known = Known::new();
    for name in names.take() {
        let (experiment, number) = name.split_once('/').unwrap_or((&name, ""));
        if !known.contains_key(experiment) {
            let Made { provenance: p, measured } = read(folder.join(format!("{experiment}.json")))?;
            let commit = if p.commit.is_empty() { String::new() } else { format!(", commit {}", p.commit) };
            let day = p.date.split(' ').next().unwrap_or_default();
            let made = format!("version {}{commit}, {}, {day}", p.version, p.machine);
            known.insert(experiment.to_owned(), Numbers { made, measured });
        }
        if !known.get(experiment).is_some_and(|numbers| numbers.measured.contains_key(number)) {
            return Err(anyhow!(
                "{experiment}.json does not measure `{number}`; run the experiment on the shapes of the paper (--dataset)"
            ));
        }
    }
    let stated = |experiment: &str, number: &str| TEMPLATE.contains(&format!("{{{experiment}/{number}"));
    for (experiment, numbers) in &mut known {
        numbers.measured.retain(|number, _| stated(experiment, number));
    }
    write_bytes(path, page(&known)?.as_bytes())?;
    let mut json = serde_json::to_vec_pretty(&known)?;
    json.push(b'\n');
    Ok(write_bytes(&path.with_extension("json"), &json)?)
}

/// The page with these numbers.
fn page(known: &Known) -> Result<String> {
    let number = |name: &str| -> Option<f64> {
        let (experiment, number) = name.split_once('/')?;
        known.get(experiment)?.measured.get(number).copied()
    };
    let page = filled(TEMPLATE, number).map_err(|name| anyhow!("nothing measures `{name}`"))?;
    let mut made: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (experiment, numbers) in known {
        made.entry(&numbers.made).or_default().push(experiment);
    }
    let made = made.iter().map(|(made, experiments)| format!("* {made}: {}", experiments.join(", ")));
    Ok(page.replacen(MADE, &made.collect::<Vec<_>>().join("\n"), 1) + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The committed page.
    fn committed(extension: &str) -> String {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/paper.md").with_extension(extension);
        std::fs::read_to_string(path).unwrap()
    }

    #[test]
    fn the_committed_page_states_its_numbers() {
        let known: Known = serde_json::from_str(&committed("json")).unwrap();
        assert_eq!(page(&known).unwrap(), committed("md"), "run `make paper`");
    }

    #[test]
    fn the_page_follows_its_numbers() {
        let mut known: Known = serde_json::from_str(&committed("json")).unwrap();
        let stress = "default david MDS stress";
        known.get_mut("figure3").unwrap().measured.insert(stress.to_owned(), 1234.56);
        assert!(page(&known).unwrap().contains("| 1,234.6 |"));
        known.get_mut("figure3").unwrap().measured.remove(stress);
        assert!(page(&known).unwrap_err().to_string().contains(stress));
    }
}
