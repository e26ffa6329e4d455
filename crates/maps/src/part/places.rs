//! Places of all points of a part on the whole, by their distances from some that are placed.

use rayon::prelude::*;

use super::sides::Sides;

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
    let n = fineness.ys.min(sides.in_whole.nrows());
    let one = |x: usize| {
        let mut losses = vec![0.0; n];
        for (landmark, place) in anchors {
            let known = sides.known(*landmark, x);
            let found = sides.in_whole.column(*place);
            losses
                .iter_mut()
                .zip(found.iter())
                .for_each(|(loss, found)| *loss += known.loss(*found, sides.max_change()));
        }
        (0..n).min_by(|y, z| losses[*y].total_cmp(&losses[*z])).unwrap_or(0)
    };
    (0..fineness.xs.min(sides.part.samples.len())).into_par_iter().map(one).collect()
}

/// Places by those of the first landmarks, again and again.
pub(super) fn placed_again(sides: &Sides<'_>, places: &[usize], fineness: Fineness) -> Places {
    let again = |places: Places, _| {
        let n = fineness.anchors.min(sides.in_part.nrows());
        let anchors: Vec<(usize, usize)> = places.into_iter().enumerate().take(n).collect();
        placed(sides, &anchors, fineness)
    };
    (0..fineness.times).fold(places.to_vec(), again)
}

/// The mean change of the distances between landmarks and samples.
pub(super) fn change_of_distances(sides: &Sides<'_>, places: &[usize]) -> f64 {
    let n = sides.in_part.nrows().min(places.len());
    let change = |l: usize, x: usize| (sides.in_whole[(places[x], places[l])] - sides.in_part[(l, x)]).abs();
    let changes = (0..n).flat_map(|l| (0..places.len()).map(move |x| change(l, x)));
    changes.sum::<f64>() / (n * places.len()).max(1) as f64
}

/// The mean squared difference of curvatures, in units of their variance.
pub(super) fn change_of_curvature(sides: &Sides<'_>, places: &[usize]) -> f64 {
    let changes = places.iter().enumerate().map(|(x, y)| sides.curvature_gap(x, *y));
    changes.sum::<f64>() / places.len().max(1) as f64
}
