//! Parts: shapes that are cut by planes, lose limbs or have holes are searched for in the collection of whole shapes. The shape
//! itself is left out, so that another one of its class has to be found.
//!
//! Measures `CUT METHOD nn|mAP` with `METHOD` one of `fused` and `discs`; `CUT discs own|other`, the median of the part distance
//! from the nearest other shape of the class and from the nearest shape of another class, and `CUT discs own below|other below`,
//! the shares of them below the boundary of a class.

use anyhow::{Context as _, Result};
use canonform::{Budget, DescribeOptions, Surface, describe, describe_part};
use datasets::Damage;
use descriptors::{DiscAreas, PartDistance, ShapeMetric};
use report::results::{CurvesPanel, CurvesResults, Series};
use retrieval::{Labels, Scores, rank_row};

use crate::collection::map;
use crate::context::Context;
use crate::sweep::{Measured, linear, median, panel, point};

const METHODS: [&str; 2] = ["fused", "discs"];

/// Kinds of cuts: a name, and shares of the area with the damage that takes them away.
fn cuts() -> Vec<(&'static str, f64, Damage)> {
    vec![
        ("nothing", 0.0, Damage::Mirror),
        ("plane", 15.0, Damage::Slice(0.85)),
        ("plane", 30.0, Damage::Slice(0.7)),
        ("plane", 50.0, Damage::Slice(0.5)),
        ("limb", 16.0, Damage::CutOff(0.16)),
        ("limb", 30.0, Damage::CutOff(0.3)),
        ("holes", 8.0, Damage::Holes(0.08)),
        ("holes", 20.0, Damage::Holes(0.2)),
    ]
}

/// What was found for one part.
struct Found {
    /// By every method.
    scores: [Scores; 2],
    /// Part distance from the nearest other shape of the class, and from the nearest of another class.
    nearest: [f64; 2],
}

struct Whole {
    fused: Vec<f32>,
    discs: DiscAreas,
}

pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let options = DescribeOptions::default();
    let all = context.collection.all();
    let wholes = map(&all, "describing", context.observer, |shape| {
        let described = describe(&shape.surface, &options)?;
        Ok(Whole { fused: described.fused, discs: described.disc_areas })
    })?;
    let labels = Labels::new(&context.collection.labels());
    let queries = context.collection.first_of_each_class(context.config.queries);
    let mut measured = Measured::new();
    let mut rows = Vec::new();
    for (kind, lost, damage) in cuts() {
        let name = format!("{kind} {lost} %");
        let found = map(&queries, &name, context.observer, |shape| {
            let own = all.iter().position(|other| other.name == shape.name);
            let own = own.context("a shape of the collection")?;
            let part = Surface::new(
                &damage.apply(shape.surface.mesh(), context.seed + own as u64),
                &shape.surface.repair,
            )?;
            let query = describe(&part, &options)?.fused;
            let discs = describe_part(&part, &options, &Budget::unlimited())?;
            let score = |distance: &dyn Fn(&Whole) -> f64| {
                let distances: Vec<f64> = wholes.iter().map(distance).collect();
                Scores::of_query(&rank_row(&distances, own), own, &labels).unwrap_or_default()
            };
            let plain = score(&|whole| ShapeMetric::robust(&query, &whole.fused));
            let partial = score(&|whole| discs.distance(&whole.discs).distance);
            let nearest = |is_own: bool| {
                let others = (0..all.len()).filter(|i| *i != own);
                let wanted = others.filter(|i| (labels.class(*i) == labels.class(own)) == is_own);
                wanted.map(|i| discs.distance(&wholes[i].discs).distance).fold(f64::INFINITY, f64::min)
            };
            Ok(Found { scores: [plain, partial], nearest: [true, false].map(nearest) })
        })?;
        for (i, whose) in ["own", "other"].into_iter().enumerate() {
            let distances: Vec<f64> = found.iter().map(|found| found.nearest[i]).collect();
            let below = distances.iter().filter(|d| **d < PartDistance::SAME_CLASS).count();
            measured.insert(format!("{name} discs {whose}"), median(&distances).1);
            measured
                .insert(format!("{name} discs {whose} below"), below as f64 / distances.len().max(1) as f64);
        }
        for (m, method) in METHODS.iter().enumerate() {
            let mean = |value: &dyn Fn(&Scores) -> f64| {
                found.iter().map(|found| value(&found.scores[m])).sum::<f64>() / found.len().max(1) as f64
            };
            let (nn, precision) = (mean(&|s| s.nn), mean(&|s| s.map));
            measured.insert(format!("{name} {method} nn"), nn);
            measured.insert(format!("{name} {method} mAP"), precision);
            rows.push((kind, lost, m, nn, precision));
        }
    }
    let caption = format!(
        "Scores of parts of {} shapes, each compared with the {} whole ones but itself, by the share of the area that is missing.",
        queries.len(),
        all.len()
    );
    let provenance = context.provenance(serde_json::json!({ "description": options.text() }));
    context.publish(CurvesResults { caption, panels: panels(&rows) }, provenance, &measured)
}

type Row = (&'static str, f64, usize, f64, f64);

fn panels(rows: &[Row]) -> Vec<CurvesPanel> {
    let mut panels = Vec::new();
    for kind in ["plane", "limb", "holes"] {
        for (score, value) in [("NN", (|row| row.3) as fn(&Row) -> f64), ("mAP", |row| row.4)] {
            let series = METHODS.iter().enumerate().map(|(m, method)| {
                let is_there = |row: &&Row| row.2 == m && [kind, "nothing"].contains(&row.0);
                let at = |row: &Row| point(row.1, &[value(row)]);
                Series { name: (*method).to_owned(), points: rows.iter().filter(is_there).map(at).collect() }
            });
            let title = format!("{kind}: {score}");
            panels.push(panel(title, linear("area missing, %"), linear(score), series.collect()));
        }
    }
    panels
}
