//! Invariance: some shapes of every class are damaged in several ways, and searched for in the undamaged collection.
//!
//! Measures `least top1`, the lowest share over all damages of shapes whose nearest has their class, and `unknown`, the
//! largest share of unknown shapes over the damages that keep the surface; and `least told`, the lowest share of shapes whose
//! relation to the undamaged shape is right.

use anyhow::{Context as _, Result};
use canonform::describe;
use canonform::embed::signature;
use canonform::index::{Shape, VectorTable};
use canonform::relations::{MeshGeometry, Relation, RelationKind};
use canonform::rigid::Handedness;
use canonform::search::{bounds, rerank};
use datasets::Damage;
use descriptors::{ShapeMetric, ShapePair, SignatureKind};
use mesh::{SmoothRegions, TriMesh};
use report::results::{InvarianceResults, InvarianceRow, SignatureChange};
use serde::Deserialize;

use crate::context::Context;
use crate::experiment::Experiment;
use crate::gallery::Gallery;
use crate::sweep::{numbers, share};

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
struct DamagedShape {
    name: String,
    /// Of every signature, relative to its length and in its unit.
    changes: Vec<[f64; 2]>,
    form: f64,
    combined: f64,
    is_top1: bool,
    is_top1_of_others: bool,
    is_unknown: bool,
    /// Whether the relation to the undamaged shape is right; none if the damage has no kind of its own.
    is_told: Option<bool>,
}

/// What a damaged shape may be said to be beside the undamaged one. The mirror image of a symmetric surface is the surface, with
/// other triangles. Noise and new triangles cut the edges of mechanical parts off, so that the surface is another one.
fn kinds_of(damage: Damage, mesh: &TriMesh) -> &'static [RelationKind] {
    match damage {
        Damage::Move => &[RelationKind::IdenticalGeometry],
        Damage::Scale => &[RelationKind::Scaled],
        Damage::Mirror if is_mechanical(mesh) => {
            &[RelationKind::IdenticalGeometry, RelationKind::Mirrored, RelationKind::Remeshed]
        }
        Damage::Mirror => &[RelationKind::Mirrored],
        Damage::Subdivide(_) => &[RelationKind::Remeshed],
        Damage::Noise(_) if !is_mechanical(mesh) => &[RelationKind::Noisy],
        Damage::Decimate(_) | Damage::Remesh if !is_mechanical(mesh) => &[RelationKind::Remeshed],
        _ => &[],
    }
}

