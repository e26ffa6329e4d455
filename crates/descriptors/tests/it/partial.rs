//! Laws of shapes of which a part is missing.

use canonform_descriptors::{DiscAreas, PartDiscAreas};
use linalg::{LandmarkDistances, Matrix};

/// A strip of `n` points on a line, one apart, with landmarks at every fifth.
fn strip(points: std::ops::Range<usize>) -> (LandmarkDistances, Vec<f64>) {
    let n = points.len();
    let landmarks: Vec<usize> = (0..n).step_by(5).collect();
    let columns = Matrix::from_fn(n, landmarks.len(), |i, j| i.abs_diff(landmarks[j]) as f64);
    (LandmarkDistances::new(landmarks, columns).unwrap(), vec![1.0; n])
}

#[test]
fn a_whole_fits_itself_and_a_part_fits_its_whole() {
    let (distances, masses) = strip(0..200);
    let whole = DiscAreas::new(&distances, &masses).unwrap();
    let uncut = vec![f64::INFINITY; 200];
    let itself = PartDiscAreas::new(&distances, &masses, &uncut, 0.0).unwrap().distance(&whole);
    assert!(itself.distance < 1e-9 && itself.share == 1.0, "{itself:?}");
    // The first 140 points; the cut is beyond the last.
    let (distances, masses) = strip(0..140);
    let from_cut: Vec<f64> = (0..140).map(|i| 140.0 - f64::from(i)).collect();
    let part = PartDiscAreas::new(&distances, &masses, &from_cut, 1.0).unwrap().distance(&whole);
    assert!(part.distance < 0.05, "{part:?}");
    // A square of 14 x 14 points is no strip.
    let landmarks: Vec<usize> = (0..196).step_by(5).collect();
    let apart = |i: usize, j: usize| (i % 14).abs_diff(j % 14) + (i / 14).abs_diff(j / 14);
    let columns = Matrix::from_fn(196, landmarks.len(), |i, j| apart(i, landmarks[j]) as f64);
    let square = LandmarkDistances::new(landmarks, columns).unwrap();
    let square = DiscAreas::new(&square, &[1.0; 196]).unwrap();
    let parts = PartDiscAreas::new(&distances, &masses, &from_cut, 1.0).unwrap();
    let other = parts.distance(&square);
    assert!(other.distance > 10.0 * part.distance, "{part:?}, {other:?}");
}

#[test]
fn points_at_the_rim_of_a_disc_count_in_part() {
    // From a tenth of the radius before the rim to a tenth behind it.
    const SOFT: f64 = 0.1;
    let n = 3000;
    let masses: Vec<f64> = (0..n).map(|i| 1.0 + (i % 5) as f64).collect();
    let area: f64 = masses.iter().sum();
    let column = Matrix::from_fn(n, 1, |i, _| (i * 7919 % n) as f64 / 1000.0 * area.sqrt());
    let found = DiscAreas::new(&LandmarkDistances::new(vec![0], column.clone()).unwrap(), &masses).unwrap();
    for (i, share) in found.to_numbers().into_iter().enumerate() {
        // Twenty radii in equal steps of the logarithm, in units of the root of the area.
        let radius = 0.06 * (2.2f64 / 0.06).powf(i as f64 / 19.0) * area.sqrt();
        let counted = |d: f64| ((1.0 + SOFT - d / radius) / (2.0 * SOFT)).clamp(0.0, 1.0);
        let expected: f64 = column.iter().zip(&masses).map(|(d, m)| m * counted(*d)).sum();
        assert!((f64::from(share) - (expected / area).ln()).abs() < 1e-6, "{i}: {share} {expected}");
    }
}

#[test]
fn stored_areas_are_the_same_and_lengths_that_do_not_match_are_errors() {
    let (distances, masses) = strip(0..50);
    let numbers = DiscAreas::new(&distances, &masses).unwrap().to_numbers();
    assert_eq!(DiscAreas::from_numbers(&numbers).unwrap().to_numbers(), numbers);
    assert_eq!(DiscAreas::from_numbers(&numbers[1..]), None);
    assert!(DiscAreas::new(&distances, &masses[1..]).is_err());
    assert!(PartDiscAreas::new(&distances, &masses, &[1.0], 1.0).is_err());
    assert!(DiscAreas::new(&distances, &[0.0; 50]).is_err());
}

#[test]
fn areas_that_differ_much_count_linearly() {
    let (column, masses) = (Matrix::from_fn(200, 1, |i, _| i as f64), [1.0; 200]);
    let distances = LandmarkDistances::new(vec![0], column).unwrap();
    let itself = PartDiscAreas::new(&distances, &masses, &[f64::INFINITY; 200], 0.0).unwrap();
    let own = DiscAreas::new(&distances, &masses).unwrap().to_numbers();
    // Logarithms count by their square up to .3, and beyond along the tangent.
    for (shift, expected) in [(0.1, 0.1f64), (0.3, 0.3), (2.0, (0.3f64 * (2.0 * 2.0 - 0.3)).sqrt())] {
        let shifted: Vec<f32> = own.iter().map(|area| area + shift as f32).collect();
        let found = itself.distance(&DiscAreas::from_numbers(&shifted).unwrap());
        assert!((found.distance - expected).abs() < 1e-3 && found.share == 1.0, "{found:?}, {expected}");
    }
}
