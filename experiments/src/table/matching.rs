//! Matching: dense maps from each shape to the next one of its class, and between all shapes of a class of seven or fewer.
//!
//! The truth is known for built-in shapes, by the place of a vertex on the body at rest, and for meshes with the same faces, by
//! the number of the vertex: these get triangles of their own, so that the same triangulation does not help. The error of a vertex is the distance on the second surface between its image and its true
//! partner, as a share of the square root of the area. Without a truth, the distance from a vertex to its image under the map
//! there and the map back takes its place.
//!
//! Measures `CLASS direct|mirrored` (mean error), `CLASS direct 5|10|25` (share of vertices with an error below so many
//! hundredths), `CLASS failed` (share of pairs without a direct map whose mean error is below a tenth), `CLASS doubted` (share
//! of the failed ones that were called uncertain) and `CLASS doubted in vain` (of the others), `CLASS flipped` (share of pairs whose mirrored map has the lesser distortion), `CLASS distortion`, `CLASS return`, `CLASS seconds`, and `preparation
//! seconds`; `all ...` over all pairs, and `worst direct`, the largest mean error of a class.

use std::borrow::Cow;

use anyhow::{Context as _, Result};
use canonform::relations::MapKind;
use canonform::{CorrespondOptions, Correspondence, MappedSurface, Surface, VertexMap, correspond};
use datasets::{ArticulatedOptions, Damage, Family, articulated_at_rest};
use descriptors::NearestPoints;
use geodesics::Method;
use nalgebra::Point3;
use rayon::prelude::*;
use report::results::{CurvesPanel, Series};
use serde::Deserialize;
use surface::VertexId;

use crate::collection::{LabeledSurface, Setting};
use crate::context::Context;
use crate::experiment::Experiment;
use crate::sweep::{MeasuredNumbers, linear, mean, note, panel, point, share};

/// Vertices of a pair whose errors are measured.
const CHECKED: usize = 300;

/// MapErrors of the horizontal axis.
const STEPS: usize = 50;
const MOST: f64 = 0.25;

/// Vertices of shapes that get triangles of their own, as in published comparisons.
const REMESHED: usize = 5000;

/// All pairs of classes of so many shapes are mapped.
const FEW: usize = 7;

/// The name of all classes together.
const ALL: &str = "all";

/// A shape with what is known of its vertices.
struct Posed<'a> {
    shape: &'a LabeledSurface,
    matched: MappedSurface<Cow<'a, Surface>>,
    /// Vertices on the body at rest, which is its own mirror image at `x = 0` if it is built in, or on the first shape of the
    /// class.
    at_rest: Option<NearestPoints>,
    is_built_in: bool,
}

/// The errors of one kind of map of a pair.
#[derive(Clone, Default)]
struct MapErrors {
    direct: Vec<f64>,
    mirrored: Vec<f64>,
    /// From a vertex to its image under the better map there and the better map back of the same kind.
    there_and_back: Vec<f64>,
}

