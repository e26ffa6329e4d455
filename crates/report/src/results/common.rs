//! Parts of every record.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The results of an experiment with their context, as `NAME.json` holds them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Record<T> {
    /// How they were made.
    pub provenance: RunProvenance,
    /// What was measured; its fields are fields of the record in JSON.
    #[serde(flatten)]
    pub results: T,
    /// Numbers by name, which expectations and texts use.
    #[serde(default)]
    pub measured: BTreeMap<String, f64>,
    /// What was expected.
    pub expectations: Vec<Expectation>,
    /// What the results show, in paragraphs of plain text separated by empty lines. The run writes it from `measured`.
    pub analysis: String,
}

/// How a record was made.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunProvenance {
    /// Name of the program.
    pub program: String,
    /// Its version.
    pub version: String,
    /// The commit it was built from, with `+` if files had changed since; empty if unknown.
    #[serde(default)]
    pub commit: String,
    /// When the run ended, in UTC, for example `2026-01-31 12:00`.
    #[serde(default)]
    pub date: String,
    /// Processor, number of worker threads and operating system.
    #[serde(default)]
    pub machine: String,
    /// The command line that repeats the run.
    pub command: String,
    /// The options of that command line, each after a space, with which other experiments run on the same shapes.
    #[serde(default)]
    pub arguments: String,
    /// The source of the shapes: a folder, or the name of a built-in dataset.
    pub dataset: String,
    /// The classes in use, in the order of the command line.
    pub classes: Vec<String>,
    /// The seed of all random numbers.
    pub seed: u64,
    /// Every option of every stage.
    pub options: serde_json::Value,
    /// Wall-clock seconds by stage.
    pub seconds: BTreeMap<String, f64>,
}

/// An expected and a measured number.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Expectation {
    /// What was measured, for example `NMDS, raw: first tier`.
    pub what: String,
    /// The expected range, for example `at least 0.99`.
    pub expected: String,
    /// The measured value, for example `0.994`.
    pub measured: String,
    /// Whether the measured value is in the expected range.
    pub held: bool,
    /// Whether this is a goal that is known to be missed, so that missing it is no failure.
    #[serde(default)]
    pub goal: bool,
}

impl Expectation {
    /// What came of it.
    #[must_use]
    pub fn outcome(&self) -> ExpectationOutcome {
        match (self.held, self.goal) {
            (true, _) => ExpectationOutcome::Held,
            (false, true) => ExpectationOutcome::Missed,
            (false, false) => ExpectationOutcome::Failed,
        }
    }
}

/// What came of an expectation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExpectationOutcome {
    /// The measured value is in the expected range.
    Held,
    /// A goal is not reached yet.
    Missed,
    /// The measured value is not in the expected range.
    Failed,
}

impl ExpectationOutcome {
    /// The word for it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Held => "held",
            Self::Missed => "goal missed",
            Self::Failed => "failed",
        }
    }
}

/// Whether shapes keep their size when they are compared, and by what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Original size.
    Raw,
    /// All scaled to the same size.
    Normalized,
    /// All scaled to the same size, in many dimensions, by the spectrum of straight distances instead of alignment.
    Spectrum,
}

impl Scale {
    /// The name in file names and in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Normalized => "normalized",
            Self::Spectrum => "spectrum",
        }
    }

    /// The unit of distances between canonical forms.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Raw => "form units",
            Self::Normalized => "form size = 1",
            Self::Spectrum => "logarithms",
        }
    }
}
