//! Comparison with other implementations on real meshes.

use super::super::Exact;
use crate::DistanceSolver;
use crate::tests::{Reference, assert_close, reference};

#[test]
fn distances_equal_those_of_other_implementations() {
    let Some(data) = testkit::data("") else { return };
    for mesh in [
        "tosca-lowres/cat0.vert",
        "tosca-lowres/cat1.vert",
        "tosca-lowres/centaur1.vert",
        "tosca-lowres/centaur2.vert",
        "tosca-lowres/horse0.vert",
        "tosca-lowres/wolf0.vert",
        "tosca-lowres/wolf1.vert",
        "single/spot.obj",
        "single/rocker-arm.obj",
        "single/armadillo.obj",
    ] {
        let Reference { mesh, rows } = reference(&data, mesh);
        let solver = Exact::new(&mesh.intrinsic(), &());
        for (source, expected) in &rows {
            for (found, expected) in solver.distances(*source).unwrap().iter().zip(expected) {
                assert_close(*found, *expected, 1e-12);
            }
        }
    }
}
