//! Robustness: shapes that are damaged, cut or meshed anew are searched for in the undamaged collection.
//!
//! Measures, with `KIND STRENGTH` for those of [`kinds`]:
//! * `KIND STRENGTH fused nn|mAP`: scores by the vectors that an index scans; the shape itself is left out, so that another one of
//!   its class has to be found;
//! * of [`PARTS`] also `KIND STRENGTH discs nn|mAP`;
//! * `KIND STRENGTH cut`: the shortcuts that are cut, relative to the number of welds or handles.
//!
//! Also `searched`, the number of queries; `least fused nn` and `least top1`, the lowest share of shapes whose nearest, themselves
//! included, has their class, both up to strength 3 and without planes; `false alarms`, the share of undamaged shapes with a
//! shortcut; `unknown`, the largest share of unknown shapes over the damages that keep the surface; and `least told`, the lowest
//! share of shapes whose relation to the undamaged shape is right.

use anyhow::{Context as _, Result};
use canonform::describe;
use canonform::embed::describe_part;
use canonform::index::VectorTable;
use canonform::relations::{MeshGeometry, Relation, RelationKind};
use canonform::rigid::Handedness;
use canonform::search::{bounds, rerank};
use datasets::Damage;
use descriptors::{DiscAreas, PreparedShape, ShapeMetric, ShapePair};
use mesh::{SmoothRegions, TriMesh};
use report::record::{Axis, SeriesKind};
use report::{Cell, Record, Table};
use retrieval::Scores;

use crate::context::Context;
use crate::gallery::{Gallery, GalleryQuery};
use crate::sweep::{MeasuredNumbers, Panels, mean, median, note, numbers, plots, point, share};

/// The kind that begins every curve.
const UNDAMAGED: &str = "undamaged";

/// Kinds that are also searched for as parts, by areas of discs.
const PARTS: [&str; 4] = [UNDAMAGED, "plane", "holes", "cut off"];

/// The greatest strength of `least fused nn` and `least top1`: damage that scans really have.
const MIDDLE: usize = 3;

/// Kinds of damage with their strengths, from 1 on.
fn kinds() -> Vec<(&'static str, Vec<Damage>)> {
    let graded = Damage::graded().map(|(kind, strengths)| (kind, strengths.to_vec()));
    let mut all = vec![(UNDAMAGED, vec![Damage::Resize(1.0)])];
    all.extend(graded);
    all.push(("plane", [0.85, 0.7, 0.5].map(Damage::Slice).to_vec()));
    all.push(("subdivision", [1, 2].map(Damage::Subdivide).to_vec()));
    all.push(("motion", vec![Damage::Move]));
    all
}

/// What a damaged shape may be said to be beside the undamaged one; nothing if the damage has no kind of its own. The mirror image
/// of a symmetric surface is the surface, with other triangles. Noise and new triangles cut the edges of mechanical parts off, so
/// that the surface is another one.
fn relations_of(damage: Damage, mesh: &TriMesh) -> &'static [RelationKind] {
    let is_mechanical = SmoothRegions::of(mesh).is_mechanical;
    match damage {
        Damage::Move => &[RelationKind::IdenticalGeometry],
        Damage::Resize(factor) if factor != 1.0 => &[RelationKind::Scaled],
        Damage::Mirror if is_mechanical => {
            &[RelationKind::IdenticalGeometry, RelationKind::Mirrored, RelationKind::Remeshed]
        }
        Damage::Mirror => &[RelationKind::Mirrored],
        Damage::Subdivide(_) => &[RelationKind::Remeshed],
        Damage::Noise(share) if share <= 0.005 && !is_mechanical => &[RelationKind::Noisy],
        Damage::Decimate(share) if share >= 0.2 && !is_mechanical => &[RelationKind::Remeshed],
        Damage::Sample(share) if share >= 1.0 && !is_mechanical => &[RelationKind::Remeshed],
        _ => &[],
    }
}

/// The undamaged collection.
struct Undamaged<'a> {
    gallery: &'a Gallery<'a>,
    prepared: Vec<PreparedShape>,
    vectors: VectorTable,
    discs: Vec<DiscAreas>,
}

