//! What ranks maps among others.

use descriptors::DescriptorError;
use linalg::Matrix;

use crate::curvature::mismatch;
use crate::error::{LandmarkConflict, MapError};
use crate::functional::FunctionalMaps;
use crate::known::KnownMap;
use crate::local::mean_gap;
use crate::params::MapParams;
use crate::shape::{LIMB, MapShape};
use crate::sketch::Sketch;
use crate::surface_map::{MapKind, codistortion};

/// A map of functions and of samples, with what ranks it among others.
#[derive(Clone)]
pub(crate) struct Scored {
    pub(crate) functional: FunctionalMaps,
    /// Distances from the landmarks of the second surface to the images of those of the first, a column for each.
    pub(crate) to_images: Matrix,
    pub(crate) distortion: f64,
    pub(crate) agreement: Option<f64>,
    /// Lower is better: the distortion of distances, times the distance of the maps of functions from orthogonal ones,
    /// `(|C'C - I|² + |D'D - I|²) / k`, times the distances of the agreement and of the correlation of curvatures from 1. A man
    /// turned back to front keeps distances nearly as well as another pose does, but his map is no isometry in detail, and his
    /// belly is not bent as his back; a mixture of two maps keeps the orientation in some places only. Of two maps that differ
    /// by a mirror, the geometric mean: they are right together.
    pub(crate) score: f64,
    /// Maps that differ by left and right have the same number.
    pub(crate) coset: usize,
    /// How far it takes the landmarks from their partners, and how much that speaks against it.
    pub(crate) misses: Vec<f64>,
    pub(crate) penalty: f64,
}

impl Scored {
    pub(crate) fn new(
        [a, b]: [&MapShape; 2],
        known: &KnownMap,
        params: &MapParams,
        Sketch { maps: [forth, back], functional }: Sketch,
    ) -> Result<Self, DescriptorError> {
        let images = |from: &MapShape, map: &[usize], to: &MapShape| -> Vec<usize> {
            map.iter().take(from.landmarks().len()).map(|&i| to.samples[i]).collect()
        };
        let to_images = b.distances_to(&images(a, &forth, b))?;
        let distortion = codistortion(&a.distances_to(&images(b, &back, a))?, &to_images);
        let agreement = a.agreement(b, functional.to_first(), &forth);
        // Agreements nearer to 1 than refinement changes them are as good as 1.
        let missing = agreement.map_or(1.0, |agreement| (1.0 - agreement.abs()).max(0.5 * params.lost));
        let mismatch = match (&a.curvature, &b.curvature) {
            (Some(x), Some(y)) => 0.5 * (mismatch(x, y, &forth) + mismatch(y, x, &back)),
            _ => 1.0,
        };
        let score = distortion * functional.defect() * missing * mismatch;
        let misses = known.misses(&functional, [a, b])?;
        let penalty = params.penalty(&misses);
        Ok(Self { functional, to_images, distortion, agreement, score, coset: 0, misses, penalty })
    }

    pub(crate) fn kind(&self) -> MapKind {
        MapKind::from(self.agreement)
    }

    /// What ranks it.
    pub(crate) fn cost(&self) -> f64 {
        self.score * self.penalty
    }

    /// Whether two maps are nearly the same.
    pub(crate) fn is_same(&self, other: &Self, params: &MapParams) -> bool {
        mean_gap(&self.to_images, &other.to_images) < params.same
    }

    /// Whether it agrees less than maps that are [no mixtures](least_agreement).
    pub(crate) fn is_mixture(&self, least: f64) -> bool {
        self.agreement.is_some_and(|agreement| agreement.abs() < least)
    }
}

impl MapParams {
    /// How much less likely a map is the right one by the landmarks, as a factor for its score with the odds that follow: misses
    /// are as those of a normal distribution, but for outliers.
    fn penalty(&self, misses: &[f64]) -> f64 {
        // A landmark that is missed by more may be false itself: one of `exp(2 * 1.5²) = 90` is.
        let loss = |miss: &f64| 2.0 * (miss / self.same).min(self.clearly).powi(2);
        // Finite for any number of landmarks.
        (misses.iter().map(loss).sum::<f64>() / self.steepness).min(100.0).exp()
    }

