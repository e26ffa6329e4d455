//! The search for the best maps of a part.

use descriptors::{Boundary, DescriptorError, Side};
use linalg::{LinalgError, Matrix};
use nalgebra::Cholesky;
use rayon::prelude::*;
use surface::VertexId;

use super::landmarks::placements;
use super::places::{Fineness, Places, change_of_curvature, change_of_distances, placed, placed_again};
use super::sides::{CURVATURE, Sides};
use super::vertices::{Coverage, all_vertices, onto_part};
use crate::local::vertex_confidence;
use crate::params::MapParams;
use crate::search::MapSearch;
use crate::sketch::SAMPLES_A_FUNCTION;
use crate::surface_map::{DOUBTED, MapKind, PartOfWhole, SurfaceMap};

/// Placements of landmarks that are extended to samples, and how finely. Conventions of time.
const SKETCHES: usize = 24;
const SKETCHED: Fineness = Fineness { xs: 150, ys: 400, anchors: 40, times: 2 };

/// Sketches are compared again with more samples: as many as there is time for.
const FINER: Fineness = Fineness { xs: 400, ys: usize::MAX, anchors: usize::MAX, times: 3 };

/// All samples.
const FINE: Fineness = Fineness { xs: usize::MAX, times: 1, ..FINER };

/// The odds that a map is right, and not the next best, are the ratio of their scores to this power: a map is certain if the
/// next best scores 1.4 times as much. Chosen on built-in men, of whom two of six were back to front with 1.1 and 1.4.
const STEEPNESS: f64 = 2.5;

/// Maps that change distances more than this are doubtful: right ones of built-in bodies change them by 0.014 to 0.032
/// in 25 of 26 pairs.
const DOUBTFUL: Boundary = Boundary::new(0.045, 8.0);

/// A map of samples with what ranks it.
struct ScoredPlaces {
    places: Places,
    agreement: Option<f64>,
    /// The mean change of distances.
    distortion: f64,
    /// Lower is better.
    score: f64,
    /// What its score was divided by: more than 1 for the initial map, so that another one must be
    /// clearly better.
    favor: f64,
}

impl ScoredPlaces {
    fn new(sides: &Sides<'_>, places: Places, favor: f64) -> Self {
        let distortion = change_of_distances(sides, &places);
        let curvature = change_of_curvature(sides, &places);
        // How far it takes known points from their partners on average, beyond what is respected.
        let miss = (sides.miss(&places) - sides.params.same).max(0.0);
        let functional = functional(sides, &places);
        let score = distortion + CURVATURE * curvature + miss;
        let agreement = functional.and_then(|map| sides.part.agreement(sides.whole, &map, &places));
        Self { agreement, distortion, score: score / favor, places, favor }
    }

    /// From the places of some samples, refined.
    fn refined(sides: &Sides<'_>, places: &[usize], fineness: Fineness, favor: f64) -> Self {
        Self::new(sides, placed_again(sides, places, fineness), favor)
    }

    fn kind(&self) -> MapKind {
        MapKind::from(self.agreement)
    }
}

/// The best maps of each orientation, one surface of which is a part of the other. Of what is known, landmarks and an initial map
/// count.
pub(crate) fn part_maps(search: &MapSearch<'_>, side: Side) -> Result<Vec<SurfaceMap>, DescriptorError> {
    let MapSearch { known, params, budget, .. } = *search;
    let Some(sides) = Sides::new(search, side)? else { return Ok(Vec::new()) };
    let starts = placements(&sides, SKETCHES);
    budget.check().map_err(LinalgError::from)?;
    let sketch = |places: &[usize], favor: f64| ScoredPlaces::refined(&sides, places, SKETCHED, favor);
    let start = |anchors: &Vec<(usize, usize)>| sketch(&placed(&sides, anchors, SKETCHED), 1.0);
    let mut found: Vec<ScoredPlaces> = starts.par_iter().map(start).collect();
    if let Some(mirror) = &sides.whole.mirrors(budget)?.sides {
        let itself = MapSearch { shapes: [sides.whole; 2], ..*search };
        let [mirror, _] = mirror.sample_maps(&itself.samples(SKETCHED.ys));
        let best = [MapKind::Direct, MapKind::Mirrored].map(|kind| {
            let of_kind = found.iter().filter(|found| found.kind() == kind);
            of_kind.min_by(|a, b| a.score.total_cmp(&b.score))
        });
        let image = |y: &usize| mirror.get(*y).copied().unwrap_or(*y);
        let composed = |best: &ScoredPlaces| sketch(&best.places.iter().map(image).collect::<Vec<_>>(), 1.0);
        let composed: Vec<ScoredPlaces> = best.into_iter().flatten().map(composed).collect();
        found.extend(composed);
    }
    let initial = sides.anchors(known.initial_pairs());
    if !initial.is_empty() {
        found.push(sketch(&placed(&sides, &initial, SKETCHED), params.clearly));
    }
    found.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut maps = Vec::new();
    for kind in MapKind::ALL {
        if kind == MapKind::Unoriented && !maps.is_empty() {
            break;
        }
        budget.check().map_err(LinalgError::from)?;
        let mut different: Vec<&ScoredPlaces> = Vec::new();
        for sketch in found.iter().filter(|found| found.kind() == kind) {
            let is_new = |other: &&ScoredPlaces| sides.gap(&sketch.places, &other.places) > params.same;
            if different.len() < params.sketches && different.iter().all(is_new) {
                different.push(sketch);
            }
        }
        let finer =
            |sketch: &&ScoredPlaces| ScoredPlaces::refined(&sides, &sketch.places, FINER, sketch.favor);
        let mut finer: Vec<ScoredPlaces> = different.iter().map(finer).collect();
        finer.sort_by(|a, b| a.score.total_cmp(&b.score));
        maps.extend(best(&sides, &finer)?);
    }
    Ok(maps)
}

