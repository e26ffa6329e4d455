//! Places of all points of a part on the whole, by their distances from some that are placed.

use rayon::prelude::*;

use super::sides::Sides;

/// Weight of the difference of curvatures, beside 1 for the mean loss of distances. Chosen on built-in bodies.
const CURVATURE: f64 = 0.01;

/// Samples of the part, as many as are placed: positions among the samples of the whole.
pub(super) type Places = Vec<usize>;

/// How finely points are placed: the numbers of samples of the part and of the whole.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fineness {
    pub(super) xs: usize,
    pub(super) ys: usize,
}

/// The place of each sample whose distances from the anchors fit best. `anchors` are landmarks of the part with their places.
pub(super) fn placed(sides: &Sides<'_>, anchors: &[(usize, usize)], fineness: Fineness) -> Places {
    let one = |x: usize| {
        let losses = losses(sides, anchors, x, fineness.ys.min(sides.ys.len()));
        (0..losses.len()).min_by(|y, z| losses[*y].total_cmp(&losses[*z])).unwrap_or(0)
    };
    (0..fineness.xs.min(sides.xs.len())).into_par_iter().map(one).collect()
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

/// Places with all of the first `n` landmarks as anchors.
pub(super) fn placed_again(sides: &Sides<'_>, places: &Places, n: usize, fineness: Fineness) -> Places {
    let n = n.min(sides.n_landmarks()[0]).min(places.len());
    let anchors: Vec<(usize, usize)> = (0..n).map(|l| (l, places[l])).collect();
    placed(sides, &anchors, fineness)
}

/// The mean change of the distances between landmarks and samples: its size, and its loss with the mean difference of
/// curvatures.
pub(super) struct Changes {
    pub(super) distances: f64,
    pub(super) unexplained: f64,
    pub(super) curvature: f64,
}

impl Changes {
    pub(super) fn of(sides: &Sides<'_>, places: &Places) -> Self {
        let n = sides.n_landmarks()[0].min(places.len());
        let (mut distances, mut unexplained) = (0.0, 0.0);
        for l in 0..n {
            for (x, place) in places.iter().enumerate() {
                let known = sides.known(l, x);
                let found = sides.in_whole[(*place, places[l])];
                distances += (found - known.most).abs().min(0.3);
                unexplained += (known.least - found).max(found - known.most).max(0.0);
            }
        }
        let curvature: f64 = places.iter().enumerate().map(|(x, y)| sides.curvature_gap(x, *y)).sum();
        let n_pairs = (n * places.len()).max(1) as f64;
        Self {
            distances: distances / n_pairs,
            unexplained: unexplained / n_pairs,
            curvature: curvature / places.len().max(1) as f64,
        }
    }
}
