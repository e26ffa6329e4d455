//! How many samples are enough: `-n auto` stops where it should, and says how sure it is.

use canonform::Surface;
use canonform::embed::{Embedded, FormOptions, Samples, StressChoice};
use datasets::{CreatureOptions, creature_body, creature_plans};
use mesh::TriMesh;
use nmds::stress;
use rayon::prelude::*;

use crate::support::{all_pairs, surface};

/// The first body of a plan, with this many vertices.
fn of_plan(plan: usize, n_vertices: usize) -> TriMesh {
    let options = CreatureOptions { n_vertices, ..CreatureOptions::default() };
    creature_body(plan, 0, 0, &options, &()).unwrap().mesh
}

fn measured(surface: &Surface, seed: u64) -> Embedded {
    let options = FormOptions { samples: Samples::Auto, seed, ..FormOptions::default() };
    crate::support::measured(surface, &options, StressChoice::Auto)
}

/// 25 bodies and 4 seeds; beyond 1,000 vertices, where the stress is estimated.
#[test]
#[ignore = "slow: make test-all"]
fn intervals_after_a_search_contain_the_exact_stress_as_often_as_they_say() {
    let found: Vec<[bool; 2]> = (0..25)
        .into_par_iter()
        .flat_map(|plan| {
            let surface = surface(&of_plan(plan, 1010));
            let distances = all_pairs(&surface);
            let of_seed = |seed| {
                let embedded = measured(&surface, seed);
                let exact = stress(&embedded.embedding.coords, &distances).unwrap();
                let report = embedded.report.stress.unwrap();
                let within = |[low, high]: [f64; 2], value| (low..=high).contains(&value);
                [within(report.normalized_interval, exact.normalized), within(report.interval, exact.value)]
            };
            (0..4).map(of_seed).collect::<Vec<_>>()
        })
        .collect();
    let [normalized, paper] = [0, 1].map(|i| found.iter().filter(|hit| hit[i]).count());
    println!("of {} searches: normalized stress in its interval {normalized}, stress {paper}", found.len());
    assert_eq!(found.len(), 100);
    assert!(normalized >= 95 && paper >= 95, "{normalized} {paper}");
}

/// Twice the samples that are enough prove that they are.
#[test]
fn few_samples_are_enough_for_a_star_and_for_david() {
    let enough = |surface: &Surface| {
        let found = measured(surface, 0).report;
        (found.n_samples, found.auto.unwrap().sufficient)
    };
    let star = creature_plans().iter().position(|plan| *plan == "star").unwrap();
    let (n, sufficient) = enough(&surface(&of_plan(star, 3400)));
    println!("star: {sufficient} samples are enough, {n} taken");
    assert!((8..=20).contains(&sufficient) && n <= 40, "{sufficient} of {n}");
    let Some(data) = testkit::data("") else { return };
    let path = data.join("tosca-lowres").join("david0.vert");
    let (n, sufficient) =
        enough(&canonform::read_surface(&path, &Default::default(), &Default::default(), &()).unwrap());
    println!("david0: {sufficient} samples are enough, {n} taken");
    assert!(sufficient <= 12 && n <= 24, "{sufficient} of {n}");
}
