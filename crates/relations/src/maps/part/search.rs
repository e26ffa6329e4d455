//! The search for the best maps of a part.

use base::Observer;
use linalg::{LinalgError, Matrix};
use nalgebra::Cholesky;
use rayon::prelude::*;

use super::super::known::{CLEARLY_WORSE, KnownMap, RESPECTED};
use super::super::local::vertex_confidence;
use super::super::orientation::agreement;
use super::super::search::{mirrored_samples, odds};
use super::super::shape::MapShape;
use super::super::surface_map::{MapKind, PartOfWhole, SurfaceMap};
use super::landmarks::placements;
use super::places::{Fineness, Places, change_of_curvature, change_of_distances, placed, placed_again};
use super::sides::Sides;
use super::vertices::{Coverage, all_vertices, onto_part};
use crate::relation::Side;
use descriptors::{Boundary, DescriptorError};
use surface::VertexId;

/// Placements of landmarks that are extended to samples, and how finely. Conventions of time.
const SKETCHES: usize = 24;
const SKETCHED: Fineness = Fineness { xs: 150, ys: 400, anchors: 40, times: 2 };

/// The best sketches of each orientation are compared again with more samples: as many as there is time for.
const COMPARED: usize = 4;
const FINER: Fineness = Fineness { xs: 400, ys: usize::MAX, anchors: usize::MAX, times: 3 };

/// All samples.
const FINE: Fineness = Fineness { xs: usize::MAX, times: 1, ..FINER };

/// Conventions: eigenfunctions of the whole whose area forms tell the orientation, and of the part in which they are smoothed.
const ORIENTED: [usize; 2] = [13, 30];

/// Eigenfunctions of the whole in the map of functions, and in that whose [`defect`] counts. Conventions.
const FUNCTIONS: usize = 60;
const FEW_FUNCTIONS: usize = 40;

/// Two maps are one if the images of samples are less than this apart on average, and sketches if they are less than this. Safety
/// limits: sketches change by less when they are refined, and people turned back to front are three times as far apart.
const SAME: f64 = 0.12;
const SAME_SKETCH: f64 = 0.07;

/// The odds that a map is right, and not the next best, are the ratio of their scores to this power: a map is certain if the
/// next best scores 1.4 times as much. Chosen on built-in men, of whom two of six were back to front with 1.1 and 1.4.
const STEEPNESS: f64 = 2.5;

/// Maps that change distances more than this are doubtful: right ones of built-in bodies change them by 0.014 to 0.032
/// in 25 of 26 pairs.
const DOUBTFUL: Boundary = Boundary::new(0.045, 8.0);

/// Weights of the mean difference of curvatures and of the [`defect`], beside 1 for the mean change of distances. Chosen on 14
/// maps of built-in bodies, where with 0.2 instead of 0.1 one more is wrong; up to 0.02 instead of 0.01 none is.
const CURVATURE: f64 = 0.1;
const DEFECT: f64 = 0.01;

/// A map of samples with what ranks it.
struct Candidate {
    places: Places,
    agreement: Option<f64>,
    /// The mean change of distances.
    distortion: f64,
    /// Lower is better.
    score: f64,
    /// What its score was divided by: more than 1 for the initial map, so that another one must be
    /// [clearly better](CLEARLY_WORSE).
    favour: f64,
}

impl Candidate {
    fn new(sides: &Sides<'_>, places: Places, favour: f64) -> Self {
        let distortion = change_of_distances(sides, &places);
        let curvature = change_of_curvature(sides, &places);
        // How far it takes known points from their partners on average, beyond what is respected.
        let miss = (sides.miss(&places) - RESPECTED).max(0.0);
        let score = distortion + CURVATURE * curvature + DEFECT * defect(sides, &places) + miss;
        let agreement = orientation(sides, &places);
        Self { agreement, distortion, score: score / favour, places, favour }
    }

    /// From the places of some samples, refined.
    fn refined(sides: &Sides<'_>, places: &[usize], fineness: Fineness, favour: f64) -> Self {
        Self::new(sides, placed_again(sides, places, fineness), favour)
    }

    fn kind(&self) -> MapKind {
        MapKind::of(self.agreement)
    }
}

