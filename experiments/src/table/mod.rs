//! The experiments, one module each, and the table of them.

mod figure1;
mod figure3;
mod figure4;
mod figure5;
mod figure6;
mod figure7;
mod figure8;
mod figure9;
mod invariance;
mod matching;
mod partial;
mod points;
mod retrieve;
mod robustness;
mod scaling;

use anyhow::Result;
use report::page::{Section, charts, explorer, gallery};
use report::results::{CurvesResults, Figure3Results, Figure9Results, InvarianceResults, RetrievalResults};

use crate::context::Context;

/// One experiment.
pub(crate) struct Experiment {
    /// Its name, its title, and what the page shows of its record.
    pub(crate) section: Section,
    /// The text of its configuration.
    pub(crate) config: &'static str,
    pub(crate) run: fn(&Context<'_>) -> Result<()>,
}

macro_rules! experiment {
    ($name:literal, $title:literal, $show:expr, $run:expr) => {
        Experiment {
            section: Section { name: $name, title: $title, show: $show },
            config: include_str!(concat!("../../configs/", $name, ".toml")),
            run: $run,
        }
    };
}

/// All experiments, in the order in which they run and appear on the page.
#[rustfmt::skip]
pub(crate) const EXPERIMENTS: [Experiment; 16] = [
    experiment!("figure1", "Figure 1. Shapes and their canonical forms", gallery, figure1::run),
    experiment!("figure3", "Figure 3. Canonical forms by several methods", charts::<Figure3Results>, figure3::run),
    experiment!("figure4", "Figure 4. Classification of shapes by their canonical forms", explorer, figure4::run),
    experiment!("figure5a", "Figure 5a. Reconstruction error against the rank", charts::<CurvesResults>, figure5::rank),
    experiment!("figure5b", "Figure 5b. Reconstruction error against alpha", charts::<CurvesResults>, figure5::alpha),
    experiment!("figure6", "Figure 6. Reconstruction error against the number of samples", charts::<CurvesResults>, figure6::run),
    experiment!("figure7", "Figure 7. Stress above the optimum against the number of samples", charts::<CurvesResults>, figure7::run),
    experiment!("figure8", "Figure 8. Time against the number of samples", charts::<CurvesResults>, figure8::run),
    experiment!("figure9", "Figure 9. Time and memory of whole embeddings", charts::<Figure9Results>, figure9::run),
    experiment!("retrieval", "Retrieval. Classification by signatures and canonical forms", charts::<RetrievalResults>, retrieve::run),
    experiment!("invariance", "Invariance. Retrieval of damaged shapes", charts::<InvarianceResults>, invariance::run),
    experiment!("robustness", "Robustness. Scores of damaged shapes", charts::<CurvesResults>, robustness::run),
    experiment!("matching", "Matching. Dense maps between poses", charts::<CurvesResults>, matching::run),
    experiment!("points", "Points. Distances and retrieval of point clouds", charts::<CurvesResults>, points::run),
    experiment!("partial", "Parts. Retrieval of parts of shapes", charts::<CurvesResults>, partial::run),
    experiment!("scaling", "Scaling. Time and memory up to a million vertices", charts::<CurvesResults>, scaling::run),
];

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
    use super::*;
    use crate::config::Config;

    #[test]
    fn every_configuration_is_valid() {
        for Experiment { section, config, .. } in &EXPERIMENTS {
            Config::parse(section.name, config).unwrap();
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
