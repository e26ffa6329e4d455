//! The configuration of an experiment, `configs/*.toml`: options, expectations and analysis.

use anyhow::{Context, Result, bail};
use canonform::{EmbedMethod, FormOptions, Samples};
use geodesics::{FastMarchingOptions, Method, ObtuseTreatment};
use nmds::Bandwidth;
use report::results::Expectation;
use serde::Deserialize;

use crate::bound::Bound;
use crate::collection::Setting;
use crate::prose::Paragraph;
use crate::sweep::Measured;

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Config {
    /// Samples of the Nyström methods; 0 if the experiment varies them.
    #[serde(default)]
    pub(crate) samples: usize,
    /// Eigenpairs that they keep; 0 if the experiment varies them.
    #[serde(default)]
    pub(crate) rank: usize,
    /// Treatment of obtuse triangles in fast marching; by default that of the solver.
    #[serde(default)]
    pub(crate) obtuse: ObtuseTreatment,
    /// Number of runs, which differ in the first sample or repeat a measurement of time.
    #[serde(default = "one")]
    pub(crate) runs: usize,
    #[serde(default)]
    pub(crate) eigenvectors: usize,
    /// The values on the horizontal axis: numbers of samples, ranks or numbers of vertices.
    #[serde(default)]
    pub(crate) counts: Vec<usize>,
    /// The values on the horizontal axis, as exponents of ten.
    #[serde(default)]
    pub(crate) exponents: Vec<f64>,
    #[serde(default)]
    printed: Vec<Printed>,
    /// Shapes of each class that are damaged.
    #[serde(default)]
    pub(crate) queries: usize,
    /// Number of nearest neighbours that vote.
    #[serde(default = "one")]
    pub(crate) knn: usize,
    /// Training shapes of each class, for classification over random splits.
    #[serde(default)]
    pub(crate) training: Vec<usize>,
    /// Number of random splits.
    #[serde(default = "one")]
    pub(crate) splits: usize,
    /// Most shapes whose forms are all aligned with each other.
    #[serde(default)]
    pub(crate) aligned: usize,
    #[serde(default)]
    pub(crate) expect: Vec<Bound>,
    /// What the results show.
    analysis: Vec<Paragraph>,
}

