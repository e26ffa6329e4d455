//! What every experiment gets, and what it does with its results.

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use anyhow::Result;
use canonform::{FormOptions, Observer, StressChoice};
use report::results::{CurvesPanel, CurvesRecord, Expectation, Provenance, Series};
use report::{Record, save};
use surface::VertexId;
use terminal::Bars;

use crate::collection::{Collection, Setting};
use crate::config::Config;
use crate::specimen::{Distances, Specimen};
use crate::sweep::{Measured, places, series};

/// What every experiment gets.
pub(crate) struct Context<'a> {
    /// Name of the experiment, and of its files.
    pub(crate) name: &'static str,
    pub(crate) config: Config,
    pub(crate) collection: &'a Collection,
    pub(crate) seed: u64,
    /// The folder for results.
    pub(crate) folder: &'a Path,
    /// The command line that repeats the run.
    pub(crate) command: String,
    pub(crate) observer: &'a dyn Observer,
    pub(crate) bars: &'a Bars,
    pub(crate) start: Instant,
}

impl Context<'_> {
    /// Compares the configured expectations with what was measured, and prints those that failed.
    pub(crate) fn check(&self, measured: impl Fn(&str) -> Option<f64>) -> Result<Vec<Expectation>> {
        let checked = self.config.check(self.collection.setting(), measured)?;
        self.bars.finish();
        for failed in checked.iter().filter(|expectation| !expectation.held) {
            eprintln!("not as expected: {} is {}, {}", failed.what, failed.measured, failed.expected);
        }
        Ok(checked)
    }

    /// How a record was made, up to now.
    pub(crate) fn provenance(&self, options: serde_json::Value) -> Provenance {
        Provenance {
            program: "canonform experiments".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: self.command.clone(),
            dataset: self.collection.dataset.clone(),
            classes: self.collection.classes.clone(),
            seed: self.seed,
            options,
            seconds: [("run".to_owned(), self.start.elapsed().as_secs_f64())].into(),
        }
    }

    /// The options of an experiment on specimens, as a record states them.
    pub(crate) fn setup(&self, specimens: &[Specimen<'_>]) -> serde_json::Value {
        let config = &self.config;
        serde_json::json!({
            "shapes": specimens.iter().map(Specimen::name).collect::<Vec<_>>(),
            "samples": config.samples,
            "rank": config.rank,
            "runs": config.runs,
            "eigenvectors": config.eigenvectors,
            "counts": config.counts,
            "exponents": config.exponents,
            "distances": format!("{:?}", Distances::default().method),
        })
    }

    /// What the results show, as the configuration says.
    pub(crate) fn analysis(&self) -> String {
        self.config.analysis.trim().to_owned()
    }

    /// A number printed in the paper, if the collection is that of the paper.
    pub(crate) fn printed(&self, row: &str, method: &str) -> Option<f64> {
        self.config.printed(row, method).filter(|_| self.collection.setting() == Setting::Paper)
    }

    /// Writes a record and its figures, and prints its summary.
    pub(crate) fn publish(&self, record: &impl Record) -> Result<()> {
        save(record, self.folder, self.name)?;
        self.bars.finish();
        if let Some(summary) = record.summary() {
            writeln!(std::io::stdout().lock(), "{}", summary.to_text())?;
        }
        Ok(())
    }

    /// The curves of all methods over the configured counts, from runs that differ in the first sample. `run` returns
    /// the values of one run as `[method][count]`.
    pub(crate) fn sweep(
        &self,
        specimen: &Specimen<'_>,
        methods: &[&str],
        run: impl Fn(VertexId) -> Result<Vec<Vec<f64>>>,
    ) -> Result<Vec<Series>> {
        let mut runs: Vec<Vec<Vec<f64>>> = vec![Vec::new(); methods.len()];
        for first in specimen.first_samples(self.config.runs, self.seed) {
            runs.iter_mut().zip(run(first)?).for_each(|(all, one)| all.push(one));
            self.observer.step();
        }
        let places = places(&self.config.counts);
        Ok(methods.iter().zip(&runs).map(|(name, runs)| series(name, &places, runs)).collect())
    }

    /// Publishes a record of curves.
    pub(crate) fn publish_curves(
        &self,
        specimens: &[Specimen<'_>],
        caption: String,
        panels: Vec<CurvesPanel>,
        measured: &Measured,
    ) -> Result<()> {
        self.publish(&CurvesRecord {
            expectations: self.check(|name| measured.get(name).copied())?,
            analysis: self.analysis(),
            provenance: self.provenance(self.setup(specimens)),
            caption,
            panels,
        })
    }
}

/// The options of embeddings by name, as a record states them.
pub(crate) fn described(options: &[(&str, &FormOptions)], stress: StressChoice) -> serde_json::Value {
    let of_embedding = |options: &FormOptions| {
        serde_json::json!({
            "method": format!("{:?}", options.method),
            "geodesic": format!("{:?}", options.geodesic),
            "samples": format!("{:?}", options.samples),
            "first_sample": format!("{:?}", options.first_sample),
            "dim": options.dim,
            "stress": format!("{stress:?}"),
        })
    };
    options.iter().map(|(name, options)| ((*name).to_owned(), of_embedding(options))).collect()
}
