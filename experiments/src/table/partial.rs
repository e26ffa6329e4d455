//! Parts: shapes that are cut by planes, lose limbs or have holes are searched for in the collection of whole shapes. The shape
//! itself is left out, so that another one of its class has to be found.
//!
//! Measures `CUT METHOD nn|mAP` with `METHOD` one of `fused` and `discs`.

use anyhow::{Context as _, Result};
use canonform::{DescribeOptions, Surface, describe, embed};
use datasets::Damage;
use descriptors::{DiscAreas, PartDiscAreas, ShapeMetric};
use geodesics::{Method, Source};
use report::results::{CurvesPanel, CurvesResults, Series};
use retrieval::{Labels, Scores, rank_row};

use crate::collection::map;
use crate::context::Context;
use crate::sweep::{Measured, linear, panel, point};

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

struct Whole {
    fused: Vec<f32>,
    discs: DiscAreas,
}

pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let options = DescribeOptions::default();
    let all = context.collection.all();
    let wholes = map(&all, "describing", context.observer, |shape| {
        let fused = describe(&shape.surface, &options)?.fused;
        let embedded = embed(&shape.surface, &options.form, &())?;
        let discs = DiscAreas::new(&embedded.distances, &shape.surface.mesh().vertex_areas())?;
        Ok(Whole { fused, discs })
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
            let discs = discs_of(&part, &options)?;
            let score = |distance: &dyn Fn(&Whole) -> f64| {
                let distances: Vec<f64> = wholes.iter().map(distance).collect();
                Scores::of_query(&rank_row(&distances, own), own, &labels).unwrap_or_default()
            };
            let plain = score(&|whole| ShapeMetric::robust(&query, &whole.fused));
            let partial = score(&|whole| discs.distance(&whole.discs).distance);
            Ok([plain, partial])
        })?;
        for (m, method) in METHODS.iter().enumerate() {
            let mean = |value: &dyn Fn(&Scores) -> f64| {
                found.iter().map(|scores| value(&scores[m])).sum::<f64>() / found.len().max(1) as f64
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

/// The areas of discs of a part.
fn discs_of(part: &Surface, options: &DescribeOptions) -> Result<PartDiscAreas> {
    let embedded = embed(part, &options.form, &())?;
    let masses = part.mesh().vertex_areas();
    let least = 0.15 * part.mesh().root_of_area();
    let (cut, length) = part.boundary_vertices(least);
    let from_cut = match cut.is_empty() {
        true => vec![f64::INFINITY; masses.len()],
        false => {
            let sources: Vec<Source> = cut.into_iter().map(Source::vertex).collect();
            let mut distances = vec![f64::INFINITY; masses.len()];
            Method::default().prepare(&part.intrinsic)?.solve_into(
                &sources,
                f64::INFINITY,
                &mut distances,
            )?;
            distances
        }
    };
    Ok(PartDiscAreas::new(&embedded.distances, &masses, &from_cut, length)?)
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
