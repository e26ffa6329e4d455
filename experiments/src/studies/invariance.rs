//! Invariance: some shapes of every class are damaged in several ways, and searched for in the undamaged collection.
//!
//! Measures `least top1`, the lowest share over all damages of shapes whose nearest has their class, and `unknown`, the
//! largest share of unknown shapes over the damages that keep the surface; and `least told`, the lowest share of shapes whose
//! relation to the undamaged shape is right.

use anyhow::{Context as _, Result};
use canonform::describe;
use canonform::index::VectorTable;
use canonform::relations::{MeshGeometry, Relation, RelationKind};
use canonform::rigid::Handedness;
use canonform::search::{bounds, rerank};
use datasets::Damage;
use descriptors::{ShapeMetric, ShapePair};
use mesh::{SmoothRegions, TriMesh};
use report::{Cell, Record, Table};

use crate::context::Context;
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

const HEADINGS: [&str; 9] = [
    "damage",
    "distance, median",
    "largest",
    "farthest shape",
    "top 1",
    "others",
    "unknown",
    "told",
    "aligned forms",
];
pub(crate) fn invariance(context: &Context<'_>) -> Result<Record> {
    let gallery = Gallery::new(context)?;
    let prepared = gallery.prepared()?;
    let mut vectors = VectorTable::default();
    prepared.iter().for_each(|shape| vectors.push("", &shape.fused));
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    let (mut least_top1, mut most_unknown, mut least_told) = (1.0_f64, 0.0_f64, 1.0_f64);
    for damage in DAMAGES {
        let found = gallery.map(context.options.queries, &damage.to_string(), |query| {
            let surface = query.damaged(damage)?;
            let damaged = describe(&surface, &gallery.options, &())?;
            let shape = gallery.options.prepare(&damaged)?;
            // As a search in an index does.
            let candidates = bounds(&shape.fused, &vectors);
            let nearest = rerank(&shape, candidates, 2, |i| Ok(&prepared[i]))?.nearest;
            let (first, _) = nearest.first().context("the collection has shapes")?;
            let mut others = nearest.iter().filter(|(near, _)| near.index != query.own);
            let pair = ShapePair::new([&shape, &prepared[query.own]]);
            let whole = query.shape.surface.mesh();
            let mesh = damage.apply(whole, query.seed);
            let geometries = [whole, &mesh].map(|mesh| MeshGeometry::new(mesh, None));
            let is_told = match (kinds_of(damage, whole), &geometries) {
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
                form: pair.best().gap.rms / ShapeMetric::FORM_UNIT,
                combined: pair.distance().combined,
                is_top1: gallery.is_right(query, first.index),
                is_top1_of_others: others.next().is_some_and(|(near, _)| gallery.is_right(query, near.index)),
                is_unknown: first.distance >= ShapeMetric::SAME_CLASS.at,
            })
        })?;
        let median_of = |value: &dyn Fn(&DamagedShape) -> f64| upper_median(found.iter().map(value));
        let farthest = found.iter().max_by(|a, b| a.combined.total_cmp(&b.combined)).context("a query")?;
        let told: Vec<bool> = found.iter().filter_map(|f| f.is_told).collect();
        let told = (!told.is_empty()).then(|| share(&told, |is_told| *is_told));
        let top1 = share(&found, |f| f.is_top1);
        let unknown = share(&found, |f| f.is_unknown);
        least_top1 = least_top1.min(top1);
        least_told = least_told.min(told.unwrap_or(1.0));
        most_unknown = most_unknown.max(if damage.keeps_surface() { unknown } else { 0.0 });
        rows.push(vec![
            damage.to_string().into(),
            median_of(&|f| f.combined).into(),
            farthest.combined.into(),
            farthest.name.as_str().into(),
            top1.into(),
            share(&found, |f| f.is_top1_of_others).into(),
            unknown.into(),
            told.into(),
            median_of(&|f| f.form).into(),
        ]);
    }
    let tables = vec![Table::new("", HEADINGS, rows)];
    let vertices = context.collection.shapes.iter().map(|shape| shape.surface.mesh().n_vertices() as f64);
    let measured = numbers([
        ("least top1", least_top1),
        ("unknown", most_unknown),
        ("least told", least_told),
        ("vertices", upper_median(vertices)),
        ("boundary of shapes", ShapeMetric::SAME_SHAPE.at),
        ("boundary of classes", ShapeMetric::SAME_CLASS.at),
    ]);
    Ok(Record { tables, ..context.record(&[("description", &gallery.options)], measured) })
}

/// The upper median; 0 of nothing.
fn upper_median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
