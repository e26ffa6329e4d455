//! Figure 4: distances between the forms of 30 shapes, and their maps.
//!
//! Measures, for `METHOD` in `NMDS`, `KPCA-Nystrom` and `SCALE` in `raw`, `normalized`:
//! `METHOD SCALE nn|ft|st|e|dcg|map|knn|silhouette|map silhouette`, and `SCALE SCORE gap`, the score of
//! NMDS less that of KPCA-Nystrom.

use std::time::Instant;

use anyhow::Result;
use descriptors::CanonicalForm;
use linalg::DistanceMatrix;
use nmds::normalized_stress;
use pipeline::{
    EmbedOptions, MatchOptions, Normalization, PreparedForms, embed, embedded_distances, form_distances,
    map_of,
};
use report::figure4::figure4;
use report::results::{Figure4Panel, Figure4Record, Scale, write};
use report::tables::figure4_table;
use retrieval::{Labels, evaluate, silhouette};

use crate::collection::map;
use crate::run::{Context, described};

/// Name of the paper's method in the record.
const NMDS: &str = "NMDS";

/// Name of the baseline.
const BASELINE: &str = "KPCA-Nystrom";

/// Runs the experiment, writes `figure4.json` and its pictures and prints the scores.
pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let start = Instant::now();
    let (seed, config) = (context.args.seed, &context.config);
    let methods = [(NMDS, config.nmds(seed)), (BASELINE, config.kernel_pca(seed))];
    let labels = context.collection.labels();
    let mut panels = Vec::new();
    for (method, options) in &methods {
        let forms = forms(context, options)?;
        for scale in [Scale::Raw, Scale::Normalized] {
            panels.push(panel(context, method, scale, &forms, &Labels::new(&labels))?);
        }
    }
    panels.sort_by_key(|panel| panel.scale);
    let options: Vec<_> = methods.iter().map(|(name, options)| (*name, options)).collect();
    let record = Figure4Record {
        expectations: context.check(|name| measured(&panels, name))?,
        analysis: config.analysis.trim().to_owned(),
        provenance: context.provenance(described(&options), start.elapsed()),
        names: context.collection.names(),
        labels,
        panels,
    };
    figure4(&record, context.output("figure4"))?;
    write(&record, context.output("figure4.json"))?;
    context.say(&figure4_table(&record))?;
    Ok(())
}

fn forms(context: &Context<'_>, options: &EmbedOptions) -> Result<Vec<CanonicalForm>> {
    map(&context.collection.all(), options.method.name(), context.observer, |shape| {
        Ok(embed(&shape.surface, options, &())?.form(&shape.surface)?)
    })
}

fn panel(
    context: &Context<'_>,
    method: &str,
    scale: Scale,
    forms: &[CanonicalForm],
    labels: &Labels,
) -> Result<Figure4Panel> {
    let normalization = match scale {
        Scale::Raw => Normalization::Raw,
        Scale::Normalized => Normalization::UnitArea,
    };
    let prepared = PreparedForms::new(forms, normalization)?;
    let distances = form_distances(&prepared, &MatchOptions::default(), context.observer)?;
    let plane = map_of(&distances)?;
    Ok(Figure4Panel {
        method: method.to_owned(),
        scale,
        matrix: rows(&distances),
        map: plane.coords.row_iter().map(|row| [row[0], row[1]]).collect(),
        map_stress: normalized_stress(&plane.coords, &distances),
        negative_mass: plane.negative_mass,
        scores: evaluate(&distances, labels, context.config.knn)?,
        map_silhouette: silhouette(&embedded_distances(&plane.coords)?, labels),
    })
}

fn rows(distances: &DistanceMatrix) -> Vec<Vec<f64>> {
    (0..distances.n_points()).map(|i| distances.row(i).to_vec()).collect()
}

/// Looks up a number by the name that configurations use.
fn measured(panels: &[Figure4Panel], name: &str) -> Option<f64> {
    let (head, rest) = name.split_once(' ')?;
    let score = |method: &str, scale: &str, score: &str| {
        let panel = panels.iter().find(|p| p.method == method && p.scale.name() == scale)?;
        Some(match score {
            "nn" => panel.scores.nn,
            "ft" => panel.scores.ft,
            "st" => panel.scores.st,
            "e" => panel.scores.e,
            "dcg" => panel.scores.dcg,
            "map" => panel.scores.map,
            "knn" => panel.scores.knn_accuracy,
            "silhouette" => panel.scores.silhouette,
            "map silhouette" => panel.map_silhouette,
            _ => return None,
        })
    };
    match rest.strip_suffix(" gap") {
        Some(name) => Some(score(NMDS, head, name)? - score(BASELINE, head, name)?),
        None => rest.split_once(' ').and_then(|(scale, name)| score(head, scale, name)),
    }
}
