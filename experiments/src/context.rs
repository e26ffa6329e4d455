//! What every experiment gets, and what it does with its results.

use std::fmt::Display;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use anyhow::{Result, anyhow};
use base::terminal::Bars;
use canonform::{DescribeOptions, Observer};
use geodesics::Sampling;
use linalg::LandmarkDistances;
use report::results::{
    CurvesPanel, CurvesResults, Expectation, Published, Record, RecordedTable, RunProvenance, Series,
};
use report::{Results, save};
use serde_json::{Map, Value};

use crate::collection::{Setting, SurfaceCollection};
use crate::config::{Config, Printed};
use crate::machine;
use crate::prose::filled;
use crate::specimen::{Distances, Specimen};
use crate::sweep::{MeasuredNumbers, curves, note, places};

/// What every experiment gets.
pub(crate) struct Context<'a> {
    /// Name of the experiment, and of its files.
    pub(crate) name: &'static str,
    pub(crate) config: Config,
    pub(crate) collection: &'a SurfaceCollection,
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
    /// How a record was made, up to now: with the configuration, and with these descriptions or forms by name.
    pub(crate) fn provenance(&self, made: &[(&str, &DescribeOptions)]) -> RunProvenance {
        let mut options: Map<String, Value> = self
            .config
            .options
            .iter()
            .map(|(name, value)| (name.clone(), serde_json::to_value(value).unwrap_or_default()))
            .collect();
        options.extend(made.iter().map(|(name, made)| ((*name).to_owned(), made.text().into())));
        RunProvenance {
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
            options: options.into(),
            seconds: [("run".to_owned(), self.start.elapsed().as_secs_f64())].into(),
        }
    }

    /// How a record on the specimens was made.
    pub(crate) fn of_specimens(&self) -> RunProvenance {
        let mut provenance = self.provenance(&[]);
        provenance.options["shapes"] = self.specimens.iter().map(Specimen::name).collect();
        provenance
    }

    /// A number printed in the paper, if the collection is that of the paper.
    pub(crate) fn printed(&self, printed: &Printed, row: &str, method: &str) -> Option<f64> {
        let number = printed.get(row)?.get(method).copied();
        number.filter(|_| self.collection.setting() == Setting::Paper)
    }

    /// Compares the results with the configured expectations, writes their record and figures, and prints the
    /// expectations that failed and the summary.
    pub(crate) fn publish(
        &self,
        results: impl Results,
        provenance: RunProvenance,
        measured: &MeasuredNumbers,
    ) -> Result<()> {
        let setting = self.collection.setting();
        let expectations = self.config.findings.check(setting, measured)?;
        self.bars.finish();
        for Expectation { what, expected, measured, goal, .. } in expectations.iter().filter(|e| !e.held) {
            let kind = if *goal { "goal missed" } else { "not as expected" };
            eprintln!("{kind}: {what} is {measured}, {expected}");
        }
        let shapes: Vec<&str> = self.specimens.iter().map(Specimen::label).collect();
        let analysis = self.config.findings.analysis(setting, &self.known(measured), &shapes)?;
        let measured = measured.iter().filter(|(_, value)| value.is_finite());
        let measured = measured.map(|(name, value)| (name.clone(), *value)).collect();
        let record = Record { provenance, results, measured, expectations, analysis };
        save(&record, self.folder, self.name)?;
        if let Some(summary) = record.results.summary() {
            writeln!(std::io::stdout().lock(), "{}", summary.to_text())?;
        }
        Ok(())
    }

    /// The numbers that texts may use: what was measured, options, sizes.
    fn known(&self, measured: &MeasuredNumbers) -> MeasuredNumbers {
        let n = self.collection.shapes.len();
        let queries = self.config.options.get("queries").and_then(toml::Value::as_integer);
        let queried = queries.map_or(0, |n| self.collection.first_of_each_class(n as usize).len());
        let sizes = [
            ("shapes", n),
            ("others", n.saturating_sub(1)),
            ("classes", self.collection.classes.len()),
            ("queried", queried),
            ("threads", rayon::current_num_threads()),
        ];
        let own = self.config.counts().chain(sizes.map(|(name, n)| (name, n as f64)));
        let mut known = measured.clone();
        known.extend(own.map(|(name, value)| (name.to_owned(), value)));
        known
    }

    /// The curves of all methods over the counts n, from runs that differ in the first sample.
    ///
    /// `farthest` returns the values of all methods but the last two for n farthest samples. These are `half` of the
    /// columns of hop counts, and of samples of least variance.
    pub(crate) fn sweep(
        &self,
        specimen: &Specimen<'_>,
        (n_runs, counts): (usize, &[usize]),
        methods: &[&str],
        farthest: impl Fn(&LandmarkDistances) -> Result<Vec<f64>>,
        half: impl Fn(&LandmarkDistances) -> Result<f64>,
    ) -> Result<Vec<Series>> {
        let mut runs: Vec<Vec<Vec<f64>>> = vec![Vec::new(); methods.len()];
        for first in specimen.first_samples(n_runs, self.seed) {
            let nested = |distances, sampling| specimen.nested(&distances, sampling, first, counts);
            let samples = nested(Distances::default(), Sampling::Farthest)?;
            let hops = nested(Distances::hops(), Sampling::Farthest)?;
            let least = nested(Distances::default(), Sampling::MinVariance)?;
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

    /// Publishes curves under the configured caption.
    pub(crate) fn publish_curves(
        &self,
        panels: Vec<CurvesPanel>,
        provenance: RunProvenance,
        measured: &MeasuredNumbers,
    ) -> Result<()> {
        self.publish_with_tables(panels, Vec::new(), provenance, measured)
    }

    /// Publishes curves under the configured caption, with tables of their own.
    pub(crate) fn publish_with_tables(
        &self,
        panels: Vec<CurvesPanel>,
        tables: Vec<RecordedTable>,
        provenance: RunProvenance,
        measured: &MeasuredNumbers,
    ) -> Result<()> {
        let number = |name: &str| self.known(measured).get(name).copied();
        let caption = filled(&self.config.findings.caption, number);
        let caption = caption.map_err(|name| anyhow!("the caption: nothing measures `{name}`"))?;
        self.publish(CurvesResults { caption, panels, tables }, provenance, measured)
    }

    /// Publishes a panel for every specimen, and its numbers after the class; each panel is `steps` of progress.
    pub(crate) fn publish_panels<N: Display>(
        &self,
        steps: usize,
        of: impl Fn(&Specimen<'_>) -> Result<(CurvesPanel, Vec<(N, f64)>)>,
    ) -> Result<()> {
        let (mut panels, mut measured) = (Vec::new(), MeasuredNumbers::new());
        self.observer.begin(self.name, self.specimens.len() * steps);
        for specimen in self.specimens {
            let (panel, numbers) = of(specimen)?;
            panels.push(panel);
            note(&mut measured, specimen.label(), numbers);
        }
        self.publish_curves(panels, self.of_specimens(), &measured)
    }
}