fn one() -> usize {
    1
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Printed {
    /// Its row: a class, or a number of vertices.
    pub(crate) row: String,
    /// Its column: a method.
    pub(crate) method: String,
    pub(crate) value: f64,
}

impl Config {
    pub(crate) fn parse(name: &str, text: &str) -> Result<Self> {
        toml::from_str(text).with_context(|| format!("experiments/configs/{name}.toml"))
    }

    /// The options of the paper's method.
    pub(crate) fn nmds(&self, seed: u64) -> FormOptions {
        let marching = FastMarchingOptions { obtuse: self.obtuse, ..FastMarchingOptions::default() };
        FormOptions {
            geodesic: Method::FastMarching(marching),
            samples: Samples::Count(self.samples),
            method: EmbedMethod::low_rank(self.rank),
            seed,
            ..FormOptions::default()
        }
    }

    /// The options of the baseline, kernel PCA.
    pub(crate) fn kernel_pca(&self, seed: u64) -> FormOptions {
        let method = EmbedMethod::KernelPca { rank: Some(self.rank), bandwidth: Bandwidth::Mean };
        FormOptions { method, ..self.nmds(seed) }
    }

    /// A number printed in the paper.
    pub(crate) fn printed(&self, row: &str, method: &str) -> Option<f64> {
        self.printed.iter().find(|p| p.row == row && p.method == method).map(|p| p.value)
    }

    /// Compares the expectations that apply with what was measured.
    pub(crate) fn check(&self, setting: Setting, measured: &Measured) -> Result<Vec<Expectation>> {
        let applies = |bound: &&Bound| match setting {
            Setting::Other => false,
            _ => bound.on.is_empty() || bound.on.contains(&setting),
        };
        self.expect.iter().filter(applies).map(|bound| bound.check(measured)).collect()
    }

    /// The text on a run that measured these numbers, on the `shapes` that are examined closely.
    ///
    /// A paragraph about a number that was not measured is left out if the collection is an unknown one, and an error
    /// otherwise.
    pub(crate) fn analysis(&self, setting: Setting, numbers: &Measured, shapes: &[&str]) -> Result<String> {
        let mut text = Vec::new();
        for paragraph in self.analysis.iter().filter(|p| p.on.is_empty() || p.on.contains(&setting)) {
            match paragraph.write(numbers, shapes) {
                Ok(paragraph) => text.push(paragraph),
                Err(_) if setting == Setting::Other => {}
                Err(name) => bail!("the analysis: nothing measures `{name}`"),
            }
        }
        text.retain(|paragraph| !paragraph.is_empty());
        Ok(text.join("\n\n"))
    }
}

impl Bound {
    /// Whether a value is within the bounds.
    pub(crate) fn holds(&self, value: f64) -> bool {
        let above = |limit: f64| if self.strictly { value > limit } else { value >= limit };
        let below = |limit: f64| if self.strictly { value < limit } else { value <= limit };
        self.at_least.is_none_or(above) && self.at_most.is_none_or(below)
    }

    fn check(&self, measured: &Measured) -> Result<Expectation> {
        let value =
            *measured.get(&self.value).with_context(|| format!("nothing measures `{}`", self.value))?;
        let strict = if self.strictly { " (strictly)" } else { "" };
        let low = self.at_least.map(|limit| format!("at least {limit}{strict}"));
        let high = self.at_most.map(|limit| format!("at most {limit}{strict}"));
        Ok(Expectation {
            what: self.value.clone(),
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

#[cfg(test)]
mod tests {
    use report::results::Outcome;

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
        at_least = 1.0
        strictly = true
        on = ["paper"]
    "#;

    #[test]
    fn bounds_apply_to_their_collections_and_may_be_strict() {
        let config = Config::parse("test", TEXT).unwrap();
        let held = |setting, x: f64| {
            let found = config.check(setting, &[("x".to_owned(), x)].into()).unwrap();
            found.iter().map(|e| e.held).collect::<Vec<_>>()
        };
        assert_eq!(held(Setting::BuiltIn, 1.0), [true]);
        assert_eq!(held(Setting::Paper, 1.0), [true, false]);
        assert_eq!(held(Setting::Paper, 0.5), [false, false]);
        assert!(held(Setting::Other, 0.0).is_empty());
        assert!(config.check(Setting::Paper, &Measured::new()).is_err());
    }

    #[test]
    fn texts_follow_the_numbers_and_the_collection() {
        let config = Config::parse("test", TEXT).unwrap();
        let text = |setting, x: f64| config.analysis(setting, &[("x".to_owned(), x)].into(), &[]);
        assert_eq!(text(Setting::BuiltIn, 1.0).unwrap(), "x is 1.");
        assert_eq!(text(Setting::BuiltIn, 2.5).unwrap(), "x is 2.50.");
        assert_eq!(text(Setting::Other, 2.5).unwrap(), "x is 2.50.");
        assert!(text(Setting::Paper, 1.0).unwrap_err().to_string().contains("`y`"));
    }

    #[test]
    fn a_goal_that_is_missed_is_no_failure() {
        let config = Config::parse("test", &TEXT.replacen("strictly = true", "goal = true", 1)).unwrap();
        let found = config.check(Setting::Paper, &[("x".to_owned(), 0.5)].into()).unwrap();
        assert_eq!(
            found.iter().map(Expectation::outcome).collect::<Vec<_>>(),
            [Outcome::Failed, Outcome::Missed]
        );
    }

    #[test]
    fn unknown_keys_are_errors_that_name_the_key() {
        let fault = Config::parse("test", &format!("typo = 1\n{TEXT}")).unwrap_err();
        assert!(format!("{fault:#}").contains("typo"));
    }
}
