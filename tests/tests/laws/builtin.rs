//! Expected results on the built-in dataset.

use canonform::compare::form_alignments;
use canonform::embed::{FormOptions, embed};
use canonform::relations::Relation;
use canonform::rigid::Handedness;
use canonform::{DescribeOptions, describe};
use descriptors::{Boundary, Normalization, ShapeMetric, ShapePair};
use rayon::prelude::*;
use retrieval::{Labels, RankBy, evaluate};

use crate::support::{SHAPES, surface};

#[test]
fn canonical_forms_retrieve_their_families() {
    let shapes = &*SHAPES;
    let labels = Labels::new(&shapes.iter().map(|shape| shape.label.as_str()).collect::<Vec<_>>());
    let forms: Vec<_> = shapes
        .par_iter()
        .map(|shape| {
            let surface = surface(&shape.mesh);
            embed(&surface, &FormOptions::default(), &()).unwrap().form(&surface).unwrap()
        })
        .collect();
    let distances = form_alignments(&forms, Normalization::Raw, &()).unwrap();
    let scores = evaluate(&distances, &labels, 1, RankBy::Plain).unwrap();
    println!("{} shapes: NN {}, mAP {:.4}", scores.n, scores.plain.mean.nn, scores.plain.mean.map);
    assert_eq!((scores.n, scores.plain.mean.nn), (30, 1.0));
    assert!(scores.plain.mean.map >= 0.97, "mAP {}", scores.plain.mean.map);
}

#[test]
fn distances_distinguish_poses_from_families() {
    let shapes = &*SHAPES;
    let described: Vec<_> = shapes
        .par_iter()
        .map(|shape| {
            let description = describe(&surface(&shape.mesh), &DescribeOptions::default(), &());
            DescribeOptions::default().prepare(&description.unwrap()).unwrap()
        })
        .collect();
    let pairs: Vec<(usize, usize)> =
        (0..shapes.len()).flat_map(|i| (i + 1..shapes.len()).map(move |j| (i, j))).collect();
    let distances: Vec<_> = pairs
        .par_iter()
        .map(|&(i, j)| {
            let pair = ShapePair::new([&described[i], &described[j]]);
            let back = ShapePair::new([&described[j], &described[i]]);
            let [there, back] = [pair, back].map(|pair| pair.distance());
            let name = format!("{} {}", shapes[i].name, shapes[j].name);
            assert!((there.combined / back.combined - 1.0).abs() < 0.01, "{name}: {there:?} {back:?}");
            let [one, other] =
                [there, back].map(|found| Relation::by_distance(found, 1.0, Handedness::Unknown));
            assert!((one.confidence - other.confidence).abs() < 0.05, "{name}: {one:?} {other:?}");
            let is_family = shapes[i].label == shapes[j].label;
            assert_eq!(there.same_class() > 0.5, is_family, "{name}: {there:?}");
            assert_eq!(there.is_different(), !is_family, "{name}: {there:?}");
            (is_family, there)
        })
        .collect();
    let poses: Vec<_> =
        distances.iter().filter(|(is_family, _)| *is_family).map(|(_, found)| found).collect();
    // Bodies of rings and worms differ no more than their poses, so that no distance makes one shape certain.
    assert!(poses.iter().all(|found| found.same_shape() < Boundary::CERTAIN));
    let same = poses.iter().filter(|found| found.is_same_shape()).count();
    println!("{same} of {} pairs of poses are rather one shape than two", poses.len());
    assert!(2 * same > poses.len(), "{same} of {}", poses.len());
}

#[test]
fn the_guide_lists_the_limits_of_the_combined_distance() {
    let manual =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/guide/compare.md")).unwrap();
    let [near, far] = ShapeMetric::SAME_CLASS.gap().map(|limit| format!("{limit:.2}"));
    let shape = format!("{:.2}", ShapeMetric::SAME_SHAPE.at);
    for row in [
        format!("| below {shape} |"),
        format!("| {shape} to {near} |"),
        format!("| {near} to {far} |"),
        format!("| above {far} |"),
    ] {
        assert!(manual.contains(&row), "docs/guide/compare.md does not list `{row}`");
    }
}
