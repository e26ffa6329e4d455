//! A part and a whole in the same unit: the square root of the area of the whole.

use std::collections::BTreeMap;

use linalg::Matrix;
use nalgebra::DVector;

use super::super::curvature::smoothed;
use super::super::local::between;
use super::super::shape::MapShape;
use descriptors::{DescriptorError, LaplaceSpectrum};
use surface::VertexId;

/// Differences of curvature count if a point is so far from the cut, for each time of smoothing. Heat of the three times reaches
/// as far.
const SMOOTHED: [f64; 3] = [0.1, 0.15, 0.25];

/// Squared differences of curvature count up to this, in units of its variance. A safety limit.
const OUTLYING: f64 = 4.0;

/// Changes of distances beyond this count as much as this: the pairs of a few wrong anchors, or with a path through what is
/// missing. A part of a built-in man is mapped to him with a mean error of 0.0140, and of 0.0142 with 0.2.
const MOST: f64 = 0.1;

/// Weight of distances that the cut explains, beside 1 for others: most of the shortest paths between points near the cut
/// stay in the part. A part of a built-in man is mapped to him with an error near the cut of 0.017, and of 0.042 with 0.
const EXPLAINED: f64 = 0.3;

/// What is known of the distance of two points of the part in the whole: paths in the part are paths in the whole, and a path
/// through what is missing is at least as long as the distances of its ends from the cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub(super) least: f64,
    pub(super) most: f64,
}

impl Known {
    /// How much a distance in the whole speaks against this, with changes beyond `limit` as much as there.
    pub(super) fn loss(self, found: f64, limit: f64) -> f64 {
        let outside = (self.least - found).max(found - self.most).max(0.0).min(limit);
        let apart = (found - self.most).abs().min(0.5 * limit);
        outside * outside + EXPLAINED * apart * apart
    }
}

/// A part and a whole.
pub(super) struct Sides<'a> {
    pub(super) part: &'a MapShape,
    pub(super) whole: &'a MapShape,
    /// Corresponding samples that are known: positions in both lists of samples.
    known: Vec<[usize; 2]>,
    /// Vertices of the part; its landmarks first.
    pub(super) xs: &'a [usize],
    /// Vertices of the whole; its landmarks first.
    pub(super) ys: &'a [usize],
    /// Distances in the part from landmarks (rows) to samples.
    pub(super) in_part: Matrix,
    /// The distances of all vertices of the part from the cut.
    pub(super) from_cut: Vec<f64>,
    /// Distances between the samples of the whole.
    pub(super) in_whole: Matrix,
    /// Curvatures at the samples, a row for each, over their standard deviation on the whole; without columns if there is no
    /// outside.
    curvatures: [Matrix; 2],
}

impl<'a> Sides<'a> {
    /// `None` unless the part has a cut. `pairs` are vertices of the part that are known to correspond to vertices of the whole.
    pub(super) fn new(
        part: &'a MapShape,
        whole: &'a MapShape,
        pairs: &[[VertexId; 2]],
    ) -> Result<Option<Self>, DescriptorError> {
        let Some(from_cut) = &part.from_cut else { return Ok(None) };
        let scale = part.size / whole.size;
        let from_cut = from_cut.iter().map(|d| d * scale).collect();
        let (xs, ys) = (&part.samples[..], &whole.samples[..]);
        let in_part = part.distances_to(xs)? * scale;
        let to_samples = whole.distances_to(ys)?;
        let in_whole = between(&to_samples, &to_samples);
        let curvatures = curvatures(part, whole, [xs, ys]);
        let mut sides =
            Self { part, whole, known: Vec::new(), xs, ys, in_part, from_cut, in_whole, curvatures };
        sides.known = sides.sampled(pairs.iter().copied()).collect();
        Ok(Some(sides))
    }

