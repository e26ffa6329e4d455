//! A part and a whole in the same unit: the square root of the area of the whole.

use std::collections::BTreeMap;

use descriptors::{DescriptorError, LaplaceSpectrum, Side};
use linalg::Matrix;
use nalgebra::DVector;
use surface::VertexId;

use crate::curvature::{TIMES, smoothed};
use crate::local::between;
use crate::params::MapParams;
use crate::search::MapSearch;
use crate::shape::MapShape;

/// Weight of distances that the cut explains, beside 1 for others: most of the shortest paths between points near the cut
/// stay in the part. A part of a built-in man is mapped to him with an error near the cut of 0.017, and of 0.042 with 0.
const EXPLAINED_WEIGHT: f64 = 0.3;

/// Weight of the mean squared difference of curvatures, beside 1 for distances: for squared ones in units of what is expected, where few
/// landmarks are placed, and for their mean change. Of 14 maps of built-in bodies, one more is wrong with twice that; of men, one more
/// is placed wrongly with 0.
pub(super) const CURVATURE: f64 = 0.1;

/// What is known of the distance of two points of the part in the whole: paths in the part are paths in the whole, and a path
/// through what is missing is at least as long as the distances of its ends from the cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    least: f64,
    most: f64,
}

impl Known {
    /// How much a distance in the whole speaks against this, with changes beyond `most` as much as there.
    pub(super) fn loss(self, found: f64, most: f64) -> f64 {
        let outside = (self.least - found).max(found - self.most).max(0.0).min(most);
        let apart = (found - self.most).abs().min(0.5 * most);
        outside * outside + EXPLAINED_WEIGHT * apart * apart
    }
}

/// A part and a whole.
pub(super) struct Sides<'a> {
    pub(super) part: &'a MapShape,
    pub(super) whole: &'a MapShape,
    /// Which of the two surfaces is the part.
    pub(super) side: Side,
    pub(super) params: &'a MapParams,
    /// The length of one at unit area of the part.
    pub(super) scale: f64,
    /// Corresponding samples that are known: positions in both lists of samples.
    known: Vec<[usize; 2]>,
    /// Distances in the part from landmarks (rows), the first of the samples, to samples.
    pub(super) in_part: Matrix,
    /// The distances of all vertices of the part from the cut.
    pub(super) from_cut: Vec<f64>,
    /// Distances between the samples of the whole, of which landmarks are the first.
    pub(super) in_whole: Matrix,
    /// Curvatures at the samples, a row for each, over their standard deviation on the whole; without columns if there is no
    /// outside.
    curvatures: [Matrix; 2],
}

impl<'a> Sides<'a> {
    /// `None` unless the part has a cut.
    pub(super) fn new(search: &MapSearch<'a>, side: Side) -> Result<Option<Self>, DescriptorError> {
        let MapSearch { shapes, known, params, .. } = *search;
        let [part, whole] = side.ordered(shapes);
        let Some(from_cut) = &part.from_cut else { return Ok(None) };
        let scale = part.size / whole.size;
        let to_samples = whole.distances_to(&whole.samples)?;
        let mut sides = Self {
            known: Vec::new(),
            in_part: part.distances_to(&part.samples)? * scale,
            from_cut: from_cut.iter().map(|d| d * scale).collect(),
            in_whole: between(&to_samples, &to_samples),
            curvatures: curvatures(part, whole),
            part,
            whole,
            side,
            params,
            scale,
        };
        sides.known = sides.sampled(known.landmarks.iter().copied()).collect();
        Ok(Some(sides))
    }

    /// Corresponding samples of the part and of the whole: those nearest to corresponding vertices of both surfaces.
    fn sampled(&self, pairs: impl Iterator<Item = [VertexId; 2]>) -> impl Iterator<Item = [usize; 2]> {
        pairs.map(|[x, y]| {
            let [x, y] = self.side.ordered([x, y]);
            [self.part.nearest[x.index()], self.whole.nearest[y.index()]]
        })
    }

