//! Comparison with exact distances on real meshes.

use super::heat;
use crate::DistanceSolver;
use crate::tests::{Reference, reference};

#[test]
fn errors_beside_exact_distances_are_no_larger_than_those_of_geometry_central() {
    let Some(data) = testkit::data("") else { return };
    // Mean and largest relative error of potpourri3d 1.4 on the same sources.
    for (name, mean, largest) in [
        ("tosca-lowres/cat0.vert", 0.0214, 0.460),
        ("tosca-lowres/cat1.vert", 0.0202, 0.387),
        ("tosca-lowres/horse0.vert", 0.0193, 0.596),
        ("tosca-lowres/wolf0.vert", 0.0186, 0.285),
        ("tosca-lowres/wolf1.vert", 0.0189, 0.414),
        ("single/spot.obj", 0.0212, 0.405),
        ("single/rocker-arm.obj", 0.0176, 0.378),
        ("single/armadillo.obj", 0.0091, 0.368),
    ] {
        let Reference { mesh, rows } = reference(&data, name);
        let method = heat(&mesh.intrinsic());
        let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0);
        for (source, exact) in &rows {
            for (found, exact) in method.distances(*source).unwrap().iter().zip(exact) {
                if *exact > 0.0 && exact.is_finite() {
                    let error = (found - exact).abs() / exact;
                    sum += error;
                    worst = worst.max(error);
                    count += 1;
                }
            }
        }
        let found = sum / f64::from(count);
        assert!(found <= mean && worst <= largest, "{name}: mean {found}, largest {worst}");
    }
}
