//! Evidence: what is said of pairs of generated mechanical parts, of copies of them, and of pieces that were cut off.
//!
//! Measures `different called one surface` and `... above .9`, shares of the `pairs` of different parts; `true pairs denied`
//! of the `true pairs`; `variants named` of the `single changes`; `cuts recognized` of the `cuts`; and `largest error of
//! confidence`, over bins of at least [`FEWEST`] relations.

use anyhow::Result;
use canonform::relations::{Relation, RelationKind};
use datasets::Damage;
use descriptors::Sample;
use rayon::prelude::*;
use report::Record;

use crate::calibration::{LEFT, Truth, beyond_a_plane, geometry, of_parts, related, reliability};
use crate::context::Context;
use crate::sweep::{numbers, share};

/// Relations of a bin from which its share counts.
const FEWEST: f64 = 50.0;

pub(crate) fn evidence(context: &Context<'_>) -> Result<Record> {
    let pairs = of_parts(context.seed, context.options.parts, context.options.treated, &());
    let (copies, told): (Vec<_>, Vec<_>) = pairs.iter().partition(|pair| pair.truth == Truth::Same);
    let single: Vec<_> = told.iter().filter(|pair| pair.truth == Truth::OneChange).collect();
    let cuts = cuts(context);
    let said: Vec<Sample> = pairs.iter().map(|pair| (pair.said.confidence, pair.is_right(), 1.0)).collect();
    let bins = reliability(&said).into_iter().filter(|[n, ..]| *n >= FEWEST);
    let error = bins.map(|[_, stated, truth]| (stated - truth).abs()).fold(0.0, f64::max);
    let called_one =
        |least: f64| share(&told, |pair| pair.said.kind.is_one_surface() && pair.said.confidence > least);
    let measured = numbers([
        ("pairs", told.len() as f64),
        ("different called one surface", called_one(f64::NEG_INFINITY)),
        ("different called one surface above .9", called_one(0.9)),
        ("true pairs", copies.len() as f64),
        ("true pairs denied", share(&copies, |pair| !pair.is_right())),
        ("single changes", single.len() as f64),
        ("variants named", share(&single, |pair| pair.said.kind == RelationKind::Variant)),
        ("cuts", cuts.len() as f64),
        ("cuts recognized", share(&cuts, |told| told.kind == RelationKind::PartOf)),
        ("largest error of confidence", error),
    ]);
    Ok(context.record(&[], measured))
}

/// Shapes of the collection beside pieces of them, moved.
fn cuts(context: &Context<'_>) -> Vec<Relation> {
    let shapes = context.collection.first_of_each_class(1);
    let cases: Vec<_> =
        shapes.iter().flat_map(|shape| LEFT.map(|left| (shape.surface.mesh(), left))).collect();
    let told = cases.into_par_iter().filter_map(|(mesh, left)| {
        let piece = Damage::Move.apply(&beyond_a_plane(mesh, left), 7);
        Some(related(&geometry(mesh)?, &geometry(&piece)?))
    });
    told.collect()
}

#[cfg(test)]
mod tests {
    use canonform::relations::MeshGeometry;
    use datasets::{MechanicalPart, PartMesh, mechanical_parts};

    use super::*;

    #[test]
    fn arcs_do_not_explain_a_difference_of_vertices() {
        let pipes: Vec<MechanicalPart> = mechanical_parts(0, 400)
            .into_iter()
            .filter(|part| part.name().starts_with("bent-pipe-d20-t1.5-r3"))
            .take(4)
            .collect();
        let geometries: Vec<MeshGeometry> =
            pipes.iter().map(|pipe| geometry(&pipe.mesh(&PartMesh::default())).unwrap()).collect();
        assert!(pipes.len() > 2);
        for (i, a) in pipes.iter().enumerate() {
            for (j, b) in pipes.iter().enumerate().take(i) {
                let told = related(&geometries[i], &geometries[j]);
                assert!(!told.kind.is_one_surface(), "{}, {}: {told}", a.name(), b.name());
            }
        }
    }
}
