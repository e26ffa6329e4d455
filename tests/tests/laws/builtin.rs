//! What the built-in dataset must come out as.

use datasets::{ArticulatedOptions, articulated};
use pipeline::{
    EmbedOptions, MatchOptions, Normalization, PreparedForms, StressChoice, embed, form_distances,
};
use rayon::prelude::*;
use retrieval::{Labels, evaluate};

use crate::support::surface;

#[test]
fn forms_of_the_built_in_shapes_find_their_families() {
    let options = ArticulatedOptions { n_vertices: 1000, ..ArticulatedOptions::default() };
    let shapes = articulated(&options).unwrap();
    let labels = Labels::new(&shapes.iter().map(|shape| shape.label.as_str()).collect::<Vec<_>>());
    let embedding = EmbedOptions { stress: StressChoice::Skip, ..EmbedOptions::default() };
    let forms: Vec<_> = shapes
        .par_iter()
        .map(|shape| {
            let surface = surface(&shape.mesh);
            embed(&surface, &embedding, &()).unwrap().form(&surface).unwrap()
        })
        .collect();
    let prepared = PreparedForms::new(&forms, Normalization::Raw).unwrap();
    let distances = form_distances(&prepared, &MatchOptions::default(), &()).unwrap();
    let scores = evaluate(&distances, &labels, 1).unwrap();
    println!("{} shapes: NN {}, mAP {:.4}", scores.n, scores.nn, scores.map);
    assert_eq!((scores.n, scores.nn), (30, 1.0));
    assert!(scores.map >= 0.97, "mAP {}", scores.map);
}
