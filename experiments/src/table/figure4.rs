//! Figure 4: distances between the canonical forms of 30 shapes, and their maps.
//!
//! Measures, for `METHOD` in `NMDS`, `KPCA-Nystrom` and `SCALE` in `raw`, `normalized`, and for these and `Sammon` in 16
//! dimensions with the scale `spectrum`: `METHOD SCALE nn|ft|st|e|dcg|mAP|knn|silhouette|2D silhouette`, and `SCALE SCORE gap`,
//! the score of NMDS minus that of KPCA-Nystrom.

use anyhow::{Context as _, Result};
use canonform::compare::{embedded_distances, form_alignments};
use canonform::embed::{EmbedMethod, FormOptions, embed};
use descriptors::{CanonicalForm, Normalization};
use geodesics::{FastMarchingOptions, Method, ObtuseTreatment};
use linalg::DistanceMatrix;
use nmds::{Bandwidth, classical_full, normalized_stress};
use rayon::prelude::*;
use report::results::{Figure4Panel, Figure4Results, Motions, SHAPES_FILE, Scale, ShapesRecord, write};
use retrieval::{Labels, evaluate, silhouette};
use serde::Deserialize;

use crate::collection::map;
use crate::context::Context;
use crate::experiment::Experiment;
use crate::specimen::{describing, low_rank};
use crate::surfaces::{Formed, motions, shown, vertex_limit};
use crate::sweep::{MeasuredNumbers, best_e, named};
use crate::table::forms::FormMaker;

/// Name of the paper's method in the record.
const NMDS: &str = "NMDS";

const BASELINE: &str = "KPCA-Nystrom";

/// Names of the methods in many dimensions.
const MANY: [(FormMaker, &str); 3] =
    [(FormMaker::ManyNmds, NMDS), (FormMaker::ManySammon, "Sammon"), (FormMaker::ManyKernelPca, BASELINE)];

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Figure4Options {
    samples: usize,
    rank: usize,
    /// Treatment of obtuse triangles in fast marching.
    obtuse: ObtuseTreatment,
    /// Number of nearest neighbours that vote.
    voters: usize,
}

impl Experiment for Figure4Options {
    /// Runs the experiment, which also writes `figure4-shapes.json`.
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let marching = FastMarchingOptions { obtuse: self.obtuse, ..FastMarchingOptions::default() };
        let nmds = FormOptions {
            geodesic: Method::FastMarching(marching),
            ..low_rank(self.samples, self.rank, context.seed)
        };
        let method = EmbedMethod::KernelPca { rank: Some(self.rank), bandwidth: Bandwidth::Mean };
        let methods = [(NMDS, nmds.clone()), (BASELINE, FormOptions { method, ..nmds })];
        let labels = context.collection.labels();
        let classes = Labels::new(&labels);
        let (mut panels, mut formed, mut moved) = (Vec::new(), Vec::new(), Vec::new());
        let mut distances = Vec::new();
        for (method, options) in &methods {
            let made = map(&context.collection.all(), options.method.name(), context.observer, |shape| {
                let embedded = embed(&shape.surface, options, &())?;
                Ok((Formed::new(shape, &embedded)?, embedded.distances))
            })?;
            let (made, of_method): (Vec<_>, _) = made.into_iter().unzip();
            // Those of both methods are the same.
            distances = of_method;
            let forms: Vec<CanonicalForm> = made.iter().map(|made| made.form.clone()).collect();
            let scales = [(Scale::Raw, Normalization::Raw), (Scale::Normalized, Normalization::UnitArea)];
            for (scale, normalization) in scales {
                let matches = form_alignments(&forms, normalization, context.observer)?;
                panels.push(self.panel(method, scale, &matches.distances, &classes)?);
                moved.push(motions(method, scale, &made, &matches.alignments));
            }
            formed.push(made);
        }
        for (maker, name) in MANY {
            let spectra =
                context.collection.all().into_par_iter().zip(&distances).map(|(shape, distances)| {
                    let (form, unit) = maker.of_many_dimensions(distances, shape.surface.mesh())?;
                    Ok(form.spectrum(unit)?)
                });
            let spectra = spectra.collect::<Result<Vec<_>>>()?;
            let between = |i: usize, j: usize| spectra[i].distance(&spectra[j]);
            let distances = DistanceMatrix::from_pairs(spectra.len(), between)?;
            panels.push(self.panel(name, Scale::Spectrum, &distances, &classes)?);
        }
        panels.sort_by_key(|panel| panel.scale);
        let [nmds, baseline] = methods.clone().map(|(_, options)| describing(options));
        let provenance = context.provenance(&[(NMDS, &nmds), (BASELINE, &baseline)]);
        write(&shapes(context, &methods, &formed, moved)?, context.folder.join(SHAPES_FILE))?;
        let measured = measured(&panels);
        let best_e = Some(best_e(&classes)?);
        let results = Figure4Results { names: context.collection.names(), labels, best_e, panels };
        context.publish(results, provenance, &measured)
    }
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

impl Figure4Options {
    fn panel(
        &self,
        method: &str,
        scale: Scale,
        distances: &DistanceMatrix,
        labels: &Labels,
    ) -> Result<Figure4Panel> {
        let plane = classical_full(distances, 2)?;
        Ok(Figure4Panel {
            method: method.to_owned(),
            scale,
            matrix: (0..distances.n_points()).map(|i| distances.row(i).to_vec()).collect(),
            map: plane.coords.row_iter().map(|row| [row[0], row[1]]).collect(),
            map_stress: normalized_stress(&plane.coords, distances),
            negative_mass: plane.negative_mass,
            scores: evaluate(distances, labels, self.voters)?,
            map_silhouette: silhouette(&embedded_distances(&plane.coords)?, labels),
        })
    }
}

/// Numbers by their names in the configuration.
fn measured(panels: &[Figure4Panel]) -> MeasuredNumbers {
    let mut found = MeasuredNumbers::new();
    for panel in panels {
        let own = [
            ("knn", panel.scores.knn_accuracy),
            ("silhouette", panel.scores.silhouette),
            ("2D silhouette", panel.map_silhouette),
        ];
        let scale = panel.scale.name();
        let sign = f64::from(panel.method == NMDS) - f64::from(panel.method == BASELINE);
        for (score, value) in named(&panel.scores.mean).into_iter().chain(own) {
            found.insert(format!("{} {scale} {score}", panel.method), value);
            *found.entry(format!("{scale} {score} gap")).or_default() += sign * value;
        }
    }
    found
}
