//! Signatures depend little on pose and triangulation, and distinguish bodies.

use canonform::embed::signature;
use canonform::{DescribeOptions, describe};
use datasets::{ArticulatedOptions, Family, articulated_shape};
use descriptors::SignatureKind;
use rayon::prelude::*;

use crate::support::surface;

/// Three poses of each family, class by class, each with its own triangulation and resolution.
#[test]
fn every_signature_separates_bodies_more_than_poses_and_triangulations() {
    let shape = |i: usize| {
        let (family, pose) = (Family::all()[i / 3], i % 3);
        let options = ArticulatedOptions { seed: 11 + pose as u64, n_vertices: 1000 + 500 * pose };
        let mesh = articulated_shape(family, pose + 1, &options).unwrap().mesh;
        describe(&surface(&mesh), &DescribeOptions::default(), &()).unwrap()
    };
    let shapes: Vec<_> = (0..9).into_par_iter().map(shape).collect();
    for kind in SignatureKind::INTRINSIC {
        let of = |i: usize| signature(&shapes[i], kind).unwrap();
        let mean = |same: bool| {
            let pairs = (0..9).flat_map(|i| (0..i).map(move |j| (i, j)));
            let found: Vec<f64> = pairs
                .filter(|(i, j)| (i / 3 == j / 3) == same)
                .map(|(i, j)| of(i).distance(&of(j)))
                .collect();
            found.iter().sum::<f64>() / found.len() as f64
        };
        assert!(mean(false) > 2.0 * mean(true), "{}: {} {}", kind.name(), mean(true), mean(false));
    }
}
