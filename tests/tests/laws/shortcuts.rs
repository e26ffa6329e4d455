//! Laws of topological shortcuts: welds are found and cut, and clean shapes are left alone.

use canonform::{DescribeOptions, describe};
use datasets::{CreatureOptions, Damage, WeldPair, creature_plans, creatures};
use descriptors::ShapeMetric;
use mesh::{TriMesh, cut_shortcuts};
use rayon::prelude::*;

use crate::support::surface;

/// A body of every plan.
fn bodies(n_vertices: usize) -> Vec<TriMesh> {
    let n_families = creature_plans().len();
    let options = CreatureOptions { n_families, n_poses: 1, n_vertices, ..CreatureOptions::default() };
    creatures(&options).unwrap().into_iter().map(|shape| shape.mesh).collect()
}

#[test]
fn clean_creatures_have_no_shortcuts_and_their_welds_are_found() {
    let bodies = bodies(2000);
    bodies.par_iter().enumerate().for_each(|(i, mesh)| {
        let found = cut_shortcuts(mesh, &mesh.topology(), &()).unwrap().shortcuts;
        assert!(found.is_empty(), "body {i}: {found:?}");
    });
    // A handle as wide as the limb that it joins cannot be told from one by design.
    for (damage, least) in [
        (Damage::Weld(WeldPair::Near, 1), 0.95),
        (Damage::Weld(WeldPair::Random, 1), 0.95),
        (Damage::Contact(1), 0.7),
    ] {
        let found = |(i, mesh): (usize, &TriMesh)| {
            let damaged = damage.apply(mesh, i as u64);
            cut_shortcuts(&damaged, &damaged.topology(), &()).unwrap().shortcuts.len() == 1
        };
        let n_found = bodies.par_iter().enumerate().map(found).filter(|found| *found).count();
        let share = n_found as f64 / bodies.len() as f64;
        assert!(share >= least, "{damage}: {n_found} of {}", bodies.len());
    }
}

#[test]
fn a_welded_shape_is_described_like_the_clean_one() {
    let describe = |mesh: &TriMesh| describe(&surface(mesh), &DescribeOptions::default(), &()).unwrap();
    bodies(1000).par_iter().step_by(9).enumerate().for_each(|(i, mesh)| {
        let clean = describe(mesh);
        for pair in [WeldPair::Near, WeldPair::Random] {
            let damage = Damage::Weld(pair, 1);
            let welded = describe(&damage.apply(mesh, i as u64));
            let distance = ShapeMetric::fused(&clean.fused, &welded.fused);
            println!("{damage}, body {i}: {distance:.2}");
            assert!(distance < ShapeMetric::SAME_SHAPE.at, "{damage}, body {i}: {distance}");
        }
    });
}
