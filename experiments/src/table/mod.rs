//! The experiments, one module each, and the table of them.

mod evidence;
mod figure1;
mod figure3;
mod figure4;
mod figure5;
mod figure6;
mod figure7;
mod figure8;
mod figure9;
mod forms;
mod invariance;
mod matching;
mod partial;
mod points;
mod retrieve;
mod robustness;
mod scaling;

use anyhow::{Context as _, Result};
use report::page::{Section, charts, explorer, gallery};
use report::results::{CurvesResults, Figure3Results, Figure9Results, InvarianceResults, RetrievalResults};
use serde::de::DeserializeOwned;

use crate::config::Config;
use crate::experiment::Experiment;

/// An experiment in the table.
pub(crate) struct TableEntry {
    /// Its name, its title, and what the page shows of its record.
    pub(crate) section: Section,
    /// The text of its configuration.
    config: &'static str,
    read: fn(toml::Table) -> Result<Box<dyn Experiment>, toml::de::Error>,
}

impl TableEntry {
    /// Reads the configuration.
    pub(crate) fn parse(&self) -> Result<(Config, Box<dyn Experiment>)> {
        let name = self.section.name;
        let config = Config::parse(name, self.config)?;
        let experiment = (self.read)(config.options.clone());
        Ok((config, experiment.with_context(|| format!("experiments/configs/{name}.toml"))?))
    }
}

fn read<T: Experiment + DeserializeOwned + 'static>(
    options: toml::Table,
) -> Result<Box<dyn Experiment>, toml::de::Error> {
    Ok(Box::new(options.try_into::<T>()?))
}

macro_rules! table {
    ($($name:literal $title:literal $show:expr, $options:ty;)*) => {
        /// All experiments, in the order in which they run and appear on the page.
        pub(crate) const EXPERIMENTS: [TableEntry; [$($name),*].len()] = [$(TableEntry {
            section: Section { name: $name, title: $title, show: $show },
            config: include_str!(concat!("../../configs/", $name, ".toml")),
            read: read::<$options>,
        }),*];
    };
}

table! {
    "figure1" "Figure 1. Shapes and their canonical forms" gallery, figure1::Figure1Options;
    "figure3" "Figure 3. Canonical forms by several methods" charts::<Figure3Results>, figure3::Figure3Options;
    "figure4" "Figure 4. Classification of shapes by their canonical forms" explorer, figure4::Figure4Options;
    "figure5a" "Figure 5a. Reconstruction error against the rank" charts::<CurvesResults>, figure5::RankOptions;
    "figure5b" "Figure 5b. Reconstruction error against alpha" charts::<CurvesResults>, figure5::AlphaOptions;
    "figure6" "Figure 6. Reconstruction error against the number of samples" charts::<CurvesResults>, figure6::Figure6Options;
    "figure7" "Figure 7. Stress above the optimum against the number of samples" charts::<CurvesResults>, figure7::Figure7Options;
    "figure8" "Figure 8. Time against the number of samples" charts::<CurvesResults>, figure8::Figure8Options;
    "figure9" "Figure 9. Time and memory of whole embeddings" charts::<Figure9Results>, figure9::Figure9Options;
    "retrieval" "Retrieval. Classification by signatures and canonical forms" charts::<RetrievalResults>, retrieve::RetrievalOptions;
    "forms" "Forms. Retrieval by canonical forms alone" charts::<CurvesResults>, forms::FormsOptions;
    "invariance" "Invariance. Retrieval of damaged shapes" charts::<InvarianceResults>, invariance::InvarianceOptions;
    "robustness" "Robustness. Scores of damaged shapes" charts::<CurvesResults>, robustness::RobustnessOptions;
    "matching" "Matching. Dense maps between poses" charts::<CurvesResults>, matching::MatchingOptions;
    "points" "Points. Distances and retrieval of point clouds" charts::<CurvesResults>, points::PointsOptions;
    "partial" "Parts. Retrieval of parts of shapes" charts::<CurvesResults>, partial::PartialOptions;
    "evidence" "Evidence. Relations of mechanical parts" charts::<CurvesResults>, evidence::EvidenceOptions;
    "scaling" "Scaling. Time and memory up to a million vertices" charts::<CurvesResults>, scaling::ScalingOptions;
}

/// Stands for all experiments on the command line.
pub(crate) const ALL: &str = "all";

/// Accepts the name of an experiment, or [`ALL`].
pub(crate) fn parse_name(name: &str) -> Result<String, String> {
    let names: Vec<&str> = [ALL].into_iter().chain(EXPERIMENTS.iter().map(|e| e.section.name)).collect();
    match names.contains(&name) {
        true => Ok(name.to_owned()),
        false => Err(format!("there is no experiment `{name}`; choose from {}", names.join(", "))),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn every_configuration_is_valid_and_has_no_option_that_its_experiment_does_not_know() {
        for entry in &EXPERIMENTS {
            let (mut config, _) = entry.parse().unwrap();
            config.options.insert("typo".to_owned(), 1.into());
            let fault = (entry.read)(config.options).err().unwrap();
            assert!(fault.to_string().contains("typo"), "{}", entry.section.name);
        }
    }

    #[test]
    fn every_expectation_is_in_words_of_its_own() {
        for entry in &EXPERIMENTS {
            let (config, _) = entry.parse().unwrap();
            let mut named = BTreeMap::new();
            for bound in &config.findings.expect {
                assert!(bound.words.contains(' '), "{}: {}", entry.section.name, bound.value);
                assert_eq!(*named.entry(&bound.words).or_insert(&bound.value), &bound.value);
            }
        }
    }

    #[test]
    fn names_are_unique_and_unknown_ones_are_refused() {
        for (i, experiment) in EXPERIMENTS.iter().enumerate() {
            let name = experiment.section.name;
            assert_eq!(parse_name(name).as_deref(), Ok(name));
            assert!(EXPERIMENTS[..i].iter().all(|other| other.section.name != name));
        }
        assert!(parse_name("figure2").unwrap_err().contains("figure1, figure3"));
    }
}
