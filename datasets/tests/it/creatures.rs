//! Laws of the creatures.

use std::collections::HashSet;
use std::sync::LazyLock;

use canonform_datasets::{
    CreatureOptions, LabeledShape, PartMesh, creature_body, creature_plans, creatures, mechanical_parts,
};
use mesh::{TriMesh, validate};
use rayon::prelude::*;
use testkit::on_threads;

use crate::is_clean;

fn options(n_families: usize, n_poses: usize) -> CreatureOptions {
    CreatureOptions { n_families, n_poses, n_vertices: 1000, ..CreatureOptions::default() }
}

/// Two bodies of every plan.
static SHAPES: LazyLock<Vec<LabeledShape>> =
    LazyLock::new(|| creatures(&options(2 * creature_plans().len(), 1)).unwrap());

#[test]
fn parts_are_mechanical_and_bodies_are_not() {
    let is_mechanical = |mesh: &TriMesh| mesh::SmoothRegions::of(mesh).is_mechanical;
    for part in mechanical_parts(0, 320).iter().step_by(7) {
        assert!(is_mechanical(&part.mesh(&PartMesh::default())), "{}", part.name());
    }
    for shape in &SHAPES[..CreatureOptions::default().n_families] {
        assert!(!is_mechanical(&shape.mesh), "{}", shape.name);
    }
}

#[test]
fn creatures_are_clean_surfaces_of_their_own_with_the_handles_of_their_plans() {
    let (n_plans, shapes) = (creature_plans().len(), &*SHAPES);
    for shape in shapes {
        let report = validate(&shape.mesh);
        let handles = match shape.label.trim_end_matches('B') {
            "ring" | "cup" | "key" => 1,
            "glasses" | "scissors" => 2,
            _ => 0,
        };
        assert!(is_clean(&report) && report.genus == Some(handles), "{}: {report:?}", shape.name);
        assert_eq!(report.n_vertices, 1000);
        assert!(shape.mesh.signed_volume() > 0.0, "{} is inside out", shape.name);
        assert!((report.area / 18_000.0 - 1.0).abs() < 0.15, "{}: area {}", shape.name, report.area);
    }
    let labels: HashSet<&str> = shapes.iter().map(|shape| shape.label.as_str()).collect();
    assert_eq!(labels.len(), 2 * n_plans);
    assert_eq!((shapes[0].label.as_str(), shapes[n_plans].label.as_str()), ("worm", "wormB"));
    // All have one area, so bodies of other proportions have other volumes or reach less far.
    for (first, second) in shapes.iter().zip(&shapes[n_plans..]) {
        let [a, b] = [first, second].map(|shape| {
            let [low, high] = shape.mesh.bounds().unwrap();
            [shape.mesh.signed_volume(), (high - low).norm()]
        });
        let change = a.iter().zip(&b).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        assert!(change > 0.02, "{} and {}: {change}", first.name, second.name);
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn bytes_depend_on_the_seed_and_not_on_threads_or_the_number_of_families() {
    let few = options(4, 2);
    let all = on_threads(2, || creatures(&few)).unwrap();
    assert_eq!(on_threads(1, || creatures(&few)).unwrap(), all);
    assert_eq!(creature_body(3, 0, 1, &options(40, 8), &()).unwrap(), all[7]);
    let other = CreatureOptions { seed: 2, ..few };
    assert_ne!(creature_body(3, 0, 1, &other, &()).unwrap().mesh, all[7].mesh);
}

#[test]
#[ignore = "slow: make test-all"]
fn every_seed_gives_bodies() {
    (2..8u64).into_par_iter().for_each(|seed| {
        let options = CreatureOptions { seed, ..options(2 * creature_plans().len(), 1) };
        let shapes = creatures(&options).unwrap();
        assert!(shapes.iter().all(|shape| is_clean(&validate(&shape.mesh))), "seed {seed}");
    });
}
