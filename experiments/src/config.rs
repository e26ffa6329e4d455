//! The configuration of an experiment, `configs/*.toml`: options, expectations and texts.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use report::record::Expectation;
use serde::Deserialize;

use crate::collection::Setting;
use crate::sweep::MeasuredNumbers;
use crate::text::filled;

/// A configuration. Its texts state numbers of the run, see [`text`](crate::text).
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Config {
    pub(crate) title: String,
    /// What the experiment reads, as text for its record.
    #[serde(default)]
    pub(crate) options: toml::Table,
    /// How a page can begin, if all its numbers were measured.
    #[serde(default)]
    pub(crate) lead: String,
    /// Of the figures and tables without a caption of their own.
    #[serde(default)]
    pub(crate) caption: String,
    /// What the results show. Paragraphs with numbers that were not measured are left out.
    pub(crate) analysis: String,
    #[serde(default)]
    expect: Vec<Bound>,
}

/// The options of all experiments; each reads its own.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Options {
    /// Samples of an embedding, and eigenpairs that are kept.
    pub(crate) samples: usize,
    pub(crate) rank: usize,
    pub(crate) runs: usize,
    pub(crate) eigenvectors: usize,
    /// The values of the horizontal axis.
    pub(crate) counts: Vec<usize>,
    /// Decimal logarithms of alpha.
    pub(crate) exponents: Vec<f64>,
    /// Numbers printed in the paper, by row (a class, or a number of vertices) and method.
    pub(crate) printed: BTreeMap<String, BTreeMap<String, f64>>,
    /// Shapes of each class that are searched for; of `robustness`, of all classes together.
    pub(crate) queries: usize,
    /// Nearest neighbors that vote.
    pub(crate) voters: usize,
    /// Most shapes whose forms are all aligned with each other.
    pub(crate) aligned: usize,
    /// Parts of which all pairs are compared, and parts that are compared with copies of themselves.
    pub(crate) parts: usize,
    pub(crate) treated: usize,
}

/// Bounds on one of an experiment's numbers.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Bound {
    /// Name of the number; the module of the experiment lists them.
    value: String,
    /// The number in words, for readers.
    words: String,
    at_least: Option<f64>,
    at_most: Option<f64>,
    /// Whether this is a goal that is known to be missed.
    #[serde(default)]
    goal: bool,
    /// The collections to which it applies; all known ones but the one of whole maps if empty.
    #[serde(default)]
    on: Vec<Setting>,
}

impl Bound {
    fn applies(&self, setting: Setting) -> bool {
        let is_usual = !matches!(setting, Setting::Other | Setting::FullResolution);
        self.on.contains(&setting) || self.on.is_empty() && is_usual
    }

    fn check(&self, measured: &MeasuredNumbers) -> Result<Expectation> {
        let value =
            *measured.get(&self.value).with_context(|| format!("nothing measures `{}`", self.value))?;
        let limits =
            [self.at_least.map(|l| format!("at least {l}")), self.at_most.map(|l| format!("at most {l}"))];
        Ok(Expectation {
            what: self.words.clone(),
            expected: limits.into_iter().flatten().collect::<Vec<_>>().join(", "),
            measured: report::numbers::significant(value, 4),
            held: self.at_least.is_none_or(|l| value >= l) && self.at_most.is_none_or(|l| value <= l),
            goal: self.goal,
        })
    }
}

impl Config {
    pub(crate) fn parse(name: &str, text: &str) -> Result<(Self, Options)> {
        let place = || format!("experiments/configs/{name}.toml");
        let config: Self = toml::from_str(text).with_context(place)?;
        let options = config.options.clone().try_into().with_context(place)?;
        Ok((config, options))
    }

    /// Compares the expectations that apply with what was measured.
    pub(crate) fn check(&self, setting: Setting, measured: &MeasuredNumbers) -> Result<Vec<Expectation>> {
        let applying = self.expect.iter().filter(|bound| bound.applies(setting));
        applying.map(|bound| bound.check(measured)).collect()
    }

    /// The text on a run with these numbers.
    pub(crate) fn analysis(&self, numbers: &MeasuredNumbers) -> String {
        let paragraphs = self.analysis.split("\n\n");
        let filled = paragraphs.filter_map(|text| filled(text, |name| numbers.get(name).copied()).ok());
        filled.collect::<Vec<_>>().join("\n\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"
        title = "Test"
        analysis = "x is {x}.\n\nOn the paper's shapes, y is {y}."
        options.samples = 10
        [[expect]]
        value = "x"
        words = "The number x"
        at_least = 1.0
        [[expect]]
        value = "x"
        words = "The number x"
        at_least = 2.0
        goal = true
        on = ["paper"]
    "#;

    #[test]
    fn bounds_apply_to_their_collections_and_texts_to_what_was_measured() {
        let (config, options) = Config::parse("test", TEXT).unwrap();
        assert_eq!(options.samples, 10);
        let held = |setting, x: f64| -> Vec<(bool, bool)> {
            let found = config.check(setting, &[("x".to_owned(), x)].into()).unwrap();
            found.iter().map(|e| (e.held, e.goal)).collect()
        };
        assert_eq!(held(Setting::BuiltIn, 1.0), [(true, false)]);
        assert_eq!(held(Setting::Paper, 1.5), [(true, false), (false, true)]);
        assert!(held(Setting::Other, 0.0).is_empty() && held(Setting::FullResolution, 0.0).is_empty());
        assert!(config.check(Setting::Paper, &MeasuredNumbers::new()).is_err());
        assert_eq!(config.analysis(&[("x".to_owned(), 2.5)].into()), "x is 2.50.");
    }
}
