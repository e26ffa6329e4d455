//! Laws of the spectrum of a surface.

use std::f64::consts::PI;

use canonform_descriptors::{DescriptorError, LaplaceSpectrum, geodesic_spectrum};
use linalg::{LandmarkDistances, Matrix};
use mesh::{TriMesh, shapes};

fn spectrum(mesh: &TriMesh, m: usize) -> LaplaceSpectrum {
    LaplaceSpectrum::new(&mesh.intrinsic(), m, &()).unwrap()
}

#[test]
fn the_eigenvalues_of_a_sphere_are_l_times_l_plus_1_with_multiplicity_2_l_plus_1() {
    let mut previous = f64::INFINITY;
    for level in [3, 4] {
        let found = spectrum(&shapes::icosphere(level), 49);
        let expected = (0..7).flat_map(|l| vec![4.0 * PI * f64::from(l * (l + 1)); 2 * l as usize + 1]);
        let error = |(a, e): (&f64, f64)| if e > 0.0 { (a / e - 1.0).abs() } else { *a };
        let worst = found.values.iter().zip(expected.clone()).map(error).fold(0.0, f64::max);
        let corrected = found.corrected.iter().zip(expected).map(error).fold(0.0, f64::max);
        assert!(corrected < 0.25 * worst, "level {level}: {corrected}, uncorrected {worst}");
        assert!(worst < previous / 3.0, "level {level}: {worst} after {previous}");
        previous = worst;
    }
    assert!(previous < 0.02, "{previous}");
}

#[test]
fn the_eigenvalues_of_a_rectangle_are_those_of_standing_waves() {
    // With free ends: pi^2 (a^2 / w^2 + b^2 / h^2), times the area w h.
    let (w, h) = (60, 40);
    let found = spectrum(&shapes::grid(w + 1, h + 1, 0.1), 30);
    let ratio = w as f64 / h as f64;
    let wave = |a: usize, b: usize| PI * PI * ((a * a) as f64 / ratio + (b * b) as f64 * ratio);
    let mut expected: Vec<f64> = (0..12).flat_map(|a| (0..12).map(move |b| wave(a, b))).collect();
    expected.sort_by(f64::total_cmp);
    for (j, (a, e)) in found.values.iter().zip(&expected).enumerate().skip(1) {
        assert!((a / e - 1.0).abs() < 0.02, "{j}: {a} against {e}");
    }
    assert!((found.area - 24.0).abs() < 1e-9 && (found.masses.iter().sum::<f64>() - 1.0).abs() < 1e-12);
}

#[test]
fn every_component_adds_a_constant_function() {
    let parts = [shapes::icosphere(2), shapes::grid(9, 9, 0.2), shapes::torus(20, 9, 1.0, 0.3)];
    let found = spectrum(&shapes::disjoint(&parts), 12);
    assert!(found.values[2] < 1e-9 && found.values[3] > 0.1, "{:?}", found.values);
}

#[test]
fn a_surface_without_area_has_no_spectrum() {
    let none = LaplaceSpectrum::new(&TriMesh::default().intrinsic(), 5, &());
    assert_eq!(none, Err(DescriptorError::NoExtent { n_points: 0 }));
}

#[test]
fn seven_points_have_the_spectrum_of_the_roots_of_their_distances() {
    let columns = Matrix::from_fn(7, 7, |i, j| if i == j { 0.0 } else { 4.0 });
    let distances = LandmarkDistances::new((0..7).collect(), columns).unwrap();
    // As many samples are all used: a seventh of √(d / √A), 6 times once and -1 times for the rest.
    let values = geodesic_spectrum(&distances, &[2.0; 7], 9.0).unwrap().values;
    for (i, value) in values.into_iter().enumerate() {
        let times = [6.0, 1.0, 6e-4][usize::from(i > 0) + usize::from(i > 6)];
        assert!((value - (times / 7.0 * (4.0 / 3.0f64).sqrt()).ln()).abs() < 1e-9, "{i}: {value}");
    }
    let refused = geodesic_spectrum(&distances, &[2.0; 7], 0.0);
    assert_eq!(refused, Err(DescriptorError::NoExtent { n_points: 7 }));
}
