//! Maps that are refined on some of the samples.

use crate::functional::{FunctionalMaps, SampledPair, TwoWayMap};
use crate::start::Start;

/// A map of samples, and the maps of functions that it follows from.
pub(crate) struct Sketch {
    pub(crate) maps: TwoWayMap,
    pub(crate) functional: FunctionalMaps,
}

impl Sketch {
    /// Refines a start by taking in eigenfunctions of higher and higher frequency, up to `last` (ZoomOut, `melzi2019` in
    /// `REFERENCES.bib`).
    pub(crate) fn new(pair: &SampledPair, start: Start, last: usize) -> Self {
        let last = last.min(pair.n_points() / SAMPLES_A_FUNCTION).max(1).min(pair.n_functions());
        let Start { mut maps, first } = start;
        let mut k = first.min(last);
        loop {
            let functional = FunctionalMaps::new(pair, &maps, k);
            maps = functional.sample_maps(pair);
            if k == last {
                return Self { maps, functional };
            }
            // A limit of effort.
            k = (k + (k / 10).max(2)).min(last);
        }
    }
}

/// Samples for each coefficient of a map of functions at least. A convention.
pub(crate) const SAMPLES_A_FUNCTION: usize = 4;
