//! Laws of distributions over a surface.

use std::f64::consts::PI;

use canonform_descriptors::{
    LaplaceSpectrum, heat_kernel_signature, shape_dna, wave_kernel_signature, wave_kernels,
};
use linalg::Matrix;

/// The four quantiles of samples with masses: those of the heat of a surface with a single function that is not constant.
fn quantiles(samples: &[(f64, f64)]) -> Vec<f64> {
    let column = |i: usize, j: usize| if j == 0 { 1.0 } else { samples[i].0.sqrt() };
    let spectrum = LaplaceSpectrum {
        values: vec![0.0, 1.0],
        corrected: vec![0.0, 1.0],
        vectors: Matrix::from_fn(samples.len(), 2, column),
        masses: samples.iter().map(|(_, mass)| *mass).collect(),
        area: 1.0,
    };
    let mut all = heat_kernel_signature(&spectrum).values;
    assert_eq!(all[..4], all[28..], "equal at all times");
    all.truncate(4);
    all
}

#[test]
fn quantiles_of_few_samples_leave_out_what_is_no_number_or_has_no_mass() {
    let found = quantiles(&[(4.0, 1e-3), (1.0, 3e-3), (f64::NAN, 1.0), (9.0, 0.0)]);
    assert_eq!(found[0], 1.0);
    assert!(found.is_sorted() && found[3] > 1.0 && found[3] <= 4.0, "{found:?}");
    assert_eq!(quantiles(&[(4.0, 2.0)]), [4.0; 4]);
    assert_eq!(quantiles(&[]), [0.0; 4]);
}

#[test]
fn the_distribution_is_linear_between_the_middles_of_samples() {
    // Half of the mass of each lies below its value: .5 of 7 below 1, 3 below 4, 6 below 9.
    let found = quantiles(&[(9.0, 2.0), (1.0, 1.0), (4.0, 4.0)]);
    let middle = |share: f64| {
        if share < 3.0 {
            1.0 + 3.0 * (share - 0.5) / 2.5
        } else {
            f64::min(4.0 + 5.0 * (share - 3.0) / 3.0, 9.0)
        }
    };
    for (bin, found) in found.into_iter().enumerate() {
        let expected = middle((bin as f64 + 0.5) / 4.0 * 7.0);
        assert!((found - expected).abs() < 1e-12, "{bin}: {found} {expected}");
    }
}

#[test]
fn signatures_of_a_known_spectrum_follow_their_definitions() {
    let weyl = |i: f64| 4.0 * PI * i;
    let values = vec![0.0, weyl(1.3), weyl(5.0), weyl(31.0)];
    let function = |v: usize, i: usize| if i == 0 { 1.0 } else { 0.3 + ((v + 1) * (2 * i + 1)) as f64 % 7.0 };
    let spectrum = LaplaceSpectrum {
        corrected: values.clone(),
        values: values.clone(),
        vectors: Matrix::from_fn(4, 4, function),
        masses: vec![0.25; 4],
        area: 1.0,
    };
    let spaced = |[from, to]: [f64; 2], n: usize, j: usize| from + (to - from) * j as f64 / (n - 1) as f64;
    // The mean of squared functions, of which each has this weight.
    let mean = |v: usize, weight: &dyn Fn(f64) -> f64| {
        let [above, below] = [true, false].map(|is_above| {
            let one = |i: usize| weight(values[i]) * if is_above { function(v, i).powi(2) } else { 1.0 };
            (1..4).map(one).sum::<f64>()
        });
        above / below
    };
    let energies = [weyl(1.0).ln(), weyl(42.0).ln()];
    let sigma = 1.5 * (energies[1] - energies[0]) / 11.0;
    let (waves, wave) = (wave_kernels(&spectrum), wave_kernel_signature(&spectrum).values);
    let is_near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-9;
    for j in 0..12 {
        let weight = |value: f64| (-((spaced(energies, 12, j) - value.ln()) / sigma).powi(2) / 2.0).exp();
        let expected = [0, 1, 2, 3].map(|v| mean(v, &weight));
        assert!((0..4).all(|v| is_near(waves[(v, j)], expected[v])), "{j}: {waves} {expected:?}");
        // The first and the last of eight quantiles are the least and the greatest of four points.
        let [low, high] = [f64::min, f64::max].map(|of| expected.into_iter().reduce(of).unwrap());
        assert!(is_near(wave[8 * j], low) && is_near(wave[8 * j + 7], high), "{j}: {wave:?}");
    }
    let times = [60.0, 1.0].map(|i| (4.0 * 10f64.ln() / weyl(i)).ln());
    let heat = heat_kernel_signature(&spectrum).values;
    for j in 0..8 {
        let weight = |value: f64| (-value * spaced(times, 8, j).exp()).exp();
        // Quantiles in the middles of four bins are the values at the four points.
        let mut expected = [0, 1, 2, 3].map(|v| mean(v, &weight));
        expected.sort_by(f64::total_cmp);
        assert!((0..4).all(|i| is_near(heat[4 * j + i], expected[i])), "{j}: {heat:?} {expected:?}");
    }
    let dna = shape_dna(&spectrum).values;
    assert!(
        (dna[0] - 1.3).abs() < 1e-12 && (dna[1] - 2.5).abs() < 1e-12 && (dna[2] - 31.0 / 3.0).abs() < 1e-12
    );
    assert_eq!((dna.len(), &dna[3..]), (20, &[1.0; 17][..]));
}
