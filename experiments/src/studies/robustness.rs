//! Robustness: some shapes of every class are damaged in every way at strengths from 1 to 5, and searched for in the
//! undamaged collection. The shape itself is left out, so that another one of its class has to be found.
//!
//! Measures `KIND STRENGTH METHOD nn|mAP` for `METHOD` a signature or `fused`; `undamaged METHOD nn|mAP`; `least fused nn`,
//! over all kinds at strength 3; `false alarms`, the share of undamaged shapes with a shortcut; and `KIND STRENGTH cut`, the
//! number of shortcuts that are cut, relative to the number of welds.

use anyhow::{Context as _, Result};
use canonform::describe;
use canonform::embed::signature;
use canonform::index::Shape;
use datasets::Damage;
use descriptors::{ShapeMetric, SignatureKind};
use report::Record;
use report::record::{Axis, SeriesKind};

use crate::context::Context;
use crate::gallery::{Gallery, GalleryQuery};
use crate::sweep::{MeasuredNumbers, Panels, mean, note, numbers, plots, point, share};

const FUSED: &str = "fused";

/// The strength of `least fused nn`.
const MIDDLE: usize = 3;

/// Scores by method: nearest neighbor, and mean average precision.
type MethodScores = Vec<(&'static str, [f64; 2])>;

const SCORES: [&str; 2] = ["nn", "mAP"];

pub(crate) fn robustness(context: &Context<'_>) -> Result<Record> {
    let gallery = Gallery::new(context)?;
    let alarms = share(&gallery.described, |shape| shape.entry.facts.shortcuts > 0);
    let mut measured = numbers([("false alarms", alarms)]);
    let undamaged = gallery.map(context.options.queries, "undamaged", |query| {
        scores(&gallery, query, &gallery.described[query.own])
    })?;
    let undamaged = means(&undamaged);
    record("undamaged", &undamaged, &mut measured);
    let mut panels = Panels::default();
    let mut least = f64::INFINITY;
    for (kind, strengths) in Damage::graded() {
        draw(kind, 0, &undamaged, &mut panels);
        for (strength, damage) in (1..).zip(strengths) {
            let stage = format!("{kind} {strength}");
            let found = gallery.map(context.options.queries, &stage, |query| {
                let damaged = describe(&query.damaged(damage)?, &gallery.options, &())?;
                Ok((scores(&gallery, query, &damaged)?, damaged.entry.facts.shortcuts))
            })?;
            let (found, cut): (Vec<_>, Vec<_>) = found.into_iter().unzip();
            if matches!(damage, Damage::Weld(..) | Damage::Contact(_)) {
                let cut = mean(cut.into_iter().map(|cut| cut as f64 / strength as f64));
                measured.insert(format!("{stage} cut"), cut);
            }
            let found = means(&found);
            record(&stage, &found, &mut measured);
            let fused = found.iter().find(|(method, _)| *method == FUSED && strength == MIDDLE);
            least = fused.map_or(least, |(_, [nn, _])| least.min(*nn));
            draw(kind, strength, &found, &mut panels);
        }
    }
    measured.insert("least fused nn".to_owned(), least);
    let figures = vec![plots("curves", panels.0)];
    Ok(Record { figures, ..context.record(&[("description", &gallery.options)], measured) })
}

/// The scores of one query by every method.
fn scores(gallery: &Gallery<'_>, query: &GalleryQuery<'_>, description: &Shape) -> Result<MethodScores> {
    let mut found = Vec::new();
    let mut add = |method: &'static str, distance: &dyn Fn(usize) -> f64| {
        let scores = gallery.scores(query, distance);
        found.push((method, [scores.nn, scores.map]));
    };
    for kind in SignatureKind::INTRINSIC {
        let own = signature(description, kind).context("a signature of every kind")?;
        add(kind.name(), &|i| signature(&gallery.described[i], kind).map_or(f64::NAN, |s| own.distance(&s)));
    }
    add(FUSED, &|i| ShapeMetric::fused(&description.fused, &gallery.described[i].fused));
    Ok(found)
}

/// The means over queries.
fn means(queries: &[MethodScores]) -> MethodScores {
    let methods = queries.first().map_or(&[][..], |found| found);
    let over = |i: usize, score: usize| mean(queries.iter().map(|found| found[i].1[score]));
    methods.iter().enumerate().map(|(i, (method, _))| (*method, [over(i, 0), over(i, 1)])).collect()
}

fn record(stage: &str, found: &MethodScores, measured: &mut MeasuredNumbers) {
    for (method, scores) in found {
        note(measured, &format!("{stage} {method}"), SCORES.into_iter().zip(*scores));
    }
}

/// Adds to the panels of a kind: nearest neighbors, and mean average precision.
fn draw(kind: &str, strength: usize, found: &MethodScores, panels: &mut Panels) {
    for (method, scores) in found {
        for (name, score) in ["NN", "mAP"].into_iter().zip(scores) {
            let (title, axes) = (format!("{kind}: {name}"), ["strength", name].map(Axis::linear));
            panels.add(&title, axes, (method, SeriesKind::Curve), point(strength as f64, &[*score]));
        }
    }
}