fn is_mechanical(mesh: &TriMesh) -> bool {
    SmoothRegions::of(mesh).is_mechanical
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct InvarianceOptions {
    /// Shapes of each class that are damaged.
    queries: usize,
}

impl Experiment for InvarianceOptions {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let gallery = Gallery::new(context)?;
        let all = &context.collection.shapes;
        let prepared = gallery.prepared()?;
        let (mut vectors, mut rows) = (VectorTable::default(), Vec::new());
        prepared.iter().for_each(|shape| vectors.push("", shape.fused()));
        for damage in DAMAGES {
            let found = gallery.map(self.queries, &damage.to_string(), |query| {
                let surface = query.damaged(damage)?;
                let damaged = describe(&surface, &gallery.options, &())?;
                let shape = gallery.options.prepare(&damaged)?;
                // As a search in an index does.
                let candidates = bounds(shape.fused(), &vectors);
                let nearest = rerank(&shape, candidates, 2, |i| Ok(&prepared[i]))?.nearest;
                let (first, _) = nearest.first().context("the collection has shapes")?;
                let mut others = nearest.iter().filter(|(near, _)| near.index != query.own);
                let pair = ShapePair::new([&shape, &prepared[query.own]]);
                let mesh = damage.apply(query.shape.surface.mesh(), query.seed);
                let geometries =
                    [query.shape.surface.mesh(), &mesh].map(|mesh| MeshGeometry::new(mesh, None));
                let is_told = match (kinds_of(damage, query.shape.surface.mesh()), &geometries) {
                    (kinds @ [_, ..], [Some(a), Some(b)]) => {
                        let by_distance =
                            Relation::by_distance(pair.distance(), pair.scale(), Handedness::Unknown);
                        Some(kinds.contains(&by_distance.by_meshes([a, b]).kind))
                    }
                    _ => None,
                };
                Ok(DamagedShape {
                    is_told,
                    name: query.shape.name.clone(),
                    changes: changes(&gallery.described[query.own], &damaged),
                    form: pair.best().gap.rms / ShapeMetric::FORM_UNIT,
                    combined: pair.distance().combined,
                    is_top1: gallery.is_right(query, first.index),
                    is_top1_of_others: others
                        .next()
                        .is_some_and(|(near, _)| gallery.is_right(query, near.index)),
                    is_unknown: first.distance >= ShapeMetric::SAME_CLASS.at,
                })
            })?;
            rows.push(row(damage, &found));
        }
        let least = rows.iter().map(|row| row.top1).fold(1.0, f64::min);
        let unknown = rows.iter().filter(|row| row.keeps_surface).map(|row| row.unknown).fold(0.0, f64::max);
        let told = rows.iter().filter_map(|row| row.told).fold(1.0, f64::min);
        let measured = numbers([("least top1", least), ("unknown", unknown), ("least told", told)]);
        let vertices = all.iter().map(|shape| shape.surface.mesh().n_vertices() as f64);
        let results = InvarianceResults {
            n_shapes: all.len(),
            n_damaged: context.collection.first_of_each_class(self.queries).len(),
            n_vertices: upper_median(vertices) as usize,
            same_class: ShapeMetric::SAME_CLASS.at,
            same_shape: ShapeMetric::SAME_SHAPE.at,
            rows,
        };
        context.publish(results, context.provenance(&[("description", &gallery.options)]), &measured)
    }
}

/// The change of every signature, relative to its length and in its unit.
fn changes(before: &Shape, after: &Shape) -> Vec<[f64; 2]> {
    let pair = |kind| signature(before, kind).zip(signature(after, kind));
    SignatureKind::INTRINSIC
        .into_iter()
        .filter_map(pair)
        .map(|(before, after)| {
            let distance = before.distance(&after);
            let length = before.values.iter().map(|x| x * x).sum::<f64>().sqrt();
            [distance / length.max(f64::MIN_POSITIVE), distance / ShapeMetric::unit(before.kind)]
        })
        .collect()
}

fn row(damage: Damage, found: &[DamagedShape]) -> InvarianceRow {
    let median_of = |value: &dyn Fn(&DamagedShape) -> f64| upper_median(found.iter().map(value));
    let farthest = found.iter().max_by(|a, b| a.combined.total_cmp(&b.combined));
    let told: Vec<bool> = found.iter().filter_map(|f| f.is_told).collect();
    let change = |(i, kind): (usize, SignatureKind)| SignatureChange {
        name: kind.name().to_owned(),
        relative: median_of(&|f| f.changes[i][0]),
        units: median_of(&|f| f.changes[i][1]),
    };
    InvarianceRow {
        damage: damage.to_string(),
        keeps_surface: damage.keeps_surface(),
        signatures: SignatureKind::INTRINSIC.into_iter().enumerate().map(change).collect(),
        form: median_of(&|f| f.form),
        combined: median_of(&|f| f.combined),
        largest: farthest.map_or(0.0, |f| f.combined),
        farthest: farthest.map_or_else(String::new, |f| f.name.clone()),
        top1: share(found, |f| f.is_top1),
        top1_others: share(found, |f| f.is_top1_of_others),
        unknown: share(found, |f| f.is_unknown),
        told: (!told.is_empty()).then(|| share(&told, |is_told| *is_told)),
    }
}

/// The upper median; 0 of nothing.
fn upper_median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
