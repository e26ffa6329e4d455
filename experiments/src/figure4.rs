//! Figure 4: distances between the canonical forms of 30 shapes, and their maps.
//!
//! Measures, for `METHOD` in `NMDS`, `KPCA-Nystrom` and `SCALE` in `raw`, `normalized`:
//! `METHOD SCALE nn|ft|st|e|dcg|map|knn|silhouette|map silhouette`, and `SCALE SCORE gap`, the score of NMDS minus
//! that of KPCA-Nystrom.

use anyhow::{Context as _, Result};
use canonform::{FormMatches, FormOptions, StressChoice, embed, embedded_distances, form_matches};
use descriptors::{CanonicalForm, Normalization};
use linalg::DistanceMatrix;
use nmds::{classical_full, normalized_stress};
use rayon::prelude::*;
use report::results::{Figure4Panel, Figure4Record, Motions, SHAPES_FILE, Scale, ShapesRecord, write};
use retrieval::{Labels, evaluate, silhouette};

use crate::collection::map;
use crate::context::{Context, described};
use crate::surfaces::{Formed, motions, shown, vertex_limit};

/// Name of the paper's method in the record.
const NMDS: &str = "NMDS";

/// Name of the baseline.
const BASELINE: &str = "KPCA-Nystrom";

/// Runs the experiment, which also writes `figure4-shapes.json`.
pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let (seed, config) = (context.seed, &context.config);
    let methods = [(NMDS, config.nmds(seed)), (BASELINE, config.kernel_pca(seed))];
    let labels = context.collection.labels();
    let classes = Labels::new(&labels);
    let (mut panels, mut formed, mut moved) = (Vec::new(), Vec::new(), Vec::new());
    for (method, options) in &methods {
        let made = formed_by(context, options)?;
        let forms: Vec<CanonicalForm> = made.iter().map(|made| made.form.clone()).collect();
        for scale in [Scale::Raw, Scale::Normalized] {
            let matches = matches(context, scale, &forms)?;
            panels.push(panel(context, method, scale, &matches.distances, &classes)?);
            moved.push(motions(method, scale, &made, &matches.alignments));
        }
        formed.push(made);
    }
    panels.sort_by_key(|panel| panel.scale);
    let options: Vec<_> = methods.iter().map(|(name, options)| (*name, options)).collect();
    let record = Figure4Record {
        expectations: context.check(|name| measured(&panels, name))?,
        analysis: context.analysis(),
        provenance: context.provenance(described(&options, StressChoice::Skip)),
        names: context.collection.names(),
        labels,
        panels,
    };
    write(&shapes(context, &methods, &formed, moved)?, context.folder.join(SHAPES_FILE))?;
    context.publish(&record)
}

fn formed_by(context: &Context<'_>, options: &FormOptions) -> Result<Vec<Formed>> {
    map(&context.collection.all(), options.method.name(), context.observer, |shape| {
        Formed::new(shape, &embed(&shape.surface, options, &())?)
    })
}

/// The surfaces for the 3D views of the page.
fn shapes(
    context: &Context<'_>,
    methods: &[(&str, FormOptions)],
    formed: &[Vec<Formed>],
    motions: Vec<Motions>,
) -> Result<ShapesRecord> {
    let all = context.collection.all();
    let limit = vertex_limit(all.len());
    let (_, options) = &methods[0];
    context.observer.begin("surfaces", all.len());
    let one = |i: usize| {
        let forms: Vec<&Formed> = formed.iter().map(|of_method| &of_method[i]).collect();
        let shape = shown(all[i], &forms, options, limit).with_context(|| all[i].name.clone());
        context.observer.step();
        shape
    };
    Ok(ShapesRecord {
        methods: methods.iter().map(|(name, _)| (*name).to_owned()).collect(),
        shapes: (0..all.len()).into_par_iter().map(one).collect::<Result<_>>()?,
        motions,
    })
}

fn matches(context: &Context<'_>, scale: Scale, forms: &[CanonicalForm]) -> Result<FormMatches> {
    let normalization = match scale {
        Scale::Raw => Normalization::Raw,
        Scale::Normalized => Normalization::UnitArea,
    };
    Ok(form_matches(forms, normalization, context.observer)?)
}

fn panel(
    context: &Context<'_>,
    method: &str,
    scale: Scale,
    distances: &DistanceMatrix,
    labels: &Labels,
) -> Result<Figure4Panel> {
    let plane = classical_full(distances, 2)?;
    Ok(Figure4Panel {
        method: method.to_owned(),
        scale,
        matrix: rows(distances),
        map: plane.coords.row_iter().map(|row| [row[0], row[1]]).collect(),
        map_stress: normalized_stress(&plane.coords, distances),
        negative_mass: plane.negative_mass,
        scores: evaluate(distances, labels, context.config.knn)?,
        map_silhouette: silhouette(&embedded_distances(&plane.coords)?, labels),
    })
}

fn rows(distances: &DistanceMatrix) -> Vec<Vec<f64>> {
    (0..distances.n_points()).map(|i| distances.row(i).to_vec()).collect()
}

/// A number by its name in the configuration.
fn measured(panels: &[Figure4Panel], name: &str) -> Option<f64> {
    let (head, rest) = name.split_once(' ')?;
    let score = |method: &str, scale: &str, score: &str| {
        let panel = panels.iter().find(|p| p.method == method && p.scale.name() == scale)?;
        Some(match score {
            "nn" => panel.scores.mean.nn,
            "ft" => panel.scores.mean.ft,
            "st" => panel.scores.mean.st,
            "e" => panel.scores.mean.e,
            "dcg" => panel.scores.mean.dcg,
            "map" => panel.scores.mean.map,
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
