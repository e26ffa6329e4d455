//! Bounds on what an experiment measures.

use anyhow::{Context, Result};
use report::results::Expectation;
use serde::Deserialize;

use crate::collection::Setting;
use crate::sweep::MeasuredNumbers;

/// Bounds on one of an experiment's numbers.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bound {
    /// Name of the number; the module of the experiment lists them.
    pub(crate) value: String,
    /// The number in words, for readers; conditions of texts need none.
    #[serde(default)]
    pub(crate) words: String,
    at_least: Option<f64>,
    at_most: Option<f64>,
    /// Whether the bounds themselves are excluded.
    #[serde(default)]
    strictly: bool,
    /// Whether this is a goal that is known to be missed.
    #[serde(default)]
    goal: bool,
    /// The collections to which it applies; all known ones if empty.
    #[serde(default)]
    pub(crate) on: Vec<Setting>,
}

impl Bound {
    /// Whether a value is within the bounds.
    pub(crate) fn holds(&self, value: f64) -> bool {
        let above = |limit: f64| if self.strictly { value > limit } else { value >= limit };
        let below = |limit: f64| if self.strictly { value < limit } else { value <= limit };
        self.at_least.is_none_or(above) && self.at_most.is_none_or(below)
    }

    pub(crate) fn check(&self, measured: &MeasuredNumbers) -> Result<Expectation> {
        let value =
            *measured.get(&self.value).with_context(|| format!("nothing measures `{}`", self.value))?;
        let [least, most] = if self.strictly { ["above", "below"] } else { ["at least", "at most"] };
        let low = self.at_least.map(|limit| format!("{least} {limit}"));
        let high = self.at_most.map(|limit| format!("{most} {limit}"));
        Ok(Expectation {
            what: if self.words.is_empty() { &self.value } else { &self.words }.clone(),
            expected: low.into_iter().chain(high).collect::<Vec<_>>().join(", "),
            measured: digits(value),
            held: self.holds(value),
            goal: self.goal,
        })
    }
}

/// A number with at least four significant digits.
fn digits(value: f64) -> String {
    if value != 0.0 && (value.abs() < 0.01 || value.abs() >= 1e6) {
        format!("{value:.3e}")
    } else {
        format!("{value:.4}")
    }
}