    /// The landmarks of the part near which a vertex has a known partner, each with a sample near one of them.
    pub(super) fn anchors(&self, pairs: impl Iterator<Item = [VertexId; 2]>) -> Vec<(usize, usize)> {
        let of_landmarks = self.sampled(pairs).filter(|[x, _]| *x < self.in_part.nrows());
        of_landmarks.map(|[x, y]| (x, y)).collect::<BTreeMap<_, _>>().into_iter().collect()
    }

    /// Changes of distances count up to this when points are placed: the pairs of a few wrong anchors, or with a path through what is
    /// missing. A part of a built-in man is mapped to him with a mean error of 0.0140 with .1, and of 0.0142 with .2.
    pub(super) fn max_change(&self) -> f64 {
        2.0 * self.params.same
    }

    /// What is known of the distance of a landmark and a sample of the part.
    pub(super) fn known(&self, landmark: usize, x: usize) -> Known {
        self.known_of(landmark, self.part.samples[x], self.in_part[(landmark, x)])
    }

    /// What is known of the distance of a landmark and a vertex of the part, from their distance in it.
    pub(super) fn known_of(&self, landmark: usize, vertex: usize, most: f64) -> Known {
        let least = self.to_cut(landmark) + self.from_cut[vertex];
        Known { least: least.min(most), most }
    }

    /// The distance of a sample of the part from the cut.
    pub(super) fn to_cut(&self, x: usize) -> f64 {
        self.from_cut[self.part.samples[x]]
    }

    /// How far places take the known samples from their partners, on average; 0 if none is known or placed.
    pub(super) fn miss(&self, places: &[usize]) -> f64 {
        let placed = self.known.iter().filter_map(|[x, y]| Some(self.in_whole[(*places.get(*x)?, *y)]));
        let (sum, n) = placed.fold((0.0, 0), |(sum, n), gap| (sum + gap, n + 1));
        sum / f64::from(n.max(1))
    }

    /// How far the images of samples are apart, on average.
    pub(super) fn gap(&self, a: &[usize], b: &[usize]) -> f64 {
        a.iter().zip(b).map(|(y, z)| self.in_whole[(*y, *z)]).sum::<f64>() / a.len().max(1) as f64
    }

    /// The mean squared difference of the curvatures of two samples, in units of their variance, by as little smoothing as the
    /// cut leaves: two standard deviations of heat do not reach it.
    pub(super) fn curvature_gap(&self, x: usize, y: usize) -> f64 {
        let [of_part, of_whole] = &self.curvatures;
        let gap = |t: usize| {
            let gap: f64 = of_part[(x, t)] - of_whole[(y, t)];
            if self.to_cut(x) > (8.0 * TIMES[t]).sqrt() { gap * gap } else { 0.0 }
        };
        (0..of_part.ncols()).map(gap).sum::<f64>() / TIMES.len() as f64
    }
}

fn curvatures(part: &MapShape, whole: &MapShape) -> [Matrix; 2] {
    let (Some(of_part), Some(of_whole)) = (&part.mean_curvature, &whole.mean_curvature) else {
        return [part, whole].map(|shape| Matrix::zeros(shape.samples.len(), 0));
    };
    // Curvature is a length per area, and heat spreads in the unit of the whole.
    let at = |shape: &MapShape, curvature: &DVector<f64>| {
        let LaplaceSpectrum { values, vectors, .. } = &shape.spectrum;
        let factor = (shape.size / whole.size).powi(-2);
        let unit = whole.size / (shape.size * shape.size);
        smoothed(curvature, values, &vectors.select_rows(&shape.samples), factor) * unit
    };
    let (mut on_part, mut on_whole) = (at(part, of_part), at(whole, of_whole));
    for (mut p, mut q) in on_part.column_iter_mut().zip(on_whole.column_iter_mut()) {
        let deviation = q.variance().sqrt().max(f64::MIN_POSITIVE);
        p /= deviation;
        q /= deviation;
    }
    [on_part, on_whole]
}