    /// Corresponding samples: those nearest to vertices of the part and of the whole.
    fn sampled(&self, pairs: impl Iterator<Item = [VertexId; 2]>) -> impl Iterator<Item = [usize; 2]> {
        pairs.map(|[x, y]| [self.part.nearest[x.index()], self.whole.nearest[y.index()]])
    }

    /// The landmarks of the part near which a vertex has a known partner, each with a sample near one of them.
    pub(super) fn anchors(&self, pairs: impl Iterator<Item = [VertexId; 2]>) -> Vec<(usize, usize)> {
        let n = self.n_landmarks()[0];
        let places: BTreeMap<usize, usize> =
            self.sampled(pairs).filter(|[x, _]| *x < n).map(|[x, y]| (x, y)).collect();
        places.into_iter().collect()
    }

    /// The length of one at unit area of the part.
    pub(super) fn scale(&self) -> f64 {
        self.part.size / self.whole.size
    }

    /// Numbers of landmarks of the part and of the whole that are samples.
    pub(super) fn n_landmarks(&self) -> [usize; 2] {
        [self.part.landmarks().len(), self.whole.landmarks().len()]
    }

    /// What is known of the distance of a landmark and a sample of the part.
    pub(super) fn known(&self, landmark: usize, x: usize) -> Known {
        self.known_of(landmark, self.xs[x], self.in_part[(landmark, x)])
    }

    /// What is known of the distance of a landmark and a vertex of the part, from their distance in it.
    pub(super) fn known_of(&self, landmark: usize, vertex: usize, most: f64) -> Known {
        let least = self.from_cut[self.xs[landmark]] + self.from_cut[vertex];
        Known { least: least.min(most), most }
    }

    /// How far places take the known samples from their partners, on average; 0 if none is known or placed.
    pub(super) fn miss(&self, places: &[usize]) -> f64 {
        let placed = self.known.iter().filter_map(|[x, y]| Some(self.in_whole[(*places.get(*x)?, *y)]));
        let (sum, n) = placed.fold((0.0, 0), |(sum, n), gap| (sum + gap, n + 1));
        sum / f64::from(n.max(1))
    }

    /// How much the losses of distances count that speak for a place.
    pub(super) fn loss(known: Known, found: f64) -> f64 {
        known.loss(found, MOST) / (MOST * MOST)
    }

    /// The mean squared difference of the curvatures of two samples, in units of their variance.
    pub(super) fn curvature_gap(&self, x: usize, y: usize) -> f64 {
        let [of_part, of_whole] = &self.curvatures;
        let to_cut = self.from_cut[self.xs[x]];
        let gap = |t: usize| {
            let gap = of_part[(x, t)] - of_whole[(y, t)];
            if to_cut > SMOOTHED[t] { (gap * gap).min(OUTLYING) } else { 0.0 }
        };
        (0..of_part.ncols()).map(gap).sum::<f64>() / SMOOTHED.len() as f64
    }
}

fn curvatures(part: &MapShape, whole: &MapShape, [xs, ys]: [&[usize]; 2]) -> [Matrix; 2] {
    let (Some(of_part), Some(of_whole)) = (&part.bends, &whole.bends) else {
        return [Matrix::zeros(xs.len(), 0), Matrix::zeros(ys.len(), 0)];
    };
    // Curvature is a length per area, and heat spreads in the unit of the whole.
    let at = |shape: &MapShape, bends: &DVector<f64>, vertices: &[usize]| {
        let LaplaceSpectrum { values, vectors, .. } = &shape.spectrum;
        let factor = (shape.size / whole.size).powi(-2);
        let unit = whole.size / (shape.size * shape.size);
        smoothed(bends, values, &vectors.select_rows(vertices), factor) * unit
    };
    let (mut on_part, mut on_whole) = (at(part, of_part, xs), at(whole, of_whole, ys));
    for (mut p, mut q) in on_part.column_iter_mut().zip(on_whole.column_iter_mut()) {
        let deviation = q.variance().sqrt().max(f64::MIN_POSITIVE);
        p /= deviation;
        q /= deviation;
    }
    [on_part, on_whole]
}
