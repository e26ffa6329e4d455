//! The configuration of an experiment, `configs/*.toml`: options of its own, expectations and analysis.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail};
use report::results::Expectation;
use serde::Deserialize;

use crate::bound::Bound;
use crate::collection::Setting;
use crate::prose::Paragraph;
use crate::sweep::MeasuredNumbers;

/// Numbers printed in the paper, by row (a class, or a number of vertices) and method.
pub(crate) type Printed = BTreeMap<String, BTreeMap<String, f64>>;

/// A configuration.
#[derive(Debug)]
pub(crate) struct Config {
    /// What the experiment reads.
    pub(crate) options: toml::Table,
    pub(crate) findings: Findings,
}

/// What all configurations have in common.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Findings {
    #[serde(default)]
    pub(crate) expect: Vec<Bound>,
    /// Of the figure, with numbers as in the analysis.
    #[serde(default)]
    pub(crate) caption: String,
    /// What the results show.
    analysis: Vec<Paragraph>,
}

impl Config {
    pub(crate) fn parse(name: &str, text: &str) -> Result<Self> {
        let place = || format!("experiments/configs/{name}.toml");
        let mut options: toml::Table = toml::from_str(text).with_context(place)?;
        let findings =
            ["expect", "caption", "analysis"].into_iter().filter_map(|key| options.remove_entry(key));
        let findings = toml::Table::from_iter(findings).try_into().with_context(place)?;
        Ok(Self { options, findings })
    }

    /// The options that are whole numbers, which texts may state.
    pub(crate) fn counts(&self) -> impl Iterator<Item = (&str, f64)> {
        self.options.iter().filter_map(|(name, value)| Some((name.as_str(), value.as_integer()? as f64)))
    }
}

impl Findings {
    /// Compares the expectations that apply with what was measured.
    pub(crate) fn check(&self, setting: Setting, measured: &MeasuredNumbers) -> Result<Vec<Expectation>> {
        let applies = |bound: &&Bound| match setting {
            Setting::Other => false,
            Setting::FullResolution => bound.on.contains(&setting),
            _ => bound.on.is_empty() || bound.on.contains(&setting),
        };
        self.expect.iter().filter(applies).map(|bound| bound.check(measured)).collect()
    }

    /// The text on a run that measured these numbers, on the `shapes` that are examined closely.
    ///
    /// A paragraph about a number that was not measured is left out unless it names the collection or the collection is that of
    /// the paper, the built-in one or TOSCA; there it is an error.
    pub(crate) fn analysis(
        &self,
        setting: Setting,
        numbers: &MeasuredNumbers,
        shapes: &[&str],
    ) -> Result<String> {
        let mut text = Vec::new();
        for paragraph in self.analysis.iter().filter(|p| p.on.is_empty() || p.on.contains(&setting)) {
            match paragraph.write(numbers, shapes) {
                Ok(paragraph) => text.push(paragraph),
                Err(_) if setting == Setting::Other => {}
                Err(_) if setting == Setting::FullResolution && !paragraph.on.contains(&setting) => {}
                Err(name) => bail!("the analysis: nothing measures `{name}`"),
            }
        }
        text.retain(|paragraph| !paragraph.is_empty());
        Ok(text.join("\n\n"))
    }
}

#[cfg(test)]
mod tests {
    use report::results::ExpectationOutcome;

    use super::*;

    const TEXT: &str = r#"
        samples = 10
        rank = 5
        [[analysis]]
        text = "x is {x}."
        [[analysis]]
        text = "On the paper's shapes, y is {y}."
        on = ["paper", "other"]
        [[expect]]
        value = "x"
        at_least = 1.0
        [[expect]]
        value = "x"
        words = "The number x"
        at_least = 1.0
        strictly = true
        on = ["paper"]
    "#;

    #[test]
    fn bounds_apply_to_their_collections_and_may_be_strict() {
        let config = Config::parse("test", TEXT).unwrap();
        let limits = config.findings.check(Setting::Paper, &[("x".to_owned(), 1.0)].into()).unwrap();
        let limits: Vec<_> = limits.iter().map(|e| (e.what.as_str(), e.expected.as_str())).collect();
        assert_eq!(limits, [("x", "at least 1"), ("The number x", "above 1")]);
        let held = |setting, x: f64| {
            let found = config.findings.check(setting, &[("x".to_owned(), x)].into()).unwrap();
            found.iter().map(|e| e.held).collect::<Vec<_>>()
        };
        assert_eq!(held(Setting::BuiltIn, 1.0), [true]);
        assert_eq!(held(Setting::Paper, 1.0), [true, false]);
        assert_eq!(held(Setting::Paper, 0.5), [false, false]);
        assert!(held(Setting::Other, 0.0).is_empty());
        assert!(config.findings.check(Setting::Paper, &MeasuredNumbers::new()).is_err());
        // A goal that is missed is no failure.
        let config = Config::parse("test", &TEXT.replacen("strictly = true", "goal = true", 1)).unwrap();
        let found = config.findings.check(Setting::Paper, &[("x".to_owned(), 0.5)].into()).unwrap();
        let outcomes: Vec<_> = found.iter().map(Expectation::outcome).collect();
        assert_eq!(outcomes, [ExpectationOutcome::Failed, ExpectationOutcome::Missed]);
    }

    #[test]
    fn texts_follow_the_numbers_and_the_collection() {
        let config = Config::parse("test", TEXT).unwrap();
        let text = |setting, x: f64| config.findings.analysis(setting, &[("x".to_owned(), x)].into(), &[]);
        assert_eq!(text(Setting::BuiltIn, 1.0).unwrap(), "x is 1.");
        assert_eq!(text(Setting::BuiltIn, 2.5).unwrap(), "x is 2.50.");
        assert_eq!(text(Setting::Other, 2.5).unwrap(), "x is 2.50.");
        assert!(text(Setting::Paper, 1.0).unwrap_err().to_string().contains("`y`"));
    }

    #[test]
    fn unknown_keys_are_errors_that_name_the_key() {
        let fault = Config::parse("test", &format!("{TEXT}\ntypo = 1")).unwrap_err();
        assert!(format!("{fault:#}").contains("typo"));
    }
}
