//! Published scores, as `--compare` reads them from a TOML file.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context as _, Result};
use serde::Deserialize;

use crate::sweep::SCORES;

/// Published scores on one collection.
#[derive(Debug, Deserialize)]
pub(crate) struct Published {
    pub(super) collection: String,
    pub(super) method: Vec<PublishedMethod>,
}

/// Published scores of a method; those that were not published are left out.
#[derive(Debug, Deserialize)]
pub(super) struct PublishedMethod {
    pub(super) name: String,
    pub(super) source: String,
    /// Whether its ranking uses the rest of the collection, as the graph does.
    #[serde(default)]
    pub(super) uses_collection: bool,
    /// By their names in lower case.
    #[serde(flatten)]
    scores: BTreeMap<String, f64>,
}

impl PublishedMethod {
    pub(super) fn scores(&self) -> [Option<f64>; 6] {
        SCORES.map(|name| self.scores.get(&name.to_lowercase()).copied())
    }
}

/// Reads published scores.
pub(crate) fn published(path: &Path) -> Result<Published> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    toml::from_str(&text).with_context(|| path.display().to_string())
}
