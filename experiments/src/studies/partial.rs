//! Parts: shapes that are cut by planes, lose limbs or have holes are searched for in the collection of whole shapes. The shape
//! itself is left out, so that another one of its class has to be found.
//!
//! Measures `CUT METHOD nn|mAP` with `METHOD` one of `fused` and `discs`; `CUT discs own|other`, the median of the part distance
//! from the nearest other shape of the class and from the nearest shape of another class, and `CUT discs own below|other below`,
//! the shares of them below the boundary of a class.

use anyhow::{Context as _, Result};
use canonform::describe;
use canonform::embed::describe_part;
use datasets::Damage;
use descriptors::{DiscAreas, PartDistance, ShapeMetric};
use report::Record;
use report::record::{Axis, SeriesKind};
use retrieval::Scores;

use crate::context::Context;
use crate::gallery::Gallery;
use crate::sweep::{MeasuredNumbers, Panels, mean, median, note, plots, point, share};

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
struct FoundPart {
    /// By every method.
    scores: [Scores; 2],
    /// Part distance from the nearest other shape of the class, and from the nearest of another class.
    nearest: [f64; 2],
}

pub(crate) fn partial(context: &Context<'_>) -> Result<Record> {
    let gallery = Gallery::new(context)?;
    let wholes = &gallery.described;
    let of_wholes = wholes.iter().map(|whole| DiscAreas::from_numbers(&whole.disc_areas));
    let of_wholes: Vec<DiscAreas> = of_wholes.collect::<Option<_>>().context("disc areas of every shape")?;
    let mut measured = MeasuredNumbers::new();
    let mut panels = Panels::default();
    for (kind, lost, damage) in cuts() {
        let name = format!("{kind} {lost} %");
        let found = gallery.map(context.options.queries, &name, |query| {
            let part = query.damaged(damage)?;
            let fused = describe(&part, &gallery.options, &())?.fused;
            let discs = describe_part(&part, &gallery.options, &())?;
            let distance = |i: usize| discs.distance(&of_wholes[i]).distance;
            let plain = gallery.scores(query, |i| ShapeMetric::robust(&fused, &wholes[i].fused));
            let nearest = |is_own: bool| {
                let others = (0..wholes.len()).filter(|i| *i != query.own);
                let wanted = others.filter(|i| gallery.is_right(query, *i) == is_own);
                wanted.map(distance).fold(f64::INFINITY, f64::min)
            };
            let scores = [plain, gallery.scores(query, distance)];
            Ok(FoundPart { scores, nearest: [true, false].map(nearest) })
        })?;
        for (i, whose) in ["own", "other"].into_iter().enumerate() {
            let distances: Vec<f64> = found.iter().map(|found| found.nearest[i]).collect();
            let below = share(&distances, |distance| *distance < PartDistance::SAME_CLASS);
            measured.insert(format!("{name} discs {whose}"), median(&distances).1);
            measured.insert(format!("{name} discs {whose} below"), below);
        }
        for (m, method) in METHODS.iter().enumerate() {
            let nn = mean(found.iter().map(|found| found.scores[m].nn));
            let precision = mean(found.iter().map(|found| found.scores[m].map));
            note(&mut measured, &format!("{name} {method}"), [("nn", nn), ("mAP", precision)]);
            // What is whole is the beginning of every curve.
            for panel in
                ["plane", "limb", "holes"].into_iter().filter(|panel| [panel, "nothing"].contains(&kind))
            {
                for (score, value) in [("NN", nn), ("mAP", precision)] {
                    let axes = ["area missing, %", score].map(Axis::linear);
                    panels.add(
                        &format!("{panel}: {score}"),
                        axes,
                        (method, SeriesKind::Curve),
                        point(lost, &[value]),
                    );
                }
            }
        }
    }
    let figures = vec![plots("curves", panels.0)];
    Ok(Record { figures, ..context.record(&[("description", &gallery.options)], measured) })
}