    /// Whether a map misses a landmark by more than an outlier may be.
    pub(crate) fn misses_one(&self, misses: &[f64]) -> bool {
        misses.iter().any(|miss| *miss > self.clearly * self.same)
    }

    /// The least agreement of a map that is no mixture, from all maps of one kind.
    pub(crate) fn least_agreement(&self, found: &[Scored]) -> f64 {
        let agreements = found.iter().filter_map(|found| found.agreement);
        agreements.map(|agreement| agreement.abs() - self.lost).fold(self.pure, f64::max)
    }

    /// The best maps of each orientation that are not the same; those of none only if there are no others.
    pub(crate) fn distinct(&self, mut found: Vec<Scored>) -> Vec<Scored> {
        if found.iter().any(|found| found.kind() != MapKind::Unoriented) {
            found.retain(|found| found.kind() != MapKind::Unoriented);
        }
        found.sort_by(|x, y| x.cost().total_cmp(&y.cost()));
        let mut kept: Vec<Scored> = Vec::new();
        for next in found {
            let of_kind = || kept.iter().filter(|other| other.kind() == next.kind());
            if of_kind().count() < self.sketches && !of_kind().any(|other| next.is_same(other, self)) {
                kept.push(next);
            }
        }
        kept
    }

    /// How likely a map is the right one, and not its rival: the odds are the ratio of their scores to a power.
    pub(crate) fn odds(&self, score: f64, rival: Option<f64>) -> f64 {
        rival.map_or(1.0, |rival| 1.0 / (1.0 + (score / rival.max(f64::MIN_POSITIVE)).powf(self.steepness)))
    }
}

impl KnownMap {
    /// Refuses landmarks of both orientations: maps that were found without them show it, the direct and the mirrored one that fit
    /// most of them.
    pub(crate) fn check_orientation(&self, found: &[Scored], params: &MapParams) -> Result<(), MapError> {
        let best = |kind| {
            let of_kind =
                found.iter().rev().filter(|found| found.kind() == kind && !found.is_mixture(params.pure));
            of_kind.max_by_key(|found| found.misses.iter().filter(|miss| **miss < params.same).count())
        };
        let [Some(direct), Some(mirrored)] = [MapKind::Direct, MapKind::Mirrored].map(best) else {
            return Ok(());
        };
        let all: Vec<[f64; 2]> = direct.misses.iter().zip(&mirrored.misses).map(|(x, y)| [*x, *y]).collect();
        let fits = |miss: f64| miss < params.clearly * params.same;
        let only = |i: usize| all.iter().position(|both| fits(both[i]) && both[1 - i] > LIMB);
        match (only(0), only(1)) {
            // Maps that are both wrong leave others.
            (Some(i), Some(j)) if all.iter().all(|[x, y]| fits(x.min(*y))) => {
                let (landmarks, how) = ([i.min(j), i.max(j)], LandmarkConflict::Orientation);
                Err(MapError::Contradiction { landmarks, how })
            }
            _ => Ok(()),
        }
    }

    /// The maps of orientations that respect the landmarks: the best one is not clearly worse than that of the other.
    pub(crate) fn respecting(&self, mut found: Vec<Scored>, params: &MapParams) -> Vec<Scored> {
        if !self.landmarks.is_empty() {
            let costs = MapKind::ALL.map(|kind| {
                let of_kind = found.iter().filter(|found| found.kind() == kind);
                of_kind.map(Scored::cost).fold(f64::MAX, f64::min)
            });
            let least = costs.into_iter().fold(f64::MAX, f64::min);
            found.retain(|found| costs[found.kind() as usize] <= params.clearly * least);
        }
        found
    }
}
