//! What every experiment gets, and how its record is completed.

use std::fmt::Display;
use std::time::Instant;

use anyhow::{Result, anyhow};
use canonform::{DescribeOptions, Observer};
use geodesics::{Method, Sampling};
use linalg::LandmarkDistances;
use report::Record;
use report::record::{Plot, RunProvenance, Series};

use crate::args::command;
use crate::collection::{Setting, SurfaceCollection};
use crate::config::{Config, Options};
use crate::machine;
use crate::specimen::Specimen;
use crate::sweep::{MeasuredNumbers, curves, note, places, plots};
use crate::text::filled;

/// How a page of built-in shapes begins.
const GENERATED: &str = "The shapes on this page are generated; its figures are those of the paper by Shamai, Zibulevsky and Kimmel (3DOR 2015). ";

/// What every experiment gets.
pub(crate) struct Context<'a> {
    pub(crate) config: Config,
    pub(crate) options: Options,
    pub(crate) collection: &'a SurfaceCollection,
    /// A few of its shapes, with values that several experiments share, such as the distances of all pairs of vertices.
    pub(crate) specimens: &'a [Specimen<'a>],
    pub(crate) seed: u64,
    pub(crate) observer: &'a dyn Observer,
    pub(crate) start: Instant,
}

impl Context<'_> {
    /// A number printed in the paper, if the collection is that of the paper.
    pub(crate) fn printed(&self, row: &str, method: &str) -> Option<f64> {
        let number = self.options.printed.get(row)?.get(method).copied();
        number.filter(|_| self.collection.setting() == Setting::Paper)
    }

    /// A record of numbers, made with these descriptions or forms by name.
    pub(crate) fn record(&self, made: &[(&str, &DescribeOptions)], measured: MeasuredNumbers) -> Record {
        let mut record = Record { measured, ..Record::default() };
        record.provenance.options =
            made.iter().map(|(name, made)| ((*name).to_owned(), made.text().into())).collect();
        record
    }

    /// The record with its texts, with how it was made, up to now, and with what was expected.
    pub(crate) fn completed(&self, mut record: Record) -> Result<Record> {
        let Self { config, collection, .. } = self;
        record.measured.retain(|_, value| value.is_finite());
        let known = self.known(&record.measured);
        let text = |text: &str| filled(text, |name| known.get(name).copied());
        let captions = record.figures.iter_mut().map(|figure| &mut figure.caption);
        let captions = captions.chain(record.tables.iter_mut().map(|table| &mut table.caption));
        for caption in captions.filter(|caption| caption.is_empty()) {
            *caption =
                text(&config.caption).map_err(|name| anyhow!("nothing measures `{name}` of a caption"))?;
        }
        let generated = if collection.dataset.starts_with("built-in") { GENERATED } else { "" };
        record.lead = match text(&config.lead) {
            Ok(lead) if !lead.is_empty() => format!("{generated}{lead}"),
            _ => String::new(),
        };
        record.analysis = config.analysis(&known);
        record.expectations = config.check(collection.setting(), &record.measured)?;
        let mut options = record.provenance.options;
        for (name, value) in &config.options {
            options.insert(name.clone(), serde_json::to_value(value)?);
        }
        record.provenance = RunProvenance {
            program: "canonform experiments".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: env!("CANONFORM_COMMIT").to_owned(),
            date: machine::now(),
            machine: machine::described(),
            command: command(),
            dataset: collection.dataset.clone(),
            classes: collection.classes.clone(),
            seed: self.seed,
            options,
            seconds: self.start.elapsed().as_secs_f64(),
        };
        Ok(record)
    }

    /// The numbers that texts may use: what was measured, options, sizes.
    fn known(&self, measured: &MeasuredNumbers) -> MeasuredNumbers {
        let Self { collection, config, .. } = self;
        let n = collection.shapes.len();
        let sizes = [
            ("shapes", n),
            ("others", n.saturating_sub(1)),
            ("classes", collection.classes.len()),
            ("threads", rayon::current_num_threads()),
        ];
        let options = config.options.iter();
        let mut known = measured.clone();
        known.extend(options.filter_map(|(name, value)| Some((name.clone(), value.as_integer()? as f64))));
        known.extend(sizes.map(|(name, n)| (name.to_owned(), n as f64)));
        known
    }

    /// The curves of all methods over the counts n, from runs that differ in the first sample.
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
        let counts = &self.options.counts;
        let mut runs = Vec::new();
        for first in specimen.first_samples(self.options.runs, self.seed) {
            let nested = |distances, sampling| specimen.nested(distances, sampling, first, counts);
            let samples = nested(Method::default(), Sampling::Farthest)?;
            let hops = nested(Method::BreadthFirst, Sampling::Farthest)?;
            let least = nested(Method::default(), Sampling::MinVariance)?;
            let mut run = Vec::new();
            for ((samples, hops), least) in samples.iter().zip(&hops).zip(&least) {
                run.push([farthest(samples)?, vec![half(hops)?, half(least)?]].concat());
            }
            runs.push(run);
            self.observer.step();
        }
        Ok(curves(methods, &places(counts), &runs))
    }

    /// A plot for every specimen, and its numbers after the class; each is `steps` of progress.
    pub(crate) fn on_specimens<N: Display>(
        &self,
        steps: usize,
        of: impl Fn(&Specimen<'_>) -> Result<(Plot, Vec<(N, f64)>)>,
    ) -> Result<Record> {
        let (mut all, mut measured) = (Vec::new(), MeasuredNumbers::new());
        self.observer.begin("curves", self.specimens.len() * steps);
        for specimen in self.specimens {
            let (plot, numbers) = of(specimen)?;
            all.push(plot);
            note(&mut measured, &specimen.shape.label, numbers);
        }
        Ok(Record { figures: vec![plots("curves", all)], ..self.record(&[], measured) })
    }
}
