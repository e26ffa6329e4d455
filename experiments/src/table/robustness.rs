//! Robustness: some shapes of every class are damaged in every way at strengths from 1 to 5, and searched for in the
//! undamaged collection. The shape itself is left out, so that another one of its class has to be found.
//!
//! Measures `KIND STRENGTH METHOD nn|mAP` for `METHOD` a signature or `fused`, at strength 3 also `aligned forms` and `fused
//! and forms`; `undamaged METHOD nn|mAP`; `least fused nn`, over all kinds at strength 3; `false alarms`, the share of
//! undamaged shapes with a shortcut; and `KIND STRENGTH cut`, the number of shortcuts that are cut, relative to the number of
//! welds.

use anyhow::{Context as _, Result};
use canonform::{DescribeOptions, ShapeDescription, Surface, describe};
use datasets::DamageKind;
use descriptors::{FormDistance, PreparedShape, ShapeMetric, ShapePair, SignatureKind};
use report::results::{CurvesPanel, CurvesResults, Series};
use retrieval::{Labels, Scores, rank_row};

use crate::collection::{Shape, map};
use crate::context::Context;
use crate::sweep::{Measured, linear, panel, point};

const FUSED: &str = "fused";
const FORMS: &str = "aligned forms";
const BOTH: &str = "fused and forms";

/// The strength at which forms are aligned, too; that takes most of the time.
const ALIGNED_AT: usize = 3;

/// The undamaged collection.
struct Gallery {
    described: Vec<ShapeDescription>,
    prepared: Vec<PreparedShape>,
    labels: Labels,
}

/// The scores of the queries by one method.
#[derive(Clone)]
struct Found {
    method: &'static str,
    nn: f64,
    map: f64,
}

pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let options = DescribeOptions::default();
    let all = context.collection.all();
    let described =
        map(&all, "describing", context.observer, |shape| Ok(describe(&shape.surface, &options)?))?;
    let prepared = described.iter().map(ShapeDescription::prepare).collect::<Result<Vec<_>, _>>()?;
    let gallery = Gallery { described, prepared, labels: Labels::new(&context.collection.labels()) };
    let queries = context.collection.first_of_each_class(context.config.queries);
    let own = |shape: &Shape| {
        all.iter().position(|other| other.name == shape.name).context("a shape of the collection")
    };
    let mut measured = Measured::new();
    let alarms = gallery.described.iter().filter(|shape| !shape.shortcuts.is_empty()).count();
    measured.insert("false alarms".to_owned(), alarms as f64 / all.len().max(1) as f64);
    let undamaged = map(&queries, "undamaged", context.observer, |shape| {
        let own = own(shape)?;
        scores(&gallery, &gallery.described[own], own, true)
    })?;
    let undamaged = means(&undamaged);
    for Found { method, nn, map } in &undamaged {
        measured.insert(format!("undamaged {method} nn"), *nn);
        measured.insert(format!("undamaged {method} mAP"), *map);
    }
    let mut panels = Vec::new();
    let mut least = f64::INFINITY;
    for kind in DamageKind::ALL {
        let mut curves: Vec<(usize, Vec<Found>)> = vec![(0, undamaged.clone())];
        for strength in 1..=DamageKind::STRENGTHS {
            let stage = format!("{} {strength}", kind.name());
            let found = map(&queries, &stage, context.observer, |shape| {
                let own = own(shape)?;
                let mesh = kind.at(strength).apply(shape.surface.mesh(), context.seed + own as u64);
                let damaged = describe(&Surface::new(&mesh, &shape.surface.repair)?, &options)?;
                let found = scores(&gallery, &damaged, own, strength == ALIGNED_AT)?;
                Ok((found, damaged.shortcuts.len()))
            })?;
            let (found, cut): (Vec<_>, Vec<_>) = found.into_iter().unzip();
            if matches!(kind, DamageKind::Weld | DamageKind::FarWeld | DamageKind::Contact) {
                let share = cut.iter().sum::<usize>() as f64 / (cut.len() * strength).max(1) as f64;
                measured.insert(format!("{stage} cut"), share);
            }
            let found = means(&found);
            for Found { method, nn, map } in &found {
                measured.insert(format!("{stage} {method} nn"), *nn);
                measured.insert(format!("{stage} {method} mAP"), *map);
                if strength == ALIGNED_AT && *method == FUSED {
                    least = least.min(*nn);
                }
            }
            curves.push((strength, found));
        }
        panels.extend(panels_of(kind, &curves));
    }
    measured.insert("least fused nn".to_owned(), least);
    let caption = format!(
        "Scores of {} damaged shapes, each compared with the {} undamaged ones but itself, by kind and strength of the damage; \
         0 is undamaged.",
        queries.len(),
        all.len()
    );
    let provenance = context.provenance(serde_json::json!({ "description": options.text() }));
    context.publish(CurvesResults { caption, panels }, provenance, &measured)
}

