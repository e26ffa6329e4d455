//! Laws of boundaries.

use canonform_descriptors::Boundary;

#[test]
fn a_boundary_gives_the_probability_of_each_distance_and_what_none_proves_is_never_certain() {
    let ninth = 9f64.powf(0.2);
    for (range, gap) in [([0.0, 1.0], [2.0 / ninth, 2.0 * ninth]), ([0.2, 0.8], [0.0, f64::INFINITY])] {
        let boundary = Boundary { range, ..Boundary::new(2.0, 5.0) };
        for (distance, expected) in [(0.0, range[1]), (2.0, 0.5), (f64::INFINITY, range[0])] {
            assert!((boundary.probability(distance) - expected).abs() < 1e-12);
        }
        for probability in [0.3, 0.5, 0.7] {
            assert!((boundary.probability(boundary.distance(probability)) - probability).abs() < 1e-12);
        }
        for (found, expected) in boundary.gap().into_iter().zip(gap) {
            assert!(found == expected || (found - expected).abs() < 1e-12);
        }
    }
}

#[test]
fn a_fit_finds_the_boundary_of_its_samples() {
    for (range, most) in [([0.0, 1.0], 1e-6), ([0.2, 0.9], 0.05)] {
        let boundary = Boundary { range, ..Boundary::new(2.0, 5.0) };
        let samples = (1..400).flat_map(|i| {
            let distance = 0.02 * f64::from(i);
            let probability = boundary.probability(distance);
            [(distance, true, probability), (distance, false, 1.0 - probability)]
        });
        let found = Boundary::fitted(&samples.collect::<Vec<_>>(), range);
        let gaps = [
            found.at / 2.0 - 1.0,
            found.steepness / 5.0 - 1.0,
            found.range[0] - range[0],
            found.range[1] - range[1],
        ];
        assert!(gaps.iter().all(|gap| gap.abs() < most), "{found:?}");
    }
}