/// The first of some maps in the order of their scores, refined; with the next one if that is nearly as good.
fn best(sides: &Sides<'_>, found: &[ScoredPlaces]) -> Result<Option<SurfaceMap>, DescriptorError> {
    let Some((best, others)) = found.split_first() else { return Ok(None) };
    let rival = others.iter().find(|other| sides.gap(&best.places, &other.places) > 2.0 * sides.params.same);
    let alone =
        MapParams { steepness: STEEPNESS, ..*sides.params }.odds(best.score, rival.map(|rival| rival.score));
    let mut confidence = alone * DOUBTFUL.probability(best.distortion);
    if sides.params.misses_one(&[sides.miss(&best.places)]) {
        confidence = confidence.min(DOUBTED);
    }
    let mut map = refined(sides, best, confidence)?;
    if let Some(rival) = rival.filter(|_| confidence < Boundary::CERTAIN) {
        map.alternative = Some(Box::new(refined(sides, rival, 1.0 - confidence)?));
    }
    Ok(Some(map))
}

fn refined(sides: &Sides<'_>, sketch: &ScoredPlaces, confidence: f64) -> Result<SurfaceMap, DescriptorError> {
    let fine = ScoredPlaces::refined(sides, &sketch.places, FINE, sketch.favor);
    let agreement = if fine.kind() == sketch.kind() { fine.agreement } else { sketch.agreement };
    let images = all_vertices(sides, &fine.places)?;
    let Coverage { covered, partners, matched } = onto_part(sides, &images)?;
    let mut functional = functional(sides, &fine.places).unwrap_or_else(|| Matrix::zeros(0, 0));
    let id = |v: &usize| VertexId::from(*v);
    let onto_whole = images.iter().map(|w| Some(id(w))).collect();
    let onto_part = partners.iter().zip(&matched).map(|(v, matched)| matched.then(|| id(v))).collect();
    if sides.side == Side::Second {
        functional = functional.transpose() * sides.scale.powi(2);
    }
    let side = sides.side;
    let (shapes, units) = (side.ordered([sides.part, sides.whole]), side.ordered([sides.scale, 1.0]));
    let [vertices, _] = side.ordered([images, partners]);
    Ok(SurfaceMap {
        kind: sketch.kind(),
        distortion: fine.distortion,
        agreement,
        confidence,
        vertices: vertices.iter().map(|v| Some(id(v))).collect(),
        vertex_confidence: vertex_confidence(shapes, units, &vertices)?,
        functional,
        part: Some(PartOfWhole { part: side, covered, partners: side.ordered([onto_whole, onto_part]) }),
        landmarks: Vec::new(),
        alternative: None,
    })
}

/// The map of the first eigenfunctions of the whole to those of the part with eigenvalues as low, by least squares over the samples.
fn functional(sides: &Sides<'_>, places: &[usize]) -> Option<Matrix> {
    let [part, whole] = [sides.part, sides.whole].map(|shape| &shape.spectrum);
    let n = sides.params.functions.min(whole.values.len());
    // Eigenvalues at unit area; those of the part in the unit of the whole are larger.
    let last = whole.values[n - 1] * sides.scale.powi(2);
    let k = part.values.iter().filter(|value| **value <= last).count().min(places.len() / SAMPLES_A_FUNCTION);
    let own = part.vectors.columns(0, k.max(1)).select_rows(&sides.part.samples[..places.len()]);
    let images: Vec<usize> = places.iter().map(|y| sides.whole.samples[*y]).collect();
    let pulled = whole.vectors.columns(0, n).select_rows(&images);
    Some(Cholesky::new(own.tr_mul(&own))?.solve(&own.tr_mul(&pulled)))
}
