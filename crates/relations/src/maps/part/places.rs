//! Places of all points of a part on the whole, by their distances from some that are placed.

use rayon::prelude::*;

use super::sides::Sides;

/// Weight of the difference of curvatures, beside 1 for the mean loss of distances. Chosen on built-in bodies.
const CURVATURE: f64 = 0.01;

/// Changes of distances count up to this in the mean: with a few wrong landmarks, a map may be right. A safety limit.
const MOST: f64 = 0.3;

/// Samples of the part, as many as are placed: positions among the samples of the whole.
pub(super) type Places = Vec<usize>;

/// How finely points are placed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fineness {
    /// Samples of the part and of the whole.
    pub(super) xs: usize,
    pub(super) ys: usize,
    /// Landmarks of the part by which all samples are placed again, and how often.
    pub(super) anchors: usize,
    pub(super) times: usize,
}

/// The place of each sample whose distances from the anchors fit best. `anchors` are landmarks of the part with their places.
pub(super) fn placed(sides: &Sides<'_>, anchors: &[(usize, usize)], fineness: Fineness) -> Places {
    let one = |x: usize| {
        let losses = losses(sides, anchors, x, fineness.ys.min(sides.ys.len()));
        (0..losses.len()).min_by(|y, z| losses[*y].total_cmp(&losses[*z])).unwrap_or(0)
    };
    (0..fineness.xs.min(sides.xs.len())).into_par_iter().map(one).collect()
}

/// Places by those of the first landmarks, again and again.
pub(super) fn placed_again(sides: &Sides<'_>, places: &[usize], fineness: Fineness) -> Places {
    let again = |places: Places, _| {
        let n = fineness.anchors.min(sides.n_landmarks()[0]).min(places.len());
        let anchors: Vec<(usize, usize)> = (0..n).map(|l| (l, places[l])).collect();
        placed(sides, &anchors, fineness)
    };
    (0..fineness.times).fold(places.to_vec(), again)
}

fn losses(sides: &Sides<'_>, anchors: &[(usize, usize)], x: usize, n: usize) -> Vec<f64> {
    let mut sums: Vec<f64> =
        (0..n).map(|y| CURVATURE * anchors.len() as f64 * sides.curvature_gap(x, y)).collect();
    for (landmark, place) in anchors {
        let known = sides.known(*landmark, x);
        let found = sides.in_whole.column(*place);
        sums.iter_mut().zip(found.iter()).for_each(|(sum, found)| *sum += Sides::loss(known, *found));
    }
    sums
}

/// The mean change of the distances between landmarks and samples.
pub(super) fn change_of_distances(sides: &Sides<'_>, places: &[usize]) -> f64 {
    let n = sides.n_landmarks()[0].min(places.len());
    let change = |l: usize, x: usize| {
        let found = sides.in_whole[(places[x], places[l])];
        (found - sides.in_part[(l, x)]).abs().min(MOST)
    };
    let changes = (0..n).flat_map(|l| (0..places.len()).map(move |x| change(l, x)));
    changes.sum::<f64>() / (n * places.len()).max(1) as f64
}

/// The mean squared difference of curvatures, in units of their variance.
pub(super) fn change_of_curvature(sides: &Sides<'_>, places: &[usize]) -> f64 {
    let changes = places.iter().enumerate().map(|(x, y)| sides.curvature_gap(x, *y));
    changes.sum::<f64>() / places.len().max(1) as f64
}
