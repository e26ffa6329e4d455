//! Shapes of which a part is missing: what a cut cannot change is compared with whole shapes.

use linalg::LandmarkDistances;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::DescriptorError;

/// Radii at which areas of discs are compared, relative to the square root of the area of the whole: each is 1.21 times the one
/// before, so that their [soft](SOFT) rims leave no gap between them.
const RADII: usize = 20;

/// The smallest and the largest radius. `experiments run robustness` measures what follows from the choice.
const RANGE: [f64; 2] = [0.06, 2.2];

/// Shares of the whole that the part may be: half of a shape is found less reliably (`experiments run robustness`).
const SHARES: [f64; 9] = [1.0, 0.93, 0.86, 0.8, 0.74, 0.69, 0.64, 0.57, 0.5];

/// A disc begins to count a point at this share of its radius before its rim, and counts it fully as far behind it. A
/// tolerance of sampling.
const SOFT: f64 = 0.1;

/// Differences of logarithms of areas beyond this count linearly (Huber's loss). A safety limit.
const OUTLYING: f64 = 0.3;

/// The areas of geodesic discs of all radii around the landmarks of a whole surface.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscAreas {
    /// Logarithms of shares of the area, a row for each landmark.
    rows: Vec<[f64; RADII]>,
}

/// What is known of the areas of geodesic discs around the landmarks of a part of a surface, for every share of the whole that
/// the part may be.
///
/// A disc that does not reach the cut is the disc of the whole. Of a larger one, the part knows bounds: paths in the part
/// are paths in the whole, so the disc of the whole has at least the points of the part that are as near in the part. It has
/// at most those, the points `y` with `b(x) + b(y) <= r`, where `b` is the distance from the cut, because a path
/// through what is missing leaves and enters by the cut; and what is missing within `r - b(x)` of the cut.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartDiscAreas {
    /// The share of the part around each landmark.
    weights: Vec<f64>,
    /// For every share, and every landmark, the logarithms of the least and of the largest possible area.
    bounds: Vec<Vec<[[f64; 2]; RADII]>>,
}

/// How well a part fits into a whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartDistance {
    /// Root mean square of the differences of logarithms of areas that no missing part explains; 0 if all fit.
    pub distance: f64,
    /// The share of the whole that the part has if it fits best.
    pub share: f64,
}

fn radius(i: usize) -> f64 {
    RANGE[0] * (RANGE[1] / RANGE[0]).powf(i as f64 / (RADII - 1) as f64)
}

/// The masses of discs of all radii, in units of a length, from the distances and the masses of points. Points near the rim of a disc
/// count in part: fully at `r (1 - SOFT)`, not at all at `r (1 + SOFT)`, and linearly between.
fn disc_masses(unit: f64, points: impl Iterator<Item = (f64, f64)>) -> [f64; RADII] {
    let rims: [[f64; 2]; RADII] =
        std::array::from_fn(|i| [1.0 - SOFT, 1.0 + SOFT].map(|end| end * radius(i) * unit));
    let inners = rims.map(|[inner, _]| inner);
    // Sums of the masses that a disc and all larger ones count fully, and of what each counts of the points at its rim.
    let (mut sums, mut at_rim) = ([0.0; RADII + 1], [0.0; RADII]);
    for (d, m) in points {
        let first = inners.iter().filter(|inner| **inner < d).count();
        sums[first] += m;
        let mut i = first;
        while i > 0 && rims[i - 1][1] > d {
            i -= 1;
            let [inner, outer] = rims[i];
            at_rim[i] += m * (outer - d) / (outer - inner);
        }
    }
    let mut sum = 0.0;
    std::array::from_fn(|i| {
        sum += sums[i];
        sum + at_rim[i]
    })
}

fn check(distances: &LandmarkDistances, masses: &[f64]) -> Result<f64, DescriptorError> {
    let p = distances.n_points();
    if masses.len() != p {
        return Err(DescriptorError::SizeMismatch { n_points: p, n_vertices: masses.len() });
    }
    let area: f64 = masses.iter().sum();
    match area > 0.0 {
        true => Ok(area),
        false => Err(DescriptorError::NoExtent { n_points: p }),
    }
}

impl PartDistance {
    /// A part of a shape has a smaller distance from other shapes of the class, and as a rule a larger one from shapes of other
    /// classes. Chosen on the built-in shapes, of which parts had .013 to .025 and .023 to .068 in the median.
    pub const SAME_CLASS: f64 = 0.03;
}

impl DiscAreas {
    /// Landmarks of a whole whose discs are kept, the first ones. Farthest point sampling spreads them over the surface.
    pub const LANDMARKS: usize = 100;