/// A damaged shape beside the undamaged collection.
struct DamagedShape {
    name: String,
    /// By fused vectors and, of parts, by areas of discs.
    scores: Vec<(&'static str, Scores)>,
    combined: f64,
    form: f64,
    is_top1: bool,
    is_unknown: bool,
    /// Whether the relation to the undamaged shape is right; none if the damage has no kind of its own.
    is_told: Option<bool>,
    shortcuts: u64,
}

impl Undamaged<'_> {
    fn search(&self, query: &GalleryQuery<'_>, kind: &str, damage: Damage) -> Result<DamagedShape> {
        let Self { gallery, prepared, vectors, discs } = self;
        let surface = query.damaged(damage)?;
        let damaged = describe(&surface, &gallery.options, &())?;
        let shape = gallery.options.prepare(&damaged)?;
        // As a search in an index does.
        let found = rerank(&shape, bounds(&shape.fused, vectors), 1, |i| Ok(&prepared[i]))?.nearest;
        let (first, _) = found.first().context("the collection has shapes")?;
        let pair = ShapePair::new([&shape, &prepared[query.own]]);
        let whole = query.shape.surface.mesh();
        let kinds = relations_of(damage, whole);
        let geometries = [whole, &damage.apply(whole, query.seed)].map(|mesh| MeshGeometry::new(mesh, None));
        let is_told = match &geometries {
            [Some(a), Some(b)] if !kinds.is_empty() => {
                let by_distance = Relation::by_distance(pair.distance(), pair.scale(), Handedness::Unknown);
                Some(kinds.contains(&by_distance.by_meshes([a, b]).kind))
            }
            _ => None,
        };
        let robust = |i: usize| ShapeMetric::robust(&damaged.fused, &prepared[i].fused);
        let mut scores = vec![("fused", gallery.scores(query, robust))];
        if PARTS.contains(&kind) {
            let part = describe_part(&surface, &gallery.options, &())?;
            scores.push(("discs", gallery.scores(query, |i| part.distance(&discs[i]).distance)));
        }
        Ok(DamagedShape {
            name: query.shape.name.clone(),
            scores,
            combined: pair.distance().combined,
            form: pair.best().gap.rms / ShapeMetric::FORM_UNIT,
            is_top1: gallery.is_right(query, first.index),
            is_unknown: first.distance >= ShapeMetric::SAME_CLASS.at,
            is_told,
            shortcuts: damaged.entry.facts.shortcuts,
        })
    }
}

const DAMAGES: &str = "Distance: combined distance from the undamaged shape. Top 1: share of shapes whose nearest has their class; NN: the same without the undamaged shape itself, by fused vectors. Unknown: share of shapes whose nearest is farther than the boundary of classes. Told: share of shapes whose relation to the undamaged shape is right. Aligned forms: their median distance, in units of that between two poses of one body.";

const HEADINGS: [&str; 10] = [
    "damage",
    "NN",
    "mAP",
    "distance, median",
    "largest",
    "farthest shape",
    "top 1",
    "unknown",
    "told",
    "aligned forms",
];

