//! Laws of distributions over a surface.

use canonform_descriptors::{LaplaceSpectrum, heat_kernel_signature};
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
