//! Figure 1: shapes beside their canonical forms.
//!
//! Measures `largest stress ratio`: the largest ratio of the stress to the squared spread of a form, which has no unit.

use anyhow::Result;
use canonform::{StressChoice, StressOptions, embed_and_measure};
use descriptors::{CanonicalForm, PreparedForm, Reflections, match_forms};
use mesh::{TriMesh, orient_consistently};
use report::figure1::{Figure1Pair, PAIRS, figure1};
use report::results::{Figure1Record, Figure1Shape};
use view::render::View;

use crate::collection::{Shape, map};
use crate::context::{Context, described};

/// Runs the experiment.
pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let options = context.config.nmds(context.seed);
    let stress = StressOptions { choice: StressChoice::Estimate, against: None, seed: context.seed };
    let shown = context.collection.first_of_each_class(PAIRS);
    let embedded = map(&shown, "figure 1", context.observer, |shape| {
        let embedded = embed_and_measure(&shape.surface, &options, &stress, &())?;
        let form = embedded.form(&shape.surface)?;
        let stress = embedded.report.stress.map_or(f64::NAN, |stress| stress.value);
        Ok((form, stress))
    })?;
    let forms = aligned(&shown, embedded.iter().map(|(form, _)| form))?;

    let facts: Vec<Figure1Shape> = shown
        .iter()
        .zip(&embedded)
        .map(|(shape, (_, stress))| Figure1Shape {
            name: shape.name.clone(),
            label: shape.label.clone(),
            n_vertices: shape.surface.mesh().n_vertices(),
            n_faces: shape.surface.mesh().n_faces(),
            stress: *stress,
            repair: shape.surface.repaired.report.summary(),
        })
        .collect();
    let worst = embedded.iter().map(|(form, stress)| stress / form.spread().powi(2)).fold(0.0, f64::max);
    let record = Figure1Record {
        expectations: context.check(|name| (name == "largest stress ratio").then_some(worst))?,
        analysis: context.analysis(),
        provenance: context.provenance(described(&[("embedding", &options)], stress.choice)),
        shapes: facts.clone(),
    };

    let shapes: Vec<TriMesh> = shown.iter().map(|shape| oriented(shape.surface.mesh().clone())).collect();
    let pairs: Vec<Figure1Pair<'_>> = facts
        .iter()
        .zip(shapes.iter().zip(&forms))
        .map(|(facts, (shape, form))| Figure1Pair { facts, shape, form })
        .collect();
    figure1(&pairs, &View::default())?.save(context.folder.join(context.name))?;
    context.publish(&record)
}

fn oriented(mut mesh: TriMesh) -> TriMesh {
    orient_consistently(&mut mesh);
    mesh
}

/// The forms as meshes, each aligned with the first one of its class.
fn aligned<'a>(shapes: &[&Shape], forms: impl Iterator<Item = &'a CanonicalForm>) -> Result<Vec<TriMesh>> {
    let mut first: Option<(&str, PreparedForm)> = None;
    let mut surfaces = Vec::new();
    for (shape, form) in shapes.iter().zip(forms) {
        let prepared = PreparedForm::new(form)?;
        let mut surface = form.to_mesh(shape.surface.mesh());
        match &first {
            Some((label, target)) if *label == shape.label => {
                let motion = match_forms(&prepared, target, Reflections::Allow).alignment;
                surface.positions.iter_mut().for_each(|p| *p = motion.apply(p));
            }
            _ => first = Some((&shape.label, prepared)),
        }
        surfaces.push(oriented(surface));
    }
    Ok(surfaces)
}
