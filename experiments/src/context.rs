//! What every experiment gets, and what it does with its results.

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use anyhow::Result;
use canonform::{FormOptions, Observer, StressChoice};
use geodesics::{Sampling, Variance};
use linalg::LandmarkDistances;
use report::results::{CurvesPanel, CurvesResults, Expectation, Provenance, Published, Record, Series};
use report::{Results, save};
use terminal::Bars;

use crate::collection::{Collection, Setting};
use crate::config::Config;
use crate::machine;
use crate::specimen::{Distances, Specimen};
use crate::sweep::{Measured, curves, places};

/// What every experiment gets.
pub(crate) struct Context<'a> {
    /// Name of the experiment, and of its files.
    pub(crate) name: &'static str,
    pub(crate) config: Config,
    pub(crate) collection: &'a Collection,
    /// A few of its shapes, with values that several experiments share, such as the distances of all pairs of vertices.
    pub(crate) specimens: &'a [Specimen<'a>],
    pub(crate) seed: u64,
    pub(crate) folder: &'a Path,
    /// Published scores to stand beside those measured.
    pub(crate) published: Option<&'a Published>,
    /// The command line that repeats the run.
    pub(crate) command: String,
    /// Its options, each after a space.
    pub(crate) arguments: String,
    pub(crate) observer: &'a dyn Observer,
    pub(crate) bars: &'a Bars,
    pub(crate) start: Instant,
}

impl Context<'_> {
    /// How a record was made, up to now.
    pub(crate) fn provenance(&self, options: serde_json::Value) -> Provenance {
        Provenance {
            program: "canonform experiments".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: env!("CANONFORM_COMMIT").to_owned(),
            date: machine::now(),
            machine: machine::described(),
            command: self.command.clone(),
            arguments: self.arguments.clone(),
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

    /// A number printed in the paper, if the collection is that of the paper.
    pub(crate) fn printed(&self, row: &str, method: &str) -> Option<f64> {
        self.config.printed(row, method).filter(|_| self.collection.setting() == Setting::Paper)
    }

    /// Compares the results with the configured expectations, writes their record and figures, and prints the
    /// expectations that failed and the summary.
    pub(crate) fn publish(
        &self,
        results: impl Results,
        provenance: Provenance,
        measured: &Measured,
    ) -> Result<()> {
        let setting = self.collection.setting();
        let expectations = self.config.check(setting, measured)?;
        self.bars.finish();
        for Expectation { what, expected, measured, goal, .. } in expectations.iter().filter(|e| !e.held) {
            let kind = if *goal { "goal missed" } else { "not as expected" };
            eprintln!("{kind}: {what} is {measured}, {expected}");
        }
        let shapes: Vec<&str> = self.specimens.iter().map(Specimen::label).collect();
        let analysis = self.config.analysis(setting, &self.known(measured), &shapes)?;
        let measured = measured.iter().filter(|(_, value)| value.is_finite());
        let measured = measured.map(|(name, value)| (name.clone(), *value)).collect();
        let record = Record { provenance, results, measured, expectations, analysis };
        save(&record, self.folder, self.name)?;
        if let Some(summary) = record.results.summary() {
            writeln!(std::io::stdout().lock(), "{}", summary.to_text())?;
        }
        Ok(())
    }

    /// The numbers that texts may use: what was measured, options, the size of the collection.
    fn known(&self, measured: &Measured) -> Measured {
        let Config { samples, rank, runs, eigenvectors, knn, .. } = self.config;
        let own = [
            ("samples", samples),
            ("rank", rank),
            ("runs", runs),
            ("eigenvectors", eigenvectors),
            ("voters", knn),
            ("shapes", self.collection.shapes.len()),
            ("classes", self.collection.classes.len()),
        ];
        let mut known = measured.clone();
        known.extend(own.map(|(name, value)| (name.to_owned(), value as f64)));
        known
    }

    /// The curves of all methods over the configured counts n, from runs that differ in the first sample.
    ///
    /// `farthest` returns the values of all methods but the last two for n farthest samples. These are `half` of the
    /// columns of hop counts, and of samples of least variance.
    pub(crate) fn sweep(
        &self,
        specimen: &Specimen<'_>,
        methods: &[&str],
        farthest: impl Fn(&LandmarkDistances) -> Result<Vec<f64>>,
        half: impl Fn(&LandmarkDistances) -> Result<f64>,
    ) -> Result<Vec<Series>> {
        let counts = &self.config.counts;
        let mut runs: Vec<Vec<Vec<f64>>> = vec![Vec::new(); methods.len()];
        for first in specimen.first_samples(self.config.runs, self.seed) {
            let nested = |distances, sampling| specimen.nested(&distances, sampling, first, counts);
            let samples = nested(Distances::default(), Sampling::Farthest)?;
            let hops = nested(Distances::hops(), Sampling::Farthest)?;
            let least = nested(Distances::default(), Sampling::Incremental(Variance::Least))?;
            runs.iter_mut().for_each(|runs| runs.push(Vec::new()));
            for ((samples, hops), least) in samples.iter().zip(&hops).zip(&least) {
                let values = farthest(samples)?.into_iter().chain([half(hops)?, half(least)?]);
                let run = runs.iter_mut().filter_map(|runs| runs.last_mut());
                run.zip(values).for_each(|(run, value)| run.push(value));
            }
            self.observer.step();
        }
        Ok(curves(methods, &places(counts), &runs))
    }

    pub(crate) fn publish_curves(
        &self,
        caption: String,
        panels: Vec<CurvesPanel>,
        measured: &Measured,
    ) -> Result<()> {
        let provenance = self.provenance(self.setup(self.specimens));
        self.publish(CurvesResults { caption, panels }, provenance, measured)
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