/// The scores of one query by every method.
fn scores(gallery: &Gallery, query: &ShapeDescription, own: usize, aligned: bool) -> Result<Vec<Found>> {
    let n = gallery.described.len();
    let mut found = Vec::new();
    let mut add = |method: &'static str, distance: &dyn Fn(usize) -> f64| {
        let distances: Vec<f64> = (0..n).map(distance).collect();
        // Of a shape that is alone in its class, nothing can be found.
        let scores = Scores::of_query(&rank_row(&distances, own), own, &gallery.labels).unwrap_or_default();
        found.push(Found { method, nn: scores.nn, map: scores.map });
    };
    for kind in SignatureKind::ALL {
        let signature = query.signature(kind).context("a signature of every kind")?;
        add(kind.name(), &|i| {
            gallery.described[i].signature(kind).map_or(f64::NAN, |s| signature.distance(s))
        });
    }
    let query = query.prepare()?;
    let fused: Vec<f64> =
        gallery.prepared.iter().map(|shape| ShapeMetric::fused(query.fused(), shape.fused())).collect();
    add(FUSED, &|i| fused[i]);
    if aligned {
        let pairs = gallery.prepared.iter().map(|shape| {
            let pair = ShapePair::new(ShapeMetric::default(), [&query, shape]);
            (pair.best().distance(FormDistance::NearestNeighborRms), pair.distance().combined)
        });
        let pairs: Vec<(f64, f64)> = pairs.collect();
        add(FORMS, &|i| pairs[i].0);
        add(BOTH, &|i| pairs[i].1);
    }
    Ok(found)
}

/// The means over queries.
fn means(queries: &[Vec<Found>]) -> Vec<Found> {
    let n = queries.len().max(1) as f64;
    let methods = queries.first().map_or(&[][..], |found| found);
    let mean = |(i, first): (usize, &Found)| Found {
        method: first.method,
        nn: queries.iter().map(|found| found[i].nn).sum::<f64>() / n,
        map: queries.iter().map(|found| found[i].map).sum::<f64>() / n,
    };
    methods.iter().enumerate().map(mean).collect()
}

/// The panels of one kind: nearest neighbours, and mean average precision.
fn panels_of(kind: DamageKind, curves: &[(usize, Vec<Found>)]) -> Vec<CurvesPanel> {
    let score = |name: &str, value: &dyn Fn(&Found) -> f64| {
        let methods = curves.first().map_or(&[][..], |(_, found)| found);
        let series = methods.iter().map(|first| {
            let at = |(strength, found): &(usize, Vec<Found>)| {
                let own = found.iter().find(|f| f.method == first.method)?;
                Some(point(*strength as f64, &[value(own)]))
            };
            Series { name: first.method.to_owned(), points: curves.iter().filter_map(at).collect() }
        });
        let title = format!("{}: {name}", kind.name());
        panel(title, linear("strength"), linear(name), series.collect())
    };
    vec![score("NN", &|f| f.nn), score("mAP", &|f| f.map)]
}
