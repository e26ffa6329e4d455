//! Signatures from the Laplace-Beltrami spectrum: ShapeDNA, and the heat and wave kernel signatures.

use std::f64::consts::{LN_10, PI};

use linalg::Matrix;

use super::kind::{Signature, SignatureKind};
use super::quantiles::quantiles;
use crate::spectrum::LaplaceSpectrum;

/// Number of eigenvalues used.
const EIGENVALUES: usize = SignatureKind::ShapeDna.n_values();

/// ShapeDNA: the eigenvalues of the Laplace-Beltrami operator (Reuter, Wolter and Peinecke 2006,
/// `reuter2006` in `REFERENCES.bib`).
///
/// The values are `λ_i A / (4 π i)` for the first 20 eigenvalues after zero, with `A` the area. By Weyl's law `λ_i A` grows
/// like `4 π i`, so all values are near one and none dominates.
///
/// * Invariant to isometries (bending, rigid motions, mirror images) and scale. The triangulation changes them by the
///   error of linear finite elements.
/// * If a mesh has fewer eigenvalues, the remaining values are one.
pub fn shape_dna(spectrum: &LaplaceSpectrum) -> Signature {
    let value = |i: usize| spectrum.corrected.get(i).map_or(1.0, |value| value / (4.0 * PI * i as f64));
    Signature { kind: SignatureKind::ShapeDna, values: (1..=EIGENVALUES).map(value).collect() }
}

/// Number of times at which heat is sampled. A convention, as are the numbers of energies and bins.
const TIMES: usize = 8;

/// Number of bins of the distribution of heat at one time.
const HEAT_BINS: usize = SignatureKind::HeatKernel.n_values() / TIMES;

/// Number of energies at which waves are sampled.
const ENERGIES: usize = 12;

/// Number of bins of the distribution of waves at one energy.
const WAVE_BINS: usize = SignatureKind::WaveKernel.n_values() / ENERGIES;

/// Weyl's estimate of eigenvalue number `i` of a surface of unit area. It makes times and energies depend on the number
/// of eigenpairs, not on the surface.
fn weyl(i: f64) -> f64 {
    4.0 * PI * i
}

/// The distribution over the surface of the heat kernel signature (Sun, Ovsjanikov and Guibas 2009, `sun2009` in
/// `REFERENCES.bib`).
///
/// `h(x, t) = Σ_i exp(-λ_i t) φ_i(x)²`, over all eigenpairs of the surface of unit area except the constant one, is the
/// heat placed at `x` that remains there at time `t`. At each of 8 times it is divided by its mean, `Σ_i exp(-λ_i t)`,
/// and described by the quantiles of 4 bins of equal area. Times are evenly spaced in the logarithm from
/// `4 ln 10 / λ_60` to `4 ln 10 / λ_1`, with Weyl's estimate of the eigenvalues, so they are the same for all surfaces.
///
/// * Invariant to isometries (bending, rigid motions, mirror images), scale and the order of vertices; changes with the
///   triangulation as the spectrum does.
/// * On a mesh without a second eigenvalue all values are zero.
pub fn heat_kernel_signature(spectrum: &LaplaceSpectrum) -> Signature {
    let ends = [weyl(LaplaceSpectrum::DESCRIBING as f64), weyl(1.0)].map(|value| (4.0 * LN_10 / value).ln());
    let times: Vec<f64> = spaced(ends, TIMES).map(f64::exp).collect();
    let filters = filters(spectrum, TIMES, |j, value| (-value * times[j]).exp());
    Signature { kind: SignatureKind::HeatKernel, values: distributions(spectrum, &filters, HEAT_BINS) }
}