    /// The areas around the first landmarks. `masses` are areas around the points, in the squared unit of the distances.
    ///
    /// # Errors
    /// [`DescriptorError::SizeMismatch`] unless there is one mass per point, [`DescriptorError::NoExtent`] without area,
    /// [`DescriptorError::Linalg`].
    pub fn new(distances: &LandmarkDistances, masses: &[f64]) -> Result<Self, DescriptorError> {
        let area = check(distances, masses)?;
        let row = |landmark| {
            let column = distances.column(landmark)?;
            let points = column.iter().copied().zip(masses.iter().copied());
            Ok(disc_masses(area.sqrt(), points).map(|mass| (mass / area).ln()))
        };
        let n = distances.n_landmarks().min(Self::LANDMARKS);
        Ok(Self { rows: (0..n).map(row).collect::<Result<_, DescriptorError>>()? })
    }

    /// The numbers, as an index stores them: the areas of one landmark after those of another.
    pub fn to_numbers(&self) -> Vec<f32> {
        self.rows.as_flattened().iter().map(|area| *area as f32).collect()
    }

    /// From stored [numbers](Self::to_numbers); `None` if they are not whole rows.
    pub fn from_numbers(numbers: &[f32]) -> Option<Self> {
        let (rows, rest) = numbers.as_chunks::<RADII>();
        rest.is_empty().then(|| Self { rows: rows.iter().map(|row| row.map(f64::from)).collect() })
    }
}

impl PartDiscAreas {
    /// The bounds around the landmarks of a part. `from_cut` are the distances of the points from the cut, infinite if nothing
    /// is missing, and `cut` is its length.
    ///
    /// # Errors
    /// As [`DiscAreas::new`].
    pub fn new(
        distances: &LandmarkDistances,
        masses: &[f64],
        from_cut: &[f64],
        cut: f64,
    ) -> Result<Self, DescriptorError> {
        let part = check(distances, masses)?;
        if from_cut.len() != masses.len() {
            return Err(DescriptorError::SizeMismatch { n_points: masses.len(), n_vertices: from_cut.len() });
        }
        let n = distances.n_landmarks();
        let columns: Vec<_> = (0..n).map(|j| distances.column(j)).collect::<Result<_, _>>()?;
        let mut weights = vec![0.0; n];
        for (v, mass) in masses.iter().enumerate() {
            let nearest = (0..n).min_by(|a, b| columns[*a][v].total_cmp(&columns[*b][v]));
            nearest.into_iter().for_each(|j| weights[j] += mass / part);
        }
        let of_share = |share: f64| {
            let (whole, unit) = (part / share, (part / share).sqrt());
            let of_landmark = |j: usize| {
                let to_cut = from_cut[distances.landmarks()[j]];
                let points = || columns[j].iter().zip(from_cut).zip(masses);
                // In the part, and by the cut and through what is missing.
                let least = disc_masses(unit, points().map(|((d, _), m)| (*d, *m)));
                let most = disc_masses(unit, points().map(|((d, b), m)| (d.min(to_cut + b), *m)));
                std::array::from_fn(|i| {
                    // What is missing begins at the cut and widens in all directions.
                    let beyond = (radius(i) * unit * (1.0 + SOFT) - to_cut).max(0.0);
                    let missing = (cut * beyond + std::f64::consts::PI * beyond * beyond).min(whole - part);
                    [(least[i] / whole).ln(), ((most[i] + missing) / whole).min(1.0).ln()]
                })
            };
            (0..n).map(of_landmark).collect()
        };
        let bounds = SHARES.into_par_iter().map(of_share).collect();
        Ok(Self { weights, bounds })
    }

    /// How well the part fits into a whole: every landmark of the part is compared with the landmark of the whole that fits it
    /// best.
    pub fn distance(&self, whole: &DiscAreas) -> PartDistance {
        let misfits = self.bounds.iter().zip(SHARES).map(|(bounds, share)| {
            let misfit = bounds.iter().zip(&self.weights).map(|(bounds, weight)| {
                let best = whole.rows.iter().map(|row| misfit(bounds, row)).fold(f64::INFINITY, f64::min);
                weight * best
            });
            PartDistance { distance: (misfit.sum::<f64>() / RADII as f64).sqrt(), share }
        });
        let nothing = PartDistance { distance: f64::INFINITY, share: 1.0 };
        misfits.fold(nothing, |best, found| if found.distance < best.distance { found } else { best })
    }
}

/// The sum of the losses of all radii.
fn misfit(bounds: &[[f64; 2]; RADII], row: &[f64; RADII]) -> f64 {
    let loss = |([low, high], value): (&[f64; 2], &f64)| {
        let gap = (low - value).max(value - high).max(0.0);
        if gap > OUTLYING { OUTLYING * (2.0 * gap - OUTLYING) } else { gap * gap }
    };
    bounds.iter().zip(row).map(loss).sum()
}
