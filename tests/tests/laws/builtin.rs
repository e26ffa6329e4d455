//! Expected results on the built-in dataset.

use std::sync::LazyLock;

use canonform::compare::form_alignments;
use canonform::embed::signature;
use canonform::index::Shape;
use canonform::relations::Relation;
use canonform::rigid::Handedness;
use canonform::{DescribeOptions, describe};
use datasets::LabeledShape;
use descriptors::{Boundary, Normalization, PreparedShape, ShapeMetric, ShapePair, SignatureKind};
use rayon::prelude::*;
use retrieval::{Labels, RankBy, evaluate};

use crate::support::{SHAPES, surface, workspace_root};

/// The descriptions of all shapes, and ready to be compared.
static DESCRIBED: LazyLock<Vec<(Shape, PreparedShape)>> = LazyLock::new(|| {
    let options = DescribeOptions::default();
    let described = |shape: &LabeledShape| {
        let shape = describe(&surface(&shape.mesh), &options, &()).unwrap();
        let prepared = options.prepare(&shape).unwrap();
        (shape, prepared)
    };
    SHAPES.par_iter().map(described).collect()
});

#[test]
fn canonical_forms_retrieve_their_families() {
    let labels = Labels::new(&SHAPES.iter().map(|shape| shape.label.as_str()).collect::<Vec<_>>());
    let forms: Vec<_> = DESCRIBED.iter().map(|(_, shape)| shape.form.clone()).collect();
    let distances = form_alignments(&forms, Normalization::Raw, &()).unwrap();
    let scores = evaluate(&distances, &labels, 1, RankBy::Plain).unwrap();
    println!("{} shapes: NN {}, mAP {:.4}", scores.n, scores.plain.mean.nn, scores.plain.mean.map);
    assert_eq!((scores.n, scores.plain.mean.nn), (30, 1.0));
    assert!(scores.plain.mean.map >= 0.97, "mAP {}", scores.plain.mean.map);
}

#[test]
fn distances_distinguish_poses_from_families() {
    // Made before the threads below wait for them, which make them.
    let (shapes, described) = (&*SHAPES, &*DESCRIBED);
    let pairs: Vec<(usize, usize)> =
        (0..shapes.len()).flat_map(|i| (i + 1..shapes.len()).map(move |j| (i, j))).collect();
    let distances: Vec<_> = pairs
        .par_iter()
        .map(|&(i, j)| {
            let [there, back] =
                [[i, j], [j, i]].map(|pair| ShapePair::new(pair.map(|k| &described[k].1)).distance());
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
    let poses = distances.iter().filter(|(is_family, _)| *is_family).map(|(_, found)| found);
    let poses: Vec<_> = poses.collect();
    // Bodies of rings and worms differ no more than their poses, so that no distance makes one shape certain.
    assert!(poses.iter().all(|found| found.same_shape() < Boundary::CERTAIN));
    let same = poses.iter().filter(|found| found.is_same_shape()).count();
    println!("{same} of {} pairs of poses are rather one shape than two", poses.len());
    assert!(2 * same > poses.len(), "{same} of {}", poses.len());
}

#[test]
fn every_signature_separates_bodies_more_than_poses_and_triangulations() {
    for kind in SignatureKind::INTRINSIC {
        let signatures: Vec<_> = DESCRIBED.iter().map(|(shape, _)| signature(shape, kind).unwrap()).collect();
        let mean = |same: bool| {
            let pairs = (0..SHAPES.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            let found: Vec<f64> = pairs
                .filter(|(i, j)| (SHAPES[*i].label == SHAPES[*j].label) == same)
                .map(|(i, j)| signatures[i].distance(&signatures[j]))
                .collect();
            found.iter().sum::<f64>() / found.len() as f64
        };
        assert!(mean(false) > 2.0 * mean(true), "{}: {} {}", kind.name(), mean(true), mean(false));
    }
}

#[test]
fn the_guide_lists_the_limits_of_the_combined_distance() {
    let page = std::fs::read_to_string(workspace_root().join("docs/guide/compare.md")).unwrap();
    let ([near, far], shape) = (ShapeMetric::SAME_CLASS.gap(), ShapeMetric::SAME_SHAPE.at);
    for row in [format!("| {shape:.2} to {near:.2} |"), format!("| {near:.2} to {far:.2} |")] {
        assert!(page.contains(&row), "docs/guide/compare.md does not list `{row}`");
    }
}