/// The distribution over the surface of the wave kernel signature (Aubry, Schlickewei and Cremers 2011,
/// `aubry2011` in `REFERENCES.bib`).
///
/// `w(x, e) = Σ_i g_e(λ_i) φ_i(x)² / Σ_i g_e(λ_i)` with `g_e(λ) = exp(-(e - ln λ)² / 2 σ²)`, over all eigenpairs of the
/// surface of unit area except the constant one, is the probability density of a particle of energy about `e` at `x`;
/// its mean is one. At each of 12 energies it is described by the quantiles of 8 bins of equal area, as in
/// [`heat_kernel_signature`]. Energies are evenly spaced from `ln λ_1` to `ln λ_42`, with Weyl's estimate of the
/// eigenvalues, and `σ` is 1.5 times their spacing; both are conventions.
///
/// * Invariant to isometries (bending, rigid motions, mirror images), scale and the order of vertices; changes with the
///   triangulation as the spectrum does.
/// * On a mesh without a second eigenvalue all values are zero.
pub fn wave_kernel_signature(spectrum: &LaplaceSpectrum) -> Signature {
    let filters = wave_filters(spectrum);
    Signature { kind: SignatureKind::WaveKernel, values: distributions(spectrum, &filters, WAVE_BINS) }
}

/// The weights of all eigenpairs at each energy.
fn wave_filters(spectrum: &LaplaceSpectrum) -> Matrix {
    let ends = [weyl(1.0), weyl(0.7 * LaplaceSpectrum::DESCRIBING as f64)].map(f64::ln);
    let energies: Vec<f64> = spaced(ends, ENERGIES).collect();
    let sigma = 1.5 * (energies[1] - energies[0]);
    // Relative to the largest, since all of them underflow far from the eigenvalues.
    let exponent = |j: usize, value: f64| -0.5 * ((energies[j] - value.ln()) / sigma).powi(2);
    let nearest: Vec<f64> = (0..ENERGIES)
        .map(|j| {
            curved(spectrum).map(|i| exponent(j, spectrum.corrected[i])).fold(f64::NEG_INFINITY, f64::max)
        })
        .collect();
    filters(spectrum, ENERGIES, |j, value| (exponent(j, value) - nearest[j]).exp())
}

/// The wave kernels of [`wave_kernel_signature`], one row for each vertex and one column for each energy.
pub fn wave_kernels(spectrum: &LaplaceSpectrum) -> Matrix {
    spectrum.vectors.map(|x| x * x) * wave_filters(spectrum)
}

/// `n` values from one end to the other.
fn spaced(ends: [f64; 2], n: usize) -> impl Iterator<Item = f64> {
    (0..n).map(move |i| ends[0] + (ends[1] - ends[0]) * i as f64 / (n - 1) as f64)
}

/// The eigenpairs used, without those of constant functions.
fn curved(spectrum: &LaplaceSpectrum) -> impl Iterator<Item = usize> {
    // A tolerance of rounding: constant functions have the eigenvalue 0.
    const ZERO: f64 = 1e-6;
    let n = spectrum.values.len().min(LaplaceSpectrum::DESCRIBING);
    (1..n).filter(|&i| spectrum.values[i] > ZERO)
}

/// The weights of all eigenpairs as one column per filter; a column sums to one, or is zero.
fn filters(spectrum: &LaplaceSpectrum, n: usize, weight: impl Fn(usize, f64) -> f64) -> Matrix {
    let mut filters = Matrix::zeros(spectrum.values.len(), n);
    for (j, mut column) in filters.column_iter_mut().enumerate() {
        curved(spectrum).for_each(|i| column[i] = weight(j, spectrum.corrected[i]));
        let sum = column.sum();
        if sum > 0.0 {
            column /= sum;
        }
    }
    filters
}

/// For every filter, the quantiles over the surface of `Σ_i filter_i φ_i(x)²`.
fn distributions(spectrum: &LaplaceSpectrum, filters: &Matrix, bins: usize) -> Vec<f64> {
    let densities = spectrum.vectors.map(|x| x * x) * filters;
    let one = |column: nalgebra::DVectorView<'_, f64>| {
        quantiles(column.iter().copied().zip(spectrum.masses.iter().copied()), bins)
    };
    densities.column_iter().flat_map(one).collect()
}
