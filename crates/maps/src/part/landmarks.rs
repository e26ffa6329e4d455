//! Where a few landmarks of a part may be on the whole.

use super::sides::{CURVATURE, Sides};
use crate::nearest_rows::first_of;

/// Landmarks of the part that are placed, at most. A convention.
const PLACED: usize = 12;

/// Hypotheses with fewer landmarks than this are all kept, up to `MANY`; of others those that are apart, up to `WIDTH`.
/// Safety limits of time.
const FEW: usize = 4;
const WIDTH: usize = 300;
const MANY: usize = 10 * WIDTH;

/// Places of the landmarks of a part.
struct Placement {
    /// A landmark of the whole for each of the chosen ones of the part.
    images: Vec<usize>,
    /// What speaks against it.
    score: f64,
}

/// Landmarks of the part, far from each other and from the cut, with possible places for them, the best first and no two alike.
///
/// Landmark after landmark goes to all of the whole; what keeps distances and curvatures best is kept.
pub(super) fn placements(sides: &Sides<'_>, n: usize) -> Vec<Vec<(usize, usize)>> {
    let chosen = chosen(sides);
    if chosen.is_empty() {
        return Vec::new();
    }
    let mut found = vec![Placement { images: Vec::new(), score: 0.0 }];
    for (k, l) in chosen.iter().enumerate() {
        let known: Vec<_> = chosen[..k].iter().map(|before| sides.known(*before, *l)).collect();
        let alone: Vec<f64> =
            (0..sides.whole.landmarks().len()).map(|y| CURVATURE * sides.curvature_gap(*l, y)).collect();
        let mut longer = Vec::new();
        for (h, placed) in found.iter().enumerate() {
            for (y, alone) in alone.iter().enumerate() {
                let losses = placed.images.iter().zip(&known);
                let losses = losses.map(|(z, known)| known.loss(sides.in_whole[(y, *z)], f64::INFINITY));
                longer.push((placed.score + losses.sum::<f64>() / sides.params.same.powi(2) + alone, (h, y)));
            }
        }
        let longer = first_of(longer, MANY).into_iter().map(|(score, (h, y))| {
            let images = found[h].images.iter().copied().chain([y]).collect();
            Placement { images, score }
        });
        let longer: Vec<Placement> = longer.collect();
        found = if k < FEW { longer } else { apart(sides, longer, WIDTH) };
    }
    let anchors = |placed: Placement| chosen.iter().copied().zip(placed.images).collect();
    apart(sides, found, n).into_iter().map(anchors).collect()
}

/// The first `n` that differ: whose landmarks are apart on average, not next to each other.
fn apart(sides: &Sides<'_>, placements: Vec<Placement>, n: usize) -> Vec<Placement> {
    let mut kept: Vec<Placement> = Vec::new();
    for placed in placements {
        if kept.len() >= n {
            break;
        }
        let limit = 2.0 * sides.params.same * placed.images.len() as f64;
        let is_new = |other: &Placement| {
            let gaps = other.images.iter().zip(&placed.images).map(|(y, z)| sides.in_whole[(*y, *z)]);
            gaps.sum::<f64>() >= limit
        };
        if kept.iter().all(is_new) {
            kept.push(placed);
        }
    }
    kept
}

/// Landmarks of the part, each the farthest from those before it; the first is farthest from the cut.
fn chosen(sides: &Sides<'_>) -> Vec<usize> {
    let far: Vec<usize> =
        (0..sides.in_part.nrows()).filter(|l| sides.to_cut(*l) > 2.0 * sides.params.same).collect();
    let mut gaps: Vec<f64> = far.iter().map(|l| sides.to_cut(*l)).collect();
    let mut chosen = Vec::new();
    while chosen.len() < PLACED.min(far.len()) {
        let farthest = (0..far.len()).max_by(|a, b| gaps[*a].total_cmp(&gaps[*b]).then(b.cmp(a)));
        let Some(next) = farthest.map(|i| far[i]) else { break };
        let lower = |(gap, l): (&mut f64, &usize)| *gap = gap.min(sides.in_part[(next, *l)]);
        gaps.iter_mut().zip(&far).for_each(lower);
        chosen.push(next);
    }
    chosen
}
