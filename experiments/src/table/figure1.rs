//! Figure 1: shapes beside their canonical forms.
//!
//! Measures `largest stress ratio`: the largest ratio of the stress to the squared spread of a form, which has no unit.

use anyhow::Result;
use canonform::embed::{EmbedOptions, StressChoice, StressOptions, embed};
use descriptors::CanonicalForm;
use mesh::TriMesh;
use report::results::{Figure1Results, Figure1Shape};
use serde::Deserialize;

use crate::collection::{LabeledSurface, map};
use crate::context::Context;
use crate::experiment::Experiment;
use crate::specimen::{describing, low_rank};
use crate::surfaces::{aligned, oriented};
use crate::sweep::numbers;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Figure1Options {
    samples: usize,
    rank: usize,
}

impl Experiment for Figure1Options {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let options = low_rank(self.samples, self.rank, context.seed);
        let stress = StressOptions { choice: StressChoice::Estimate, against: None, seed: context.seed };
        let shown = context.collection.first_of_each_class(Figure1Results::PAIRS);
        let embedded = map(&shown, "figure 1", context.observer, |shape| {
            let embedded = embed(&shape.surface, EmbedOptions::from(&options).stress(stress), &())?;
            let form = embedded.form(&shape.surface)?;
            let stress = embedded.report.stress.map_or(f64::NAN, |stress| stress.value);
            Ok((form, stress))
        })?;
        let forms = pictured(&shown, embedded.iter().map(|(form, _)| form))?;

        let facts: Vec<Figure1Shape> = shown
            .iter()
            .zip(&embedded)
            .map(|(shape, (_, stress))| Figure1Shape {
                name: shape.name.clone(),
                label: shape.label.clone(),
                n_vertices: shape.surface.mesh().n_vertices(),
                n_faces: shape.surface.mesh().n_faces(),
                stress: *stress,
                repair: shape.surface.input.report.summary(),
            })
            .collect();
        let worst = embedded.iter().map(|(form, stress)| stress / form.spread().powi(2)).fold(0.0, f64::max);
        let provenance = context.provenance(&[("embedding", &describing(options))]);

        let shapes: Vec<TriMesh> = shown.iter().map(|shape| oriented(shape.surface.mesh())).collect();
        let results = Figure1Results { shapes: facts };
        results.tiles(&shapes, &forms)?.save(context.folder.join(context.name))?;
        let measured = numbers([("largest stress ratio", worst)]);
        context.publish(results, provenance, &measured)
    }
}

/// The forms as meshes, each aligned with the first one of its class.
fn pictured<'a>(
    shapes: &[&LabeledSurface],
    forms: impl Iterator<Item = &'a CanonicalForm>,
) -> Result<Vec<TriMesh>> {
    let (mut class, mut first) = ("", None);
    let mut surfaces = Vec::new();
    for (shape, form) in shapes.iter().zip(forms) {
        if class != shape.label {
            (class, first) = (shape.label.as_str(), None);
        }
        surfaces.push(aligned(form, shape.surface.mesh(), &mut first)?);
    }
    Ok(surfaces)
}
