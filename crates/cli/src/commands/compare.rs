//! `canonform compare`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use pipeline::{Comparison, FormDistance, MatchKind, MatchOptions, StressChoice, compare_forms, embed};
use serde::Serialize;

use super::{named, read_surface};
use crate::args::{Common, CompareArgs, DistanceName};
use crate::output::{facts, print, print_json};
use terminal::Bars;

#[derive(Serialize)]
struct CompareJson {
    a: PathBuf,
    b: PathBuf,
    #[serde(flatten)]
    comparison: Comparison,
    threshold: Option<f64>,
}

/// Embeds, aligns and compares two meshes.
pub(crate) fn compare(args: &CompareArgs, common: &Common) -> Result<ExitCode> {
    if args.embedding.dim != 3 {
        bail!("forms are compared in 3 dimensions; leave out --dim {}", args.embedding.dim);
    }
    let options = args.embedding.options(common, StressChoice::Skip)?;
    let bars = Bars::new(common.quiet);
    let form = |path: &Path| {
        let surface = read_surface(path, &args.embedding.repair)?;
        let embedded = embed(&surface, &options, &bars).map_err(|fault| named(path, fault))?;
        bars.finish();
        embedded.form(&surface).map_err(|fault| named(path, fault))
    };
    let matching = MatchOptions {
        distance: match args.distance {
            DistanceName::NnRms => FormDistance::NearestNeighborRms,
            DistanceName::Hausdorff95 => FormDistance::Hausdorff95,
        },
        ..MatchOptions::default()
    };
    let comparison = compare_forms(&form(&args.a)?, &form(&args.b)?, &matching)?;
    let too_far = args.threshold.is_some_and(|limit| comparison.normalized_distance > limit);
    let json = CompareJson { a: args.a.clone(), b: args.b.clone(), comparison, threshold: args.threshold };
    if common.json {
        print_json(&json)?
    } else {
        print(&table(&json))?
    }
    Ok(if too_far { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

fn table(json: &CompareJson) -> String {
    let c = &json.comparison;
    let kind = match c.kind {
        MatchKind::Same => "the same shape up to pose".to_owned(),
        MatchKind::Scaled => format!("the same shape up to pose, scaled by {:.3}", c.scale),
        MatchKind::Mirrored => "mirror images up to pose".to_owned(),
        MatchKind::MirroredAndScaled => format!("mirror images up to pose, scaled by {:.3}", c.scale),
        MatchKind::Different => "different shapes".to_owned(),
    };
    let mut rows = vec![
        ("match", kind),
        ("distance", format!("{:.6} mesh units", c.distance)),
        ("at equal size", format!("{:.6} (the same shape below {})", c.normalized_distance, c.same_below)),
        ("size, second over first", format!("{:.6}", c.scale)),
        ("reflected", if c.reflected { "yes" } else { "no" }.to_owned()),
    ];
    for (name, row) in ["rotation", "", ""].into_iter().zip(c.rotation) {
        rows.push((name, row.map(|x| format!("{x:>10.6}")).join(" ")));
    }
    rows.push(("translation", c.translation.map(|x| format!("{x:>10.4}")).join(" ")));
    if let Some(limit) = json.threshold {
        let held = if c.normalized_distance > limit { "exceeded" } else { "held" };
        rows.push(("threshold", format!("{limit} {held}")));
    }
    facts(&rows)
}
