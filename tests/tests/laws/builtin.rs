//! Expected results on the built-in dataset.

use canonform::{DescribeOptions, FormOptions, describe, embed, form_matches};
use datasets::{ArticulatedOptions, articulated};
use descriptors::{Normalization, ShapeMetric, ShapePair};
use rayon::prelude::*;
use retrieval::{Labels, evaluate};

use crate::support::surface;

#[test]
fn canonical_forms_retrieve_their_families() {
    let options = ArticulatedOptions { n_vertices: 1000, ..ArticulatedOptions::default() };
    let shapes = articulated(&options).unwrap();
    let labels = Labels::new(&shapes.iter().map(|shape| shape.label.as_str()).collect::<Vec<_>>());
    let forms: Vec<_> = shapes
        .par_iter()
        .map(|shape| {
            let surface = surface(&shape.mesh);
            embed(&surface, &FormOptions::default(), &()).unwrap().form(&surface).unwrap()
        })
        .collect();
    let distances = form_matches(&forms, Normalization::Raw, &()).unwrap().distances;
    let scores = evaluate(&distances, &labels, 1).unwrap();
    println!("{} shapes: NN {}, mAP {:.4}", scores.n, scores.mean.nn, scores.mean.map);
    assert_eq!((scores.n, scores.mean.nn), (30, 1.0));
    assert!(scores.mean.map >= 0.97, "mAP {}", scores.mean.map);
}

#[test]
fn verdicts_distinguish_poses_from_families() {
    let options = ArticulatedOptions { n_vertices: 1000, ..ArticulatedOptions::default() };
    let shapes = articulated(&options).unwrap();
    let described: Vec<_> = shapes
        .par_iter()
        .map(|shape| {
            let description = describe(&surface(&shape.mesh), &DescribeOptions::default());
            description.and_then(|description| description.prepare()).unwrap()
        })
        .collect();
    let pairs: Vec<(usize, usize)> =
        (0..shapes.len()).flat_map(|i| (i + 1..shapes.len()).map(move |j| (i, j))).collect();
    pairs.par_iter().for_each(|&(i, j)| {
        let pair = [&described[i], &described[j]];
        let distance = ShapePair::new(ShapeMetric::default(), pair).distance();
        let is_family = shapes[i].label == shapes[j].label;
        assert_eq!(
            ShapeMetric::is_same(distance),
            is_family,
            "{} {} {distance:?}",
            shapes[i].name,
            shapes[j].name
        );
    });
}
