//! Matching: dense maps between the shapes of a class: all pairs of seven or fewer, and each to the next one of more.
//!
//! The truth is known for built-in shapes, by the place of a vertex on the body at rest, and for meshes whose vertices are
//! numbered alike: these get triangles of their own, so that the same triangulation does not help. The error of a vertex is the
//! distance on the second surface between its image and its true partner, as a share of the square root of the area.
//!
//! All built-in classes are joined by `person`, people whose limbs touch, and `bodies`, people of different bodies; all classes
//! together are `all`. Measures, each after the name of a group:
//! * `pairs`; `direct` and `mirrored`, the mean errors; `median`, of direct maps; `direct 5`, the share of vertices with an
//!   error below five hundredths;
//! * `failed`, the share of pairs without a direct map whose mean error is below a tenth, and `failures`, their number;
//! * `doubted`, the share of wrong maps, of a mean error beyond .05, that were called uncertain, and `doubted in vain`, of the
//!   others;
//! * `flipped`, the share of pairs whose mirrored map has the lesser distortion; `distortion`, of the better map; `seconds`;
//!
//! Also `preparation seconds`.

mod errors;
mod shapes;

use anyhow::{Context as _, Result};
use canonform::maps::{CorrespondOptions, MappedSurface};
use report::Record;
use report::record::{Axis, Mark, Plot};

use self::errors::{JudgedMap, MappedPair};
use self::shapes::{MapGroup, PreparedShape, pairs};
use crate::context::Context;
use crate::sweep::{MeasuredNumbers, curve, mean, median, note, plot, plots, point, share};

/// Errors of the horizontal axis.
const STEPS: usize = 50;
const MOST: f64 = 0.25;

/// The name of all groups together.
const ALL: &str = "all";

/// Published means on 343 pairs of people of FAUST and SCAPE, remeshed each on its own to 5,000 vertices, by methods without
/// learning (`melzi2019` in `REFERENCES.bib`); no curve is at hand as numbers.
const PUBLISHED: [(&str, f64); 2] = [("ZoomOut, mean", 0.0217), ("PMF, mean", 0.086)];

/// The name of a group, and its pairs.
type MappedGroup<'a> = (&'a str, Vec<MappedPair>);

pub(crate) fn matching(context: &Context<'_>) -> Result<Record> {
    let options = CorrespondOptions::default();
    let mut measured = MeasuredNumbers::new();
    let (mut found, mut preparation) = (Vec::new(), Vec::new());
    // One after the other, so that times are those of a machine at rest.
    let groups = MapGroup::all(context.collection, context.seed)?;
    for group in &groups {
        let pairs = pairs(group.shapes.len());
        context.observer.begin("preparing", group.shapes.len());
        let mut prepared: Vec<PreparedShape<'_>> = Vec::new();
        for shape in &group.shapes {
            let mapped = MappedSurface::new(&*shape.surface, &options, &());
            prepared.push((shape, mapped.with_context(|| shape.name.clone())?));
            context.observer.step();
        }
        preparation.extend(prepared.iter().map(|(_, mapped)| mapped.seconds));
        context.observer.begin("matching", pairs.len());
        let mut mapped = Vec::new();
        for pair in pairs.into_iter().map(|pair| pair.map(|i| &prepared[i])) {
            let names = pair.map(|(shape, _)| shape.name.as_str()).join(" to ");
            mapped.push(MappedPair::new(pair, &options).context(names)?);
            context.observer.step();
        }
        found.push((group.name.as_str(), mapped));
    }
    measured.insert("preparation seconds".to_owned(), mean(preparation));
    for (name, pairs) in &found {
        measure(name, &pairs.iter().collect::<Vec<_>>(), &mut measured);
    }
    let all: Vec<&MappedPair> = found.iter().flat_map(|(_, pairs)| pairs).collect();
    measure(ALL, &all, &mut measured);
    let mut record = context.record(&[], measured);
    let eigenfunctions = options.maps.eigenfunctions.into();
    record.provenance.options.insert("eigenfunctions".to_owned(), eigenfunctions);
    // Errors are known only where points correspond by their numbers.
    record.figures.extend(
        Some(panels(&found)).filter(|panels| !panels.is_empty()).map(|panels| plots("curves", panels)),
    );
    Ok(record)
}

/// The errors of one kind of map over some pairs.
fn errors(pairs: &[&MappedPair], of: impl Fn(&MappedPair) -> Option<&JudgedMap>) -> Vec<f64> {
    pairs.iter().filter_map(|pair| of(pair)).flat_map(|map| map.errors.iter().copied()).collect()
}

/// Adds the figures of some pairs.
fn measure(group: &str, pairs: &[&MappedPair], measured: &mut MeasuredNumbers) {
    let mut add = |what: &str, value: f64| note(measured, group, [(what, value)]);
    let direct = errors(pairs, |pair| pair.direct.as_ref());
    let known: Vec<&&MappedPair> = pairs.iter().filter(|pair| pair.is_known).collect();
    add("pairs", pairs.len() as f64);
    if !known.is_empty() {
        add("direct", mean(direct.iter().copied()));
        add("mirrored", mean(errors(pairs, |pair| pair.mirrored.as_ref())));
        add("median", median(&direct).1);
        add("direct 5", share(&direct, |error| *error < 0.05));
        add("failed", share(&known, |pair| pair.has_failed()));
        add("failures", known.iter().filter(|pair| pair.has_failed()).count() as f64);
        let (wrong, right): (Vec<&JudgedMap>, Vec<&JudgedMap>) =
            known.iter().flat_map(|pair| pair.judged()).partition(|map| map.is_wrong());
        for (what, maps) in [("doubted", wrong), ("doubted in vain", right)] {
            if !maps.is_empty() {
                add(what, share(&maps, |map| !map.is_certain));
            }
        }
    }
    let distortions: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.distortions()).collect();
    add("flipped", share(&distortions, |[direct, mirrored]| mirrored < direct));
    add("distortion", mean(distortions.iter().map(|[direct, mirrored]| direct.min(*mirrored))));
    add("seconds", mean(pairs.iter().map(|pair| pair.seconds)));
}

/// Cumulative errors, a panel for each kind that was measured.
fn panels(groups: &[MappedGroup<'_>]) -> Vec<Plot> {
    type Of = fn(&MappedPair) -> Option<&JudgedMap>;
    let kinds: [(&str, Of); 2] =
        [("direct map", |pair| pair.direct.as_ref()), ("mirrored map", |pair| pair.mirrored.as_ref())];
    let mut panels = Vec::new();
    for (title, of) in kinds {
        let mut curves = Vec::new();
        for (name, pairs) in groups {
            let errors = pairs.iter().filter_map(of).map(|map| &map.errors);
            let runs: Vec<&Vec<f64>> = errors.filter(|errors| !errors.is_empty()).collect();
            if runs.is_empty() {
                continue;
            }
            let at = |step: usize| {
                let limit = MOST * step as f64 / STEPS as f64;
                let below = |errors: &&Vec<f64>| share(errors, |error| *error <= limit);
                point(limit, &runs.iter().map(below).collect::<Vec<_>>())
            };
            curves.push(curve(name, (0..=STEPS).map(at).collect()));
        }
        if !curves.is_empty() {
            let [x, y] = ["error / sqrt(area)", "share of vertices"].map(Axis::linear);
            let mut panel = plot(title, x, y, curves);
            if title == "direct map" {
                let mark = |(name, x): (&str, f64)| Mark { x, name: name.to_owned() };
                panel.marks = PUBLISHED.map(mark).into();
            }
            panels.push(panel);
        }
    }
    panels
}