struct MappedPair {
    class: String,
    errors: MapErrors,
    is_flipped: bool,
    /// Whether the direct map was called certain.
    is_certain: bool,
    distortion: f64,
    seconds: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MatchingOptions {}

impl Experiment for MatchingOptions {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let options = CorrespondOptions::default();
        let all = context.collection.all();
        let is_built_in = context.collection.setting() == Setting::BuiltIn;
        // One after the other, so that times are those of a machine at rest.
        context.observer.begin("preparing", all.len());
        let mut known = Vec::new();
        for (i, shape) in all.iter().enumerate() {
            let first =
                all.iter().find(|first| first.label == shape.label).context("a shape of the class")?;
            let (surface, at_rest) = match is_built_in {
                true => (Cow::Borrowed(&shape.surface), Some(at_rest(context, shape)?)),
                false => remeshed(shape, first, i as u64)?
                    .map_or((Cow::Borrowed(&shape.surface), None), |(surface, at)| {
                        (Cow::Owned(surface), Some(at))
                    }),
            };
            let matched = MappedSurface::new(surface, &options, &()).with_context(|| shape.name.clone())?;
            known.push(Posed { shape, matched, at_rest, is_built_in });
            context.observer.step();
        }
        let mut pairs: Vec<[&Posed<'_>; 2]> = Vec::new();
        for (i, a) in known.iter().enumerate() {
            let (earlier, later) = (&known[..i], &known[i + 1..]);
            let is_alike = |b: &&Posed<'_>| b.shape.label == a.shape.label;
            let few = later.iter().chain(earlier).filter(is_alike).count() < FEW;
            let partners: Vec<_> = match few {
                true => later.iter().filter(is_alike).collect(),
                false => later.iter().chain(earlier).find(is_alike).into_iter().collect(),
            };
            pairs.extend(partners.into_iter().map(|b| [a, b]));
        }
        context.observer.begin("matching", pairs.len());
        let mut found = Vec::new();
        for [a, b] in pairs {
            found
                .push(pair(a, b, &options).with_context(|| format!("{} to {}", a.shape.name, b.shape.name))?);
            context.observer.step();
        }
        let mut measured = MeasuredNumbers::new();
        let preparation: f64 = known.iter().map(|known| known.matched.seconds).sum();
        measured.insert("preparation seconds".to_owned(), preparation / known.len().max(1) as f64);
        let mut worst = f64::NEG_INFINITY;
        for class in &context.collection.classes {
            let of_class: Vec<&MappedPair> = found.iter().filter(|pair| pair.class == *class).collect();
            worst = worst.max(measure(class, &of_class, &mut measured));
        }
        measure(ALL, &found.iter().collect::<Vec<_>>(), &mut measured);
        measured.insert("worst direct".to_owned(), worst);
        let panels = panels(&context.collection.classes, &found);
        let mut provenance = context.provenance(&[]);
        provenance.options["matching"] = serde_json::to_value(options.mapping)?;
        provenance.options["spread"] = options.spread.into();
        context.publish_curves(panels, provenance, &measured)
    }
}

/// A shape with triangles of its own, and its vertices on the first shape of its class; `None` unless both have the same faces.
fn remeshed(
    shape: &LabeledSurface,
    first: &LabeledSurface,
    seed: u64,
) -> Result<Option<(Surface, NearestPoints)>> {
    let [mesh, rest] = [shape, first].map(|shape| shape.surface.mesh());
    if mesh.faces != rest.faces {
        return Ok(None);
    }
    let share = REMESHED as f64 / mesh.n_vertices() as f64;
    let own = Damage::Sample(share.min(1.0)).apply(mesh, seed);
    let surface = Surface::new(&own, &Default::default(), &())?;
    let originals = NearestPoints::new(mesh.positions.clone())?;
    let at = |p: &Point3<f64>| rest.positions[originals.nearest(p).0];
    let at_rest = surface.mesh().positions.iter().map(at).collect();
    Ok(Some((surface, NearestPoints::new(at_rest)?)))
}

/// The vertices of a built-in shape on the body at rest.
fn at_rest(context: &Context<'_>, shape: &LabeledSurface) -> Result<NearestPoints> {
    let family = Family::all().into_iter().find(|family| family.name() == shape.label);
    let family = family.context("a built-in family")?;
    let pose = shape.name.strip_prefix(family.name()).and_then(|pose| pose.parse().ok()).context("a pose")?;
    let n_vertices = shape.surface.mesh().n_vertices();
    let options = ArticulatedOptions { seed: context.seed, n_vertices };
    let rested = articulated_at_rest(family, 0, pose, &options)?;
    anyhow::ensure!(rested.shape.mesh == *shape.surface.mesh(), "the shape is generated again");
    Ok(NearestPoints::new(rested.rest.positions)?)
}

fn pair(a: &Posed<'_>, b: &Posed<'_>, options: &CorrespondOptions) -> Result<MappedPair> {
    let forth = correspond(&a.matched, &b.matched, options, &())?;
    let back = correspond(&b.matched, &a.matched, options, &())?;
    let best = forth.maps.first().context("a map")?;
    Ok(MappedPair {
        class: a.shape.label.clone(),
        errors: errors(a, b, &forth, &back)?,
        is_flipped: of_kind(&forth, MapKind::Mirrored).is_some_and(|mirrored| {
            of_kind(&forth, MapKind::Direct).is_none_or(|direct| mirrored.distortion < direct.distortion)
        }),
        is_certain: of_kind(&forth, MapKind::Direct).is_some_and(VertexMap::is_certain),
        distortion: best.distortion,
        seconds: forth.seconds,
    })
}

fn of_kind(found: &Correspondence, kind: MapKind) -> Option<&VertexMap> {
    found.maps.iter().find(|map| map.kind == kind)
}

/// The true partner of a vertex, directly or mirrored; `None` if it is not known.
fn partner(a: &Posed<'_>, b: &Posed<'_>, x: usize, kind: MapKind) -> Option<usize> {
    let (from, to) = (a.at_rest.as_ref()?, b.at_rest.as_ref()?);
    if kind == MapKind::Mirrored && !a.is_built_in {
        return None;
    }
    let p = from.points()[x];
    let sign = if kind == MapKind::Mirrored { -1.0 } else { 1.0 };
    Some(to.nearest(&Point3::new(sign * p.x, p.y, p.z)).0)
}

fn errors(a: &Posed<'_>, b: &Posed<'_>, forth: &Correspondence, back: &Correspondence) -> Result<MapErrors> {
    let [on_a, on_b] = [a, b].map(|side| Method::default().prepare(side.matched.surface().intrinsic(), &()));
    let [on_a, on_b] = [on_a?, on_b?];
    let [size_a, size_b] = [a, b].map(|side| side.matched.surface().mesh().area().sqrt());
    let n = a.matched.surface().mesh().n_vertices();
    let checked: Vec<usize> = (0..n).step_by(n.div_ceil(CHECKED).max(1)).collect();
    let error = |x: usize, kind: MapKind| -> Result<Option<f64>> {
        let Some(map) = of_kind(forth, kind) else { return Ok(None) };
        let (Some(truth), Some(image)) = (partner(a, b, x, kind), map.vertices[x]) else { return Ok(None) };
        Ok(Some(on_b.distances(VertexId::from(truth))?[image.index()] / size_b))
    };
    let all = |kind| -> Result<Vec<f64>> {
        let found = checked.par_iter().map(|x| error(*x, kind)).collect::<Result<Vec<_>>>()?;
        Ok(found.into_iter().flatten().collect())
    };
    let mut there_and_back = Vec::new();
    if let Some(map) = forth.maps.first()
        && let Some(inverse) = of_kind(back, map.kind)
    {
        let gap = |x: &usize| -> Result<Option<f64>> {
            let home = map.vertices[*x].and_then(|y| inverse.vertices[y.index()]);
            let Some(home) = home else { return Ok(None) };
            Ok(Some(on_a.distances(VertexId::from(*x))?[home.index()] / size_a))
        };
        let gaps = checked.par_iter().map(gap).collect::<Result<Vec<_>>>()?;
        there_and_back = gaps.into_iter().flatten().collect();
    }
    Ok(MapErrors { direct: all(MapKind::Direct)?, mirrored: all(MapKind::Mirrored)?, there_and_back })
}

/// Adds the figures of some pairs, and returns the mean error of the direct map.
fn measure(class: &str, pairs: &[&MappedPair], measured: &mut MeasuredNumbers) -> f64 {
    let mut add = |what: &str, value: f64| note(measured, class, [(what, value)]);
    let over = |of: &dyn Fn(&MapErrors) -> &Vec<f64>| -> Vec<f64> {
        pairs.iter().flat_map(|pair| of(&pair.errors).iter().copied()).collect()
    };
    let direct = over(&|errors| &errors.direct);
    if !direct.is_empty() {
        add("direct", mean(direct.iter().copied()));
        add("mirrored", mean(over(&|errors| &errors.mirrored)));
        for (name, limit) in [("direct 5", 0.05), ("direct 10", 0.1), ("direct 25", 0.25)] {
            add(name, share(&direct, |error| *error < limit));
        }
        let failed = |pair: &&MappedPair| {
            let error = mean(pair.errors.direct.iter().copied());
            error.is_nan() || error > 0.1
        };
        add("failed", share(pairs, failed));
        let (wrong, right): (Vec<&MappedPair>, Vec<&MappedPair>) =
            pairs.iter().partition(|pair| failed(pair));
        let doubted = |pairs: &[&MappedPair]| {
            if pairs.is_empty() { 0.0 } else { share(pairs, |pair| !pair.is_certain) }
        };
        if !wrong.is_empty() {
            add("doubted", doubted(&wrong));
        }
        add("doubted in vain", doubted(&right));
    }
    add("flipped", share(pairs, |pair| pair.is_flipped));
    add("distortion", mean(pairs.iter().map(|pair| pair.distortion)));
    add("return", mean(over(&|errors| &errors.there_and_back)));
    add("seconds", mean(pairs.iter().map(|pair| pair.seconds)));
    mean(direct)
}

/// Cumulative errors, a panel for each kind that was measured.
fn panels(classes: &[String], pairs: &[MappedPair]) -> Vec<CurvesPanel> {
    type Of = fn(&MapErrors) -> &Vec<f64>;
    let kinds: [(&str, Of); 3] = [
        ("direct map", |errors| &errors.direct),
        ("mirrored map", |errors| &errors.mirrored),
        ("there and back", |errors| &errors.there_and_back),
    ];
    let mut panels = Vec::new();
    for (title, of) in kinds {
        let mut curves = Vec::new();
        for class in classes {
            let runs: Vec<&Vec<f64>> = pairs
                .iter()
                .filter(|pair| pair.class == *class)
                .map(|pair| of(&pair.errors))
                .filter(|errors| !errors.is_empty())
                .collect();
            if runs.is_empty() {
                continue;
            }
            let at = |step: usize| {
                let limit = MOST * step as f64 / STEPS as f64;
                let below = |errors: &&Vec<f64>| share(errors, |error| *error <= limit);
                point(limit, &runs.iter().map(below).collect::<Vec<_>>())
            };
            curves.push(Series { name: class.clone(), points: (0..=STEPS).map(at).collect() });
        }
        if !curves.is_empty() {
            panels.push(panel(title, linear("error / sqrt(area)"), linear("share of vertices"), curves));
        }
    }
    panels
}