/// The best maps of each orientation from the first surface to the second, one of which is a part of the other. Of what is
/// `known`, landmarks and an initial map count.
pub(in crate::maps) fn part_maps(
    part: &MapShape,
    whole: &MapShape,
    side: Side,
    known: &KnownMap,
    observer: &dyn Observer,
) -> Result<Vec<SurfaceMap>, DescriptorError> {
    let budget = observer.budget();
    let onto_whole = |[x, y]: [VertexId; 2]| if side == Side::First { [x, y] } else { [y, x] };
    let pairs: Vec<[VertexId; 2]> = known.landmarks.iter().copied().map(onto_whole).collect();
    let Some(sides) = Sides::new(part, whole, &pairs)? else { return Ok(Vec::new()) };
    let starts = placements(&sides, SKETCHES)?;
    budget.check().map_err(LinalgError::from)?;
    let sketch = |places: &[usize], favour: f64| Candidate::refined(&sides, places, SKETCHED, favour);
    let start = |anchors: &Vec<(usize, usize)>| sketch(&placed(&sides, anchors, SKETCHED), 1.0);
    let mut found: Vec<Candidate> = starts.par_iter().map(start).collect();
    if let Some(mirror) = mirrored_samples(whole, &budget)? {
        let best = [MapKind::Direct, MapKind::Mirrored].map(|kind| {
            let of_kind = found.iter().filter(|found| found.kind() == kind);
            of_kind.min_by(|a, b| a.score.total_cmp(&b.score))
        });
        let image = |y: &usize| mirror.get(*y).copied().unwrap_or(*y);
        let composed = |best: &Candidate| sketch(&best.places.iter().map(image).collect::<Vec<_>>(), 1.0);
        let composed: Vec<Candidate> = best.into_iter().flatten().map(composed).collect();
        found.extend(composed);
    }
    let initial = sides.anchors(known.initial_pairs().map(onto_whole));
    if !initial.is_empty() {
        found.push(sketch(&placed(&sides, &initial, SKETCHED), CLEARLY_WORSE));
    }
    found.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut maps = Vec::new();
    for kind in MapKind::ALL {
        if kind == MapKind::Unoriented && !maps.is_empty() {
            break;
        }
        budget.check().map_err(LinalgError::from)?;
        let mut different: Vec<&Candidate> = Vec::new();
        for sketch in found.iter().filter(|found| found.kind() == kind) {
            let is_new = |other: &&Candidate| gap(&sides, &sketch.places, &other.places) > SAME_SKETCH;
            if different.len() < COMPARED && different.iter().all(is_new) {
                different.push(sketch);
            }
        }
        let finer = |sketch: &&Candidate| Candidate::refined(&sides, &sketch.places, FINER, sketch.favour);
        let mut finer: Vec<Candidate> = different.iter().map(finer).collect();
        finer.sort_by(|a, b| a.score.total_cmp(&b.score));
        maps.extend(best(&sides, &finer, side)?);
    }
    known.finished(maps, if side == Side::First { whole } else { part })
}

/// The first of some maps in the order of their scores, refined; with the next one if that is nearly as good.
fn best(sides: &Sides<'_>, found: &[Candidate], side: Side) -> Result<Option<SurfaceMap>, DescriptorError> {
    let Some((best, others)) = found.split_first() else { return Ok(None) };
    let rival = others.iter().find(|other| gap(sides, &best.places, &other.places) > SAME);
    let alone = odds(best.score, rival.map(|rival| rival.score), STEEPNESS);
    let confidence = alone * DOUBTFUL.probability(best.distortion);
    let confidence = KnownMap::doubted(confidence, &[sides.miss(&best.places)]);
    let mut map = refined(sides, best, confidence, side)?;
    if let Some(rival) = rival.filter(|_| confidence < SurfaceMap::CERTAIN) {
        map.alternative = Some(Box::new(refined(sides, rival, 1.0 - confidence, side)?));
    }
    Ok(Some(map))
}

/// How far the images of samples are apart, on average.
fn gap(sides: &Sides<'_>, a: &[usize], b: &[usize]) -> f64 {
    a.iter().zip(b).map(|(y, z)| sides.in_whole[(*y, *z)]).sum::<f64>() / a.len().max(1) as f64
}

