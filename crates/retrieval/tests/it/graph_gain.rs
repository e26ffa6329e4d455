//! Graph ranking is compared with the plain ranking on generated labelled sets.
//!
//! `cargo test -p canonform-retrieval --test it graph_gain -- --nocapture` prints the mean average precision of both on each
//! set.

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

    /// Gaussian classes of these sizes, `width` wide, whose centers have deviation 1.
    fn gaussian(random: &mut Random, sizes: &[usize], dim: usize, width: f64) -> Self {
        let mut set = Self::default();
        for (class, size) in sizes.iter().enumerate() {
            let center = random.point(dim);
            (0..*size).for_each(|_| set.add(random.around(&center, width), class));
        }
        set
    }

    /// Classes along arcs of a circle.
    fn chains(random: &mut Random, n_classes: usize, size: usize, noise: f64) -> Self {
        const DIM: usize = 8;
        let mut set = Self::default();
        for class in 0..n_classes {
            let (center, [a, b]) = (random.point(DIM), [0, 1].map(|_| random.point(DIM)));
            for i in 0..size {
                let (sin, cos) = (2.5 * i as f64 / size as f64).sin_cos();
                let on = center.iter().zip(a.iter().zip(&b)).map(|(x, (a, b))| x + 0.4 * (cos * a + sin * b));
                let on: Vec<f64> = on.collect();
                set.add(random.around(&on, noise), class);
            }
        }
        set
    }

    /// Groups of groups; a label is a group, or one of its parts.
    fn nested(random: &mut Random, width: f64, parts_are_classes: bool) -> Self {
        const DIM: usize = 12;
        let mut set = Self::default();
        for group in 0..8 {
            let center = random.point(DIM);
            for part in 0..5 {
                let within = random.around(&center, 0.35);
                let size = [3, 5, 6, 10, 20][(group + part) % 5];
                let class = if parts_are_classes { 5 * group + part } else { group };
                (0..size).for_each(|_| set.add(random.around(&within, width), class));
            }
        }
        set
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
                .filter_map(|i| Some(Scores::of_query(&rankings.ranking(i), i, &labels)?.map))
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
                let set = Set::gaussian(random, &sizes, dim, width);
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
            sets.push((format!("{name}, width {width}"), Set::gaussian(random, sizes, 12, width)));
        }
        let hubs = Set::gaussian(random, &[6; 40], 32, width).with_hubs(random);
        sets.push((format!("hubs, width {width}"), hubs));
    }
    for noise in [0.05, 0.15, 0.3] {
        for (n_classes, size) in [(8, 20), (5, 60), (30, 5)] {
            let set = Set::chains(random, n_classes, size, noise);
            sets.push((format!("chains of {size}, noise {noise}"), set));
        }
        sets.push((format!("parts of groups, width {noise}"), Set::nested(random, noise, true)));
        sets.push((format!("groups of parts, width {noise}"), Set::nested(random, noise, false)));
    }
    sets
}

/// The most mAP that the graph may lose. One pair of shapes that are no longer next to each other among 240 is 0.4 %, so this
/// is a bound for the mean over seeds.
const MAX_LOST: f64 = 0.005;

#[test]
fn the_graph_never_loses_more_than_half_a_percent() {
    const SEEDS: u64 = 4;
    let mut scores: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
    for seed in 1..=SEEDS {
        for (name, set) in sets(seed) {
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
