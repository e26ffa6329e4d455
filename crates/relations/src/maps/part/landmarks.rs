//! Where a few landmarks of a part may be on the whole.

use linalg::Matrix;

use super::super::nearest_rows::first_of;
use super::super::shape::MapShape;
use super::sides::Sides;
use descriptors::DescriptorError;

/// Landmarks of the part that are placed, at most, and their least distance from the cut. Conventions.
const PLACED: usize = 12;
const LEAST_TO_CUT: f64 = 0.12;

/// Changes of distances that are expected, beside the gaps between the landmarks of the whole, and those beyond which all count
/// alike. Conventions.
const EXPECTED: f64 = 0.06;
const MOST: f64 = 0.25;

/// Weights of curvature and of the areas of discs, beside 1 for each squared distance in units of [`EXPECTED`].
/// Conventions: among the 24 best placements on built-in bodies, one is right as a rule.
const CURVATURE: f64 = 0.3;
const AREAS: f64 = 40.0;

/// Radii of discs. A convention.
const RADII: [f64; 6] = [0.1, 0.2, 0.35, 0.6, 1.0, 1.5];

/// The rim of a disc is so wide, relative to the radius, and differences of logarithms of areas count up to this. Tolerances.
const RIM: f64 = 0.1;
const OUTLYING: f64 = 0.5;

/// Hypotheses with fewer landmarks than this are all kept, up to `MANY`; of others those that are apart, up to `WIDTH`.
/// Safety limits of time.
const FEW: usize = 4;
const MANY: usize = 3000;
const WIDTH: usize = 300;

/// Hypotheses are the same if their landmarks are less than this apart on average: next to each other. A convention.
const APART: f64 = 0.12;

/// Places of the landmarks of a part.
struct Placement {
    /// A landmark of the whole for each of the chosen ones of the part.
    images: Vec<usize>,
    /// What speaks against it.
    score: f64,
}

/// Landmarks of the part, far from each other and from the cut, with possible places for them, the best first and no two alike.
///
/// Landmark after landmark goes to all of the whole; what keeps distances, curvatures and areas of discs best is kept.
pub(super) fn placements(sides: &Sides<'_>, n: usize) -> Result<Vec<Vec<(usize, usize)>>, DescriptorError> {
    let chosen = chosen(sides);
    if chosen.is_empty() {
        return Ok(Vec::new());
    }
    let mut found = vec![Placement { images: Vec::new(), score: 0.0 }];
    for (k, alone) in alone(sides, &chosen)?.iter().enumerate() {
        let known: Vec<_> = (0..k).map(|j| sides.known(chosen[j], chosen[k])).collect();
        let mut longer = Vec::new();
        for (h, placed) in found.iter().enumerate() {
            for (y, alone) in alone.iter().enumerate() {
                let losses = placed.images.iter().zip(&known);
                let losses = losses.map(|(z, known)| known.loss(sides.in_whole[(y, *z)], MOST));
                longer.push((placed.score + losses.sum::<f64>() / (EXPECTED * EXPECTED) + alone, (h, y)));
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
    Ok(apart(sides, found, n).into_iter().map(anchors).collect())
}

/// The first `n` that differ.
fn apart(sides: &Sides<'_>, placements: Vec<Placement>, n: usize) -> Vec<Placement> {
    let mut kept: Vec<Placement> = Vec::new();
    for placed in placements {
        if kept.len() >= n {
            break;
        }
        let limit = APART * placed.images.len() as f64;
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
    let [n, _] = sides.n_landmarks();
    let to_cut = |l: usize| sides.from_cut[sides.xs[l]];
    let far: Vec<usize> = (0..n).filter(|l| to_cut(*l) > LEAST_TO_CUT).collect();
    let mut gaps: Vec<f64> = far.iter().map(|l| to_cut(*l)).collect();
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

/// How much speaks against each landmark of the whole as the place of each chosen one of the part: curvature, and the areas of
/// discs. The disc of the whole has at least the area of that of the part, and the same if it does not reach the cut.
fn alone(sides: &Sides<'_>, chosen: &[usize]) -> Result<Vec<Vec<f64>>, DescriptorError> {
    let [_, n_whole] = sides.n_landmarks();
    let scale = sides.scale();
    let of_part = areas(sides.part, scale, chosen)?;
    let of_whole = areas(sides.whole, 1.0, &(0..n_whole).collect::<Vec<_>>())?;
    let one = |(i, l): (usize, &usize)| -> Vec<f64> {
        let to_cut = sides.from_cut[sides.xs[*l]];
        let of_areas = |y: usize| {
            let loss = |r: usize| {
                let gap = of_whole[(r, y)] - of_part[(r, i)];
                let gap = if RADII[r] * (1.0 + RIM) < to_cut { gap.abs() } else { (-gap).max(0.0) };
                gap.min(OUTLYING).powi(2)
            };
            (0..RADII.len()).map(loss).sum::<f64>() / RADII.len() as f64
        };
        let all = |y: usize| CURVATURE * sides.curvature_gap(*l, y) + AREAS * of_areas(y);
        (0..n_whole).map(all).collect()
    };
    Ok(chosen.iter().enumerate().map(one).collect())
}

/// Logarithms of the areas of discs around landmarks, a column for each, over the area of the whole. `scale` is the length of
/// one at unit area of the shape.
fn areas(shape: &MapShape, scale: f64, landmarks: &[usize]) -> Result<Matrix, DescriptorError> {
    let distances = shape.all_distances()?;
    let mut found = Matrix::zeros(RADII.len(), landmarks.len());
    for (i, l) in landmarks.iter().enumerate() {
        for (r, radius) in RADII.iter().enumerate() {
            let share = |(d, mass): (&f64, &f64)| {
                let inside = (radius * (1.0 + RIM) - d * scale) / (2.0 * RIM * radius);
                inside.clamp(0.0, 1.0) * mass
            };
            let area: f64 = distances.row(*l).iter().zip(&shape.spectrum.masses).map(share).sum();
            found[(r, i)] = (area * scale * scale).max(f64::MIN_POSITIVE).ln();
        }
    }
    Ok(found)
}