fn refined(
    sides: &Sides<'_>,
    sketch: &Candidate,
    confidence: f64,
    side: Side,
) -> Result<SurfaceMap, DescriptorError> {
    let fine = Candidate::refined(sides, &sketch.places, FINE, sketch.favour);
    let agreement = if fine.kind() == sketch.kind() { fine.agreement } else { sketch.agreement };
    let images = all_vertices(sides, &fine.places)?;
    let Coverage { covered, partners, matched } = onto_part(sides, &images)?;
    let functional =
        functional(sides, &fine.places, FUNCTIONS, usize::MAX).unwrap_or_else(|| Matrix::zeros(0, 0));
    let (part, whole) = (sides.part, sides.whole);
    let vertex_confidence = match side {
        Side::First => vertex_confidence([part, whole], [sides.scale(), 1.0], &images)?,
        Side::Second => vertex_confidence([whole, part], [1.0, sides.scale()], &partners)?,
    };
    let id = |v: usize| VertexId::from(v);
    let onto_whole: Vec<_> = images.iter().map(|w| Some(id(*w))).collect();
    let onto_part = partners.iter().zip(&matched).map(|(v, matched)| matched.then(|| id(*v))).collect();
    let (vertices, partners, functional) = match side {
        Side::First => (images, [onto_whole, onto_part], functional),
        Side::Second => {
            let share = sides.scale().powi(2);
            (partners, [onto_part, onto_whole], functional.transpose() * share)
        }
    };
    Ok(SurfaceMap {
        kind: sketch.kind(),
        distortion: fine.distortion,
        agreement,
        confidence,
        vertices: vertices.into_iter().map(id).collect(),
        vertex_confidence,
        functional,
        part: Some(PartOfWhole { part: side, covered, partners }),
        alternative: None,
    })
}

/// Eigenfunctions at the samples of the part, and functions of the whole, pulled back: the first `n` eigenfunctions of the whole
/// in the first `k` of the part, by least squares over the samples.
fn pulled_back(sides: &Sides<'_>, places: &[usize], [k, n]: [usize; 2]) -> Option<Matrix> {
    let k = k.min(sides.part.spectrum.vectors.ncols()).min(places.len() / 3).max(1);
    let own = sides.part.spectrum.vectors.columns(0, k).select_rows(&sides.xs[..places.len()]);
    let images: Vec<usize> = places.iter().map(|y| sides.ys[*y]).collect();
    let pulled = sides.whole.spectrum.vectors.columns(0, n).select_rows(&images);
    Some(Cholesky::new(own.tr_mul(&own))?.solve(&own.tr_mul(&pulled)))
}

/// The map of the first `n` eigenfunctions of the whole to those of the part with eigenvalues as low, at most `most`.
fn functional(sides: &Sides<'_>, places: &[usize], n: usize, most: usize) -> Option<Matrix> {
    let n = n.min(sides.whole.spectrum.values.len());
    // Eigenvalues at unit area; those of the part in the unit of the whole are larger.
    let last = sides.whole.spectrum.values[n - 1] * sides.scale().powi(2);
    let k = sides.part.spectrum.values.iter().filter(|value| **value <= last).count();
    pulled_back(sides, places, [k.min(most), n])
}

/// How far a map preserves orientation.
fn orientation(sides: &Sides<'_>, places: &[usize]) -> Option<f64> {
    let (oriented, forms) = (sides.part.oriented.as_ref()?, sides.whole.area_forms.as_ref()?);
    let [n, k] = ORIENTED;
    let map = pulled_back(sides, places, [k, n.min(sides.whole.spectrum.values.len())])?;
    let pulled = sides.part.spectrum.vectors.columns(0, map.nrows()) * map;
    Some(agreement(&oriented.area_forms(&pulled, &sides.xs[..places.len()]), forms, places))
}

/// How far the map of functions is from one of a part, whose rows are orthonormal: `|C C' - I|² / k`.
fn defect(sides: &Sides<'_>, places: &[usize]) -> f64 {
    let Some(map) = functional(sides, places, FEW_FUNCTIONS, places.len() / 5) else { return 1.0 };
    // The eigenfunctions of the whole have norm 1 over its area.
    let map = map * sides.scale();
    let k = map.nrows();
    (&map * map.transpose() - Matrix::identity(k, k)).norm_squared() / k as f64
}
