//! Graph ranking is compared with the plain ranking on generated labelled sets.
//!
//! `cargo test -p canonform-retrieval --test it graph_gain -- --nocapture --include-ignored` prints the mean average precision
//! of both on each set.

use std::collections::BTreeMap;

use canonform_retrieval::{GraphRankings, Labels, Rankings, Scores};
use linalg::DistanceMatrix;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;

/// Points with classes.
#[derive(Default)]
struct Set {
    points: Vec<Vec<f64>>,
    classes: Vec<String>,
}

struct Random(ChaCha8Rng);

impl Random {
    fn uniform(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// A point around `center`, with this deviation of each coordinate.
    fn around(&mut self, center: &[f64], width: f64) -> Vec<f64> {
        center.iter().map(|x| x + width * self.normal()).collect()
    }

    fn point(&mut self, dim: usize) -> Vec<f64> {
        self.around(&vec![0.0; dim], 1.0)
    }
}

impl Set {
    fn add(&mut self, point: Vec<f64>, class: usize) {
        self.points.push(point);
        self.classes.push(class.to_string());
    }

    /// Gaussian parts of these sizes, `width` wide, around the centers of their groups, which have deviation 1. A class is a part,
    /// or a group.
    fn clusters(
        random: &mut Random,
        groups: &[Vec<usize>],
        dim: usize,
        [within, width]: [f64; 2],
        parts_are_classes: bool,
    ) -> Self {
        let (mut set, mut part) = (Self::default(), 0);
        for (group, sizes) in groups.iter().enumerate() {
            let center = random.point(dim);
            for size in sizes {
                let center = random.around(&center, within);
                let class = if parts_are_classes { part } else { group };
                (0..*size).for_each(|_| set.add(random.around(&center, width), class));
                part += 1;
            }
        }
        set
    }

    /// Classes of these sizes.
    fn classes(random: &mut Random, sizes: &[usize], dim: usize, width: f64) -> Self {
        let groups: Vec<Vec<usize>> = sizes.iter().map(|size| vec![*size]).collect();
        Self::clusters(random, &groups, dim, [0.0, width], true)
    }

    /// Points whose lengths vary: those near the origin are near to many.
    fn with_hubs(mut self, random: &mut Random) -> Self {
        for point in &mut self.points {
            let length = -(0.5 * (random.uniform().ln() + random.uniform().ln()));
            point.iter_mut().for_each(|x| *x *= length);
        }
        self
    }

    /// Mean average precision by distance and on the graph, over all shapes that are not alone.
    fn scored(&self) -> [f64; 2] {
        let distances = DistanceMatrix::from_pairs(self.points.len(), |i, j| {
            let [a, b] = [&self.points[i], &self.points[j]];
            a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
        })
        .expect("distances are finite");
        let labels = Labels::new(&self.classes);
        let mean = |rankings: &dyn Rankings| {
            let scores: Vec<f64> = (0..self.points.len())
                .into_par_iter()
                .filter_map(|i| Some(Scores::for_query(&rankings.ranking(i), i, &labels)?.map))
                .collect();
            scores.iter().sum::<f64>() / scores.len() as f64
        };
        [mean(&distances), mean(&GraphRankings::new(&distances))]
    }
}

fn sets(seed: u64) -> Vec<(String, Set)> {
    let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
    let random = &mut random;
    let mut sets = Vec::new();
    for (dim, widths) in [(4, [0.1, 0.15, 0.25]), (8, [0.25, 0.4, 0.6]), (32, [0.4, 0.7, 1.0])] {
        for size in [2, 3, 5, 10, 20, 40] {
            for width in widths {
                let sizes = vec![size; (240 / size).max(8)];
                let set = Set::classes(random, &sizes, dim, width);
                sets.push((format!("classes of {size}, {dim} dimensions, width {width}"), set));
            }
        }
    }
    let mixed: Vec<usize> = [(2, 20), (3, 15), (5, 10), (10, 5), (20, 4), (40, 2)]
        .iter()
        .flat_map(|(size, n)| vec![*size; *n])
        .collect();
    let huge = [&[200][..], &[3; 20], &[5; 10]].concat();
    let alone = [&[1; 150][..], &[3; 15], &[5; 10]].concat();
    for width in [0.3, 0.5, 0.7] {
        for (name, sizes) in [("mixed sizes", &mixed), ("one huge class", &huge), ("most alone", &alone)] {
            sets.push((format!("{name}, width {width}"), Set::classes(random, sizes, 12, width)));
        }
        let hubs = Set::classes(random, &[6; 40], 32, width).with_hubs(random);
        sets.push((format!("hubs, width {width}"), hubs));
    }
    let parts = [3, 5, 6, 10, 20];
    let groups: Vec<Vec<usize>> =
        (0..8).map(|group| (0..5).map(|i| parts[(group + i) % 5]).collect()).collect();
    for width in [0.05, 0.15, 0.3] {
        for (name, parts_are_classes) in [("parts of groups", true), ("groups of parts", false)] {
            let set = Set::clusters(random, &groups, 12, [0.35, width], parts_are_classes);
            sets.push((format!("{name}, width {width}"), set));
        }
    }
    sets
}

/// The most mAP that the graph may lose. One pair of shapes that are no longer next to each other among 240 is 0.4 %, so this
/// is a bound for the mean over seeds.
const MAX_LOST: f64 = 0.005;

#[test]
fn the_graph_never_loses_more_than_half_a_percent() {
    compare(4);
}

#[test]
#[ignore = "slow: make test-all"]
fn the_graph_never_loses_more_than_half_a_percent_on_any_set() {
    compare(1);
}

/// Asserts that the graph gains on average, and loses little on any of the sets, of which every `step`th is tried.
fn compare(step: usize) {
    const SEEDS: u64 = 4;
    let mut scores: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
    for seed in 1..=SEEDS {
        for (name, set) in sets(seed).into_iter().step_by(step) {
            scores.entry(name).or_default().push(set.scored());
        }
    }
    let mut gains = Vec::new();
    for (name, scores) in &scores {
        let [plain, graph] = [0, 1].map(|i| scores.iter().map(|s| s[i]).sum::<f64>() / SEEDS as f64);
        println!("{name}: plain {plain:.4}, graph {graph:.4} ({:+.4})", graph - plain);
        gains.push(graph - plain);
    }
    let mean = gains.iter().sum::<f64>() / gains.len() as f64;
    println!("{} kinds of sets: mean {mean:+.4}", gains.len());
    assert!(gains.iter().all(|gain| *gain >= -MAX_LOST) && mean > 0.015, "{mean} {gains:?}");
}
