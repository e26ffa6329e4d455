//! Invariance: some shapes of every class are damaged in several ways, and searched for in the undamaged collection.
//!
//! Measures `least top1`, the lowest share over all damages of shapes whose nearest has their class, and `unknown`, the
//! largest share of unknown shapes over the damages that keep the surface; and `least told`, the lowest share of shapes whose
//! kind of match with the undamaged shape is right.

use anyhow::{Context as _, Result};
use canonform::{
    DescribeOptions, EvidenceKind, MatchEvidence, MeshGeometry, ShapeDescription, Surface, describe, rerank,
};
use datasets::Damage;
use descriptors::{FormDistance, Handedness, ShapeMetric, ShapePair, SignatureKind};
use report::results::{InvarianceResults, InvarianceRow, SignatureChange};
use retrieval::{Candidate, Labels};

use crate::collection::map;
use crate::context::Context;
use crate::sweep::Measured;

const DAMAGES: [Damage; 13] = [
    Damage::Subdivide(1),
    Damage::Subdivide(2),
    Damage::Decimate(0.5),
    Damage::Decimate(0.2),
    Damage::Remesh,
    Damage::Noise(0.001),
    Damage::Noise(0.002),
    Damage::Noise(0.005),
    Damage::Holes(0.01),
    Damage::Holes(0.03),
    Damage::Move,
    Damage::Scale,
    Damage::Mirror,
];

/// A damaged shape beside the undamaged collection.
struct Found {
    name: String,
    relative: Vec<f64>,
    units: Vec<f64>,
    form: f64,
    combined: f64,
    is_top1: bool,
    is_top1_of_others: bool,
    is_unknown: bool,
    /// Whether the kind of match with the undamaged shape is right; none if the damage has no kind of its own.
    is_told: Option<bool>,
}

/// What a damaged shape is beside the undamaged one.
fn kind_of(damage: Damage) -> Option<EvidenceKind> {
    match damage {
        Damage::Move => Some(EvidenceKind::IdenticalGeometry),
        Damage::Scale => Some(EvidenceKind::Scaled),
        Damage::Mirror => Some(EvidenceKind::Mirrored),
        Damage::Noise(_) => Some(EvidenceKind::Noisy),
        Damage::Subdivide(_) | Damage::Decimate(_) | Damage::Remesh => Some(EvidenceKind::Remeshed),
        _ => None,
    }
}

pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let options = DescribeOptions::default();
    let all = context.collection.all();
    let described =
        map(&all, "describing", context.observer, |shape| Ok(describe(&shape.surface, &options)?))?;
    let prepared = described.iter().map(ShapeDescription::prepare).collect::<Result<Vec<_>, _>>()?;
    let names = context.collection.labels();
    let labels = Labels::new(&names);
    let queries = context.collection.first_of_each_class(context.config.queries);
    let mut rows = Vec::new();
    for damage in DAMAGES {
        let found = map(&queries, &damage.to_string(), context.observer, |shape| {
            let own =
                all.iter().position(|other| other.name == shape.name).context("a shape of the collection")?;
            let mesh = damage.apply(shape.surface.mesh(), context.seed + own as u64);
            let damaged = describe(&Surface::new(&mesh, &shape.surface.repair)?, &options)?;
            let (relative, units) = changes(&described[own], &damaged);
            let query = damaged.prepare()?;
            let distance = |i: usize| ShapeMetric::robust(query.fused(), prepared[i].fused());
            let mut candidates: Vec<_> =
                (0..prepared.len()).map(|index| Candidate { index, bound: distance(index) }).collect();
            candidates.sort_by(|a, b| a.bound.total_cmp(&b.bound));
            let nearest = rerank(&query, candidates, 2, |i| Ok(&prepared[i]))?.nearest;
            let is_right = |index: usize| labels.class(index) == labels.class(own);
            let first = nearest.first().context("the collection has shapes")?;
            let pair = ShapePair::new(ShapeMetric::default(), [&query, &prepared[own]]);
            let geometries = [shape.surface.mesh(), &mesh].map(|mesh| MeshGeometry::new(mesh, None));
            let is_told = match (kind_of(damage), &geometries) {
                (Some(kind), [Some(a), Some(b)]) => {
                    Some(MatchEvidence::new([a, b], pair.verdict(Handedness::Unknown)).kind == kind)
                }
                _ => None,
            };
            Ok(Found {
                is_told,
                name: shape.name.clone(),
                relative,
                units,
                form: pair.best().rms / ShapeMetric::form_unit(FormDistance::NearestNeighborRms),
                combined: pair.distance().combined,
                is_top1: is_right(first.index),
                is_top1_of_others: nearest.iter().find(|n| n.index != own).is_some_and(|n| is_right(n.index)),
                is_unknown: first.distance >= ShapeMetric::SAME_CLASS.at,
            })
        })?;
        rows.push(row(damage, &found));
    }
    let least = rows.iter().map(|row| row.top1).fold(1.0, f64::min);
    let unknown = rows.iter().filter(|row| row.keeps_surface).map(|row| row.unknown).fold(0.0, f64::max);
    let told = rows.iter().filter_map(|row| row.told).fold(1.0, f64::min);
    let measured: Measured = [("least top1", least), ("unknown", unknown), ("least told", told)]
        .map(|(k, v)| (k.to_owned(), v))
        .into();
    let vertices = all.iter().map(|shape| shape.surface.mesh().n_vertices() as f64);
    let results = InvarianceResults {
        n_shapes: all.len(),
        n_damaged: queries.len(),
        n_vertices: median(vertices.collect()) as usize,
        same_class: ShapeMetric::SAME_CLASS.at,
        same_shape: ShapeMetric::SAME_SHAPE.at,
        rows,
    };
    context.publish(
        results,
        context.provenance(serde_json::json!({ "description": options.text() })),
        &measured,
    )
}

/// The change of every signature, relative to its length and in its unit.
fn changes(before: &ShapeDescription, after: &ShapeDescription) -> (Vec<f64>, Vec<f64>) {
    let pairs = before.signatures.iter().zip(&after.signatures);
    pairs
        .map(|(before, after)| {
            let distance = before.distance(after);
            let length = before.values.iter().map(|x| x * x).sum::<f64>().sqrt();
            (distance / length.max(f64::MIN_POSITIVE), distance / ShapeMetric::unit(before.kind))
        })
        .unzip()
}

fn row(damage: Damage, found: &[Found]) -> InvarianceRow {
    let median_of = |value: &dyn Fn(&Found) -> f64| median(found.iter().map(value).collect());
    let share = |is: &dyn Fn(&Found) -> bool| {
        found.iter().filter(|f| is(f)).count() as f64 / found.len().max(1) as f64
    };
    let farthest = found.iter().max_by(|a, b| a.combined.total_cmp(&b.combined));
    let change = |(i, kind): (usize, SignatureKind)| SignatureChange {
        name: kind.name().to_owned(),
        relative: median_of(&|f| f.relative[i]),
        units: median_of(&|f| f.units[i]),
    };
    InvarianceRow {
        damage: damage.to_string(),
        keeps_surface: damage.keeps_surface(),
        signatures: SignatureKind::ALL.into_iter().enumerate().map(change).collect(),
        form: median_of(&|f| f.form),
        combined: median_of(&|f| f.combined),
        largest: farthest.map_or(0.0, |f| f.combined),
        farthest: farthest.map_or_else(String::new, |f| f.name.clone()),
        top1: share(&|f| f.is_top1),
        top1_others: share(&|f| f.is_top1_of_others),
        unknown: share(&|f| f.is_unknown),
        told: kind_of(damage).map(|_| share(&|f| f.is_told == Some(true))),
    }
}

/// The upper median; 0 of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
