//! Where the search for maps starts.

use descriptors::DescriptorError;
use rigid::{NearestPoints, Similarity, alignments};

use crate::functional::{FunctionalMaps, SampledPair, TwoWayMap};
use crate::operators::FITTED;
use crate::shape::MapShape;

/// A map of samples, and the eigenfunctions that its refinement starts with.
pub(crate) struct Start {
    pub(crate) maps: TwoWayMap,
    pub(crate) first: usize,
}

/// Eigenfunctions of the first step of a map from an alignment, which keeps the large parts in their places. With 20, one pair of
/// built-in men is turned back to front.
const ALIGNED: usize = 6;

impl Start {
    /// From maps of functions.
    pub(crate) fn functional(functional: &FunctionalMaps, pair: &SampledPair) -> Self {
        Self { maps: functional.sample_maps(pair), first: FITTED }
    }

    /// Different maps of the first `n` samples to the nearest ones in aligned forms.
    pub(crate) fn aligned(a: &MapShape, b: &MapShape, n: usize) -> Result<Vec<Self>, DescriptorError> {
        // The first samples are evenly spread, too; a partner further down the list stands for one that is not far away.
        let places = |shape: &MapShape| {
            NearestPoints::new(shape.samples[..n].iter().map(|&v| shape.form.points()[v]).collect())
        };
        let (on_a, on_b) = (places(a)?, places(b)?);
        let near = |from: &NearestPoints, to: &NearestPoints, motion: &Similarity| {
            from.points().iter().map(|p| to.nearest(&motion.apply(p)).0).collect()
        };
        let mut found: Vec<TwoWayMap> = alignments(&a.form, &b.form)
            .iter()
            .map(|motion| [near(&on_a, &on_b, motion), near(&on_b, &on_a, &motion.inverse())])
            .collect();
        found.dedup();
        Ok(found.into_iter().map(|maps| Self { maps, first: ALIGNED }).collect())
    }
}