pub(crate) fn robustness(context: &Context<'_>) -> Result<Record> {
    let gallery = Gallery::new(context)?;
    let prepared = gallery.prepared()?;
    let mut vectors = VectorTable::default();
    prepared.iter().for_each(|shape| vectors.push("", &shape.fused));
    let discs = gallery.described.iter().map(|shape| DiscAreas::from_numbers(&shape.disc_areas));
    let discs: Vec<DiscAreas> = discs.collect::<Option<_>>().context("disc areas of every shape")?;
    let undamaged = Undamaged { gallery: &gallery, prepared, vectors, discs };
    let n_queries = context.options.queries.div_ceil(context.collection.classes.len().max(1));
    let (mut measured, mut panels, mut rows) = (MeasuredNumbers::new(), Panels::default(), Vec::new());
    let (mut least_nn, mut least_top1, mut most_unknown, mut least_told) =
        (1.0_f64, 1.0_f64, 0.0_f64, 1.0_f64);
    let mut whole: Vec<(&str, [f64; 2])> = Vec::new();
    for (kind, strengths) in kinds() {
        let n_methods = if PARTS.contains(&kind) { 2 } else { 1 };
        for (method, scores) in whole.iter().take(n_methods) {
            draw(&mut panels, kind, (method, 0), *scores);
        }
        for (strength, damage) in (1..).zip(strengths) {
            let stage = format!("{kind} {strength}");
            let found = gallery.map(n_queries, &stage, |query| undamaged.search(query, kind, damage))?;
            measured.insert("searched".to_owned(), found.len() as f64);
            let mut scores: Vec<[f64; 2]> = Vec::new();
            for (i, (method, _)) in found.first().context("a query")?.scores.iter().enumerate() {
                let of =
                    |score: fn(&Scores) -> f64| mean(found.iter().map(|found| score(&found.scores[i].1)));
                let score = [of(|scores| scores.nn), of(|scores| scores.map)];
                note(&mut measured, &format!("{stage} {method}"), ["nn", "mAP"].into_iter().zip(score));
                match kind {
                    UNDAMAGED => whole.push((*method, score)),
                    _ => draw(&mut panels, kind, (method, strength), score),
                }
                scores.push(score);
            }
            if matches!(damage, Damage::Weld(..) | Damage::Contact(_)) {
                let cut = mean(found.iter().map(|found| found.shortcuts as f64 / strength as f64));
                measured.insert(format!("{stage} cut"), cut);
            }
            let told: Vec<bool> = found.iter().filter_map(|found| found.is_told).collect();
            // Not a number if nothing could be told: an empty cell, and never the least.
            let told = share(&told, |is_told| *is_told);
            let [top1, unknown] =
                [share(&found, |found| found.is_top1), share(&found, |found| found.is_unknown)];
            let [nn, precision] = scores[0];
            if strength <= MIDDLE && !matches!(damage, Damage::Slice(_)) {
                (least_nn, least_top1) = (least_nn.min(nn), least_top1.min(top1));
            }
            if damage.keeps_surface() {
                most_unknown = most_unknown.max(unknown);
            }
            least_told = least_told.min(told);
            let of = |value: fn(&DamagedShape) -> f64| median(&found.iter().map(value).collect::<Vec<_>>()).1;
            let farthest =
                found.iter().max_by(|a, b| a.combined.total_cmp(&b.combined)).context("a query")?;
            let distances = [nn, precision, of(|found| found.combined), farthest.combined].map(Cell::from);
            let others = [top1.into(), unknown.into(), told.into(), of(|found| found.form).into()];
            let [damage, farthest] = [damage.to_string(), farthest.name.clone()].map(Cell::from);
            rows.push([&[damage][..], &distances, &[farthest], &others].concat());
        }
    }
    measured.extend(numbers([
        ("least fused nn", least_nn),
        ("least top1", least_top1),
        ("unknown", most_unknown),
        ("least told", least_told),
        ("false alarms", share(&gallery.described, |shape| shape.entry.facts.shortcuts > 0)),
        ("boundary of shapes", ShapeMetric::SAME_SHAPE.at),
        ("boundary of classes", ShapeMetric::SAME_CLASS.at),
    ]));
    Ok(Record {
        tables: vec![Table::new(DAMAGES, HEADINGS, rows)],
        figures: vec![plots("curves", panels.0)],
        ..context.record(&[("description", &gallery.options)], measured)
    })
}

/// Adds a point to the panels of a kind: nearest neighbors, and mean average precision.
fn draw(panels: &mut Panels, kind: &str, (method, strength): (&str, usize), scores: [f64; 2]) {
    for (name, score) in ["NN", "mAP"].into_iter().zip(scores) {
        let (title, axes) = (format!("{kind}: {name}"), ["strength", name].map(Axis::linear));
        panels.add(&title, axes, (method, SeriesKind::Curve), point(strength as f64, &[score]));
    }
}
