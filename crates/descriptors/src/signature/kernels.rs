//! How heat and waves spread, point by point, as distributions over the surface.

use std::f64::consts::{LN_10, PI};

use linalg::Matrix;

use super::quantiles::quantiles;
use super::{Signature, SignatureKind};
use crate::LaplaceSpectrum;

/// Times at which heat is looked at.
const TIMES: usize = 8;

/// Bins of the distribution of heat at one time.
const HEAT_BINS: usize = 4;

/// Energies at which waves are looked at.
const ENERGIES: usize = 12;

/// Bins of the distribution of waves of one energy.
const WAVE_BINS: usize = 8;

/// Values of [`heat_kernel_signature`].
pub(super) const HEAT_LENGTH: usize = TIMES * HEAT_BINS;

/// Values of [`wave_kernel_signature`].
pub(super) const WAVE_LENGTH: usize = ENERGIES * WAVE_BINS;

/// Eigenpairs used, the constant function among them.
pub(super) const EIGENPAIRS: usize = LaplaceSpectrum::DESCRIBING;

/// Eigenvalue number `i` of an average surface of unit area (Weyl's law): it ties times and energies to the
/// number of eigenpairs, not to the surface.
fn weyl(i: f64) -> f64 {
    4.0 * PI * i
}

/// The distribution over the surface of the heat kernel signature (Sun, Ovsjanikov and Guibas 2009, `sun2009` in
/// `REFERENCES.bib`).
///
/// `h(x, t) = Σ_i exp(-λ_i t) φ_i(x)²` over the eigenpairs but the constant one, of the surface with unit area, is
/// how much of the heat put at `x` is still there at time `t`. At each of 8 times it is divided by its mean,
/// `Σ_i exp(-λ_i t)`, and given by 4 bins of equal area: values, ascending, that those shares of the area do not
/// reach. Times are spaced evenly in the logarithm from `4 ln 10 / λ_60` to `4 ln 10 / λ_1` with Weyl's
/// estimate of the eigenvalues, so they belong to no surface.
///
/// * Invariant to isometries (bending, rigid motions, mirror images), scale and the order of vertices;
///   changes with the triangulation as the spectrum does.
/// * Where nothing is known, on a mesh without a second eigenvalue, all values are zero.
#[must_use]
pub fn heat_kernel_signature(spectrum: &LaplaceSpectrum) -> Signature {
    let ends = [weyl(EIGENPAIRS as f64), weyl(1.0)].map(|value| (4.0 * LN_10 / value).ln());
    let times: Vec<f64> = spaced(ends, TIMES).map(f64::exp).collect();
    let filters = filters(spectrum, TIMES, |j, value| (-value * times[j]).exp());
    Signature { kind: SignatureKind::HeatKernel, values: distributions(spectrum, &filters, HEAT_BINS) }
}

/// The distribution over the surface of the wave kernel signature (Aubry, Schlickewei and Cremers 2011,
/// `aubry2011` in `REFERENCES.bib`).
///
/// `w(x, e) = Σ_i g_e(λ_i) φ_i(x)² / Σ_i g_e(λ_i)` with `g_e(λ) = exp(-(e - ln λ)² / 2 σ²)`, over the eigenpairs but the
/// constant one of the surface with unit area, is how likely a particle of about the energy `e` is found at
/// `x`; its mean is one. At each of 12 energies it is given by 8 bins of equal area, as in
/// [`heat_kernel_signature`]. Energies are spaced evenly from `ln λ_1` to `ln λ_42` with Weyl's
/// estimate of the eigenvalues, and `σ` is 1.5 of their distances.
///
/// * Invariant to isometries (bending, rigid motions, mirror images), scale and the order of vertices;
///   changes with the triangulation as the spectrum does.
/// * Where nothing is known, on a mesh without a second eigenvalue, all values are zero.
#[must_use]
pub fn wave_kernel_signature(spectrum: &LaplaceSpectrum) -> Signature {
    let ends = [weyl(1.0), weyl(0.7 * EIGENPAIRS as f64)].map(f64::ln);
    let energies: Vec<f64> = spaced(ends, ENERGIES).collect();
    let sigma = 1.5 * (energies[1] - energies[0]);
    // Divided by the largest: far from all eigenvalues each would underflow.
    let exponent = |j: usize, value: f64| -0.5 * ((energies[j] - value.ln()) / sigma).powi(2);
    let nearest: Vec<f64> = (0..ENERGIES)
        .map(|j| curved(spectrum).map(|i| exponent(j, spectrum.values[i])).fold(f64::NEG_INFINITY, f64::max))
        .collect();
    let filters = filters(spectrum, ENERGIES, |j, value| (exponent(j, value) - nearest[j]).exp());
    Signature { kind: SignatureKind::WaveKernel, values: distributions(spectrum, &filters, WAVE_BINS) }
}

/// `n` values from one end to the other.
fn spaced(ends: [f64; 2], n: usize) -> impl Iterator<Item = f64> {
    (0..n).map(move |i| ends[0] + (ends[1] - ends[0]) * i as f64 / (n - 1) as f64)
}

/// The eigenpairs that count: not those of constant functions.
fn curved(spectrum: &LaplaceSpectrum) -> impl Iterator<Item = usize> {
    const ZERO: f64 = 1e-6;
    let n = spectrum.values.len().min(EIGENPAIRS);
    (1..n).filter(|&i| spectrum.values[i] > ZERO)
}

/// One column for each filter: the weights of all eigenpairs, which sum to one (or are all zero).
fn filters(spectrum: &LaplaceSpectrum, n: usize, weight: impl Fn(usize, f64) -> f64) -> Matrix {
    let mut filters = Matrix::zeros(spectrum.values.len(), n);
    for (j, mut column) in filters.column_iter_mut().enumerate() {
        curved(spectrum).for_each(|i| column[i] = weight(j, spectrum.values[i]));
        let sum = column.sum();
        if sum > 0.0 {
            column /= sum;
        }
    }
    filters
}

/// For every filter the quantiles over the surface of `Σ_i filter_i φ_i(x)²`.
fn distributions(spectrum: &LaplaceSpectrum, filters: &Matrix, bins: usize) -> Vec<f64> {
    let densities = spectrum.vectors.map(|x| x * x) * filters;
    let one = |column: nalgebra::DVectorView<'_, f64>| {
        quantiles(column.iter().copied().zip(spectrum.masses.iter().copied()).collect(), bins)
    };
    densities.column_iter().flat_map(one).collect()
}
