//! The search for the best maps.

use base::{Budget, Observer};
use linalg::{LinalgError, Matrix};
use rayon::prelude::*;

use super::curvature::mismatch;
use super::error::{LandmarkConflict, MapError};
use super::functional_map::{FunctionalMaps, Placed, SampledPair, TwoWayMap, schedule, zoom_out};
use super::known::{CLEARLY_WORSE, DOUBTED, KnownMap, OUTLYING, RESPECTED, UNFIT};
use super::local::mean_gap;
use super::operators::{FITTED, fitted};
use super::orientation::{FUNCTIONS as FORMS, agreement};
use super::shape::{MapShape, Mirrors};
use super::surface_map::{MapKind, SurfaceMap, codistortion};
use descriptors::{Alignment, Boundary, DescriptorError, NearestPoints, alignments};

// `experiments run matching` measures the maps that follow from these limits.

/// Samples by which all starts are refined a little, and eigenfunctions of their last step: enough to tell which are the same.
const ROUGH: usize = 200;
const ROUGH_FUNCTIONS: usize = 30;

/// Different maps of each orientation that are sketched.
const SKETCHES: usize = 4;

/// Samples by which sketches are refined and compared, and eigenfunctions of their last step.
const SKETCHED: usize = 400;
const SKETCH_FUNCTIONS: usize = 60;

/// Eigenfunctions of the first step of a map from an alignment.
const FIRST: usize = 6;

/// Maps whose images are less than this apart on average, as a share of the square root of the area, are one. A safety limit.
const SAME: f64 = 0.06;

/// A surface is alike under a mirror if a map to itself that reverses its orientation changes distances by less than this, and
/// is no mixture: agrees with the reversal beyond [`PURE`]. A safety limit: bodies in different poses have .02 to .04.
const SYMMETRIC: f64 = 0.06;

/// Most such maps of a surface: people are nearly alike from left to right, and from back to front.
const MIRRORS: usize = 2;

/// A mirror that moves points by less than this on average, as a share of the square root of the area, exchanges front and back.
/// A convention between the distances on built-in people (.06 to .07) and those of left and right (.18 and more, of cats).
const THICK: f64 = 0.12;

/// A map that agrees less with an orientation is a mixture of two, at least in parts. Right maps of built-in shapes have .85 and
/// more, those of cats of 5,000 vertices .79 and more, and most mixtures less than .7.
const PURE: f64 = 0.7;

/// A map that agrees so much less than another one, or than before its refinement, mixes two maps. A safety limit: refinement
/// changes the agreement by less than .05 otherwise, and right maps of one pair have the same but for .03.
const LOST: f64 = 0.1;

/// Agreements nearer to 1 than this are as good as 1. A tolerance.
const FULL: f64 = 0.05;

/// The odds that a map is right, and not the next best, are the ratio of their scores to this power. Chosen on built-in people,
/// where the rival of a wrong map scores less than 1.28 times as much, and that of nearly all right ones more: a ratio of 1.28
/// is where maps become [certain](SurfaceMap::CERTAIN).
const STEEPNESS: f64 = 3.4;

/// A map of functions and of samples, with what ranks it among others.
#[derive(Clone)]
struct Candidate {
    functional: FunctionalMaps,
    /// Distances from the landmarks of the second surface to the images of those of the first, a column for each.
    to_images: Matrix,
    distortion: f64,
    agreement: Option<f64>,
    /// Lower is better: the distortion of distances, times the distance of the maps of functions from orthogonal ones,
    /// `(|C'C - I|² + |D'D - I|²) / k`, times the distances of the agreement and of the correlation of curvatures from 1. A man
    /// turned back to front keeps distances nearly as well as another pose does, but his map is no isometry in detail, and his
    /// belly is not bent as his back; a mixture of two maps keeps the orientation in some places only. Of two maps that differ
    /// by a mirror, the geometric mean: they are right together.
    score: f64,
    /// How far it takes the landmarks from their partners, and how much that speaks against it.
    misses: Vec<f64>,
    penalty: f64,
}

impl Candidate {
    fn kind(&self) -> MapKind {
        MapKind::of(self.agreement)
    }

    /// What ranks it.
    fn cost(&self) -> f64 {
        self.score * self.penalty
    }

    /// Whether two maps are nearly the same.
    fn is_same(&self, other: &Self) -> bool {
        mean_gap(&self.to_images, &other.to_images) < SAME
    }

    /// Whether it agrees less than maps that are [no mixtures](least_agreement).
    fn is_mixture(&self, least: f64) -> bool {
        self.agreement.is_some_and(|agreement| agreement.abs() < least)
    }
}

/// The least agreement of a map that is no mixture, from all maps of one kind.
fn least_agreement(found: &[Candidate]) -> f64 {
    let agreements = found.iter().filter_map(|found| found.agreement);
    agreements.map(|agreement| agreement.abs() - LOST).fold(PURE, f64::max)
}

/// The best maps of the first surface to the second, one for each orientation: the direct one first, unless it distorts
/// distances clearly more.
///
/// 1. Maps of functions are fitted in closed form to the curvature and the wave kernels of both surfaces, once for each
///    orientation (`ren2018` in `REFERENCES.bib`). Each alignment of the forms maps samples to the nearest ones, too.
/// 2. All these maps are refined with few samples, by taking in eigenfunctions of higher frequency, there and back (ZoomOut,
///    `melzi2019`); the best different ones then with more.
/// 3. Each map is followed by the mirrors of the surfaces, which exchange left and right, or front and back. A map and one that
///    differs by a mirror are scored together.
/// 4. Of each orientation, the one that keeps distances, the products of functions and the orientation best is refined on all
///    samples and eigenfunctions, and all vertices follow. How much worse the next best is says how certain it is.
///
/// Shapes that are alike under a mirror have two maps of small distortion; for others, one of the two has a large
/// distortion. If a surface cannot be oriented, there is one map.
///
/// What is `known` of the map enters all of it: landmarks, as heat that is placed at them, and functions are fitted, too; how far
/// maps miss the landmarks is part of their score, and the last fit is to them as well; and an initial map is one more start, which comes out unless another map is
/// clearly better. At most `eigenfunctions` of each surface are used.
///
/// # Errors
/// [`MapError::Contradiction`] for landmarks of both orientations; [`MapError::Descriptor`], also if the budget of the observer
/// is exceeded.
pub(super) fn map_wholes(
    a: &MapShape,
    b: &MapShape,
    known: &KnownMap,
    eigenfunctions: usize,
    observer: &dyn Observer,
) -> Result<Vec<SurfaceMap>, MapError> {
    let budget = observer.budget();
    let search = MapSearch { a, b, known, eigenfunctions, budget: &budget };
    let mut sketches = search.sketches()?;
    let mut maps = Vec::new();
    for sought in MapKind::ALL {
        if sought == MapKind::Unoriented && !maps.is_empty() {
            break;
        }
        let (of_kind, others) = sketches.into_iter().partition(|found| found.kind() == sought);
        sketches = others;
        maps.extend(search.best(of_kind)?);
    }
    Ok(known.finished(maps, b)?)
}

/// The images of the first samples of a surface under its best mirror, if it has one.
pub(super) fn mirrored_samples(
    shape: &MapShape,
    budget: &Budget,
) -> Result<Option<Vec<usize>>, DescriptorError> {
    let pair = first_samples([shape, shape], SKETCHED);
    Ok(mirrors(shape, budget)?.sides.as_ref().map(|mirror| mirror.sample_maps(&pair).forth))
}

/// The maps of a surface to itself that reverse its orientation and change distances little.
fn mirrors<'a>(shape: &'a MapShape, budget: &Budget) -> Result<&'a Mirrors, DescriptorError> {
    if let Some(known) = shape.mirrors.get() {
        return Ok(known);
    }
    let known = &KnownMap::default();
    let search = MapSearch { a: shape, b: shape, known, eigenfunctions: SKETCH_FUNCTIONS, budget };
    let mut starts = search.starts(&[-1.0])?;
    starts.retain(|start| start.kind() == MapKind::Mirrored);
    let mut found = search.sketched(starts.iter().map(|start| &start.functional))?;
    found.retain(|found| found.kind() == MapKind::Mirrored && found.distortion < SYMMETRIC);
    let least = least_agreement(&found);
    found.retain(|found| !found.is_mixture(least));
    let mut found = distinct(found);
    found.truncate(MIRRORS);
    // The mean distance of the landmarks from their images.
    let moved = |found: &Candidate| found.to_images.diagonal().mean();
    let sides = found.iter().position(|found| moved(found) > THICK).map(|i| found.remove(i).functional);
    let others = found.into_iter().map(|found| found.functional).collect();
    // If another thread was faster, it found the same.
    Ok(shape.mirrors.get_or_init(|| Mirrors { sides, others }))
}

/// A search with its options.
#[derive(Clone, Copy)]
struct MapSearch<'a> {
    a: &'a MapShape,
    b: &'a MapShape,
    known: &'a KnownMap,
    /// Most of each surface.
    eigenfunctions: usize,
    budget: &'a Budget,
}

impl MapSearch<'_> {
    /// Maps of few samples and eigenfunctions from all starts, and those that differ from them by a mirror.
    fn sketches(&self) -> Result<Vec<Candidate>, MapError> {
        let mut starts = self.starts(&[1.0, -1.0])?;
        self.check_orientation(&starts)?;
        starts.extend(self.refined_fits(self.known.fitted([self.a, self.b]).into_iter())?);
        let found = self.sketched(distinct(starts).iter().map(|start| &start.functional))?;
        let mut found = self.with_mirrored(distinct(found))?;
        let pair = first_samples([self.a, self.b], SKETCHED);
        if let Some((start, k)) = self.known.initial_start(&pair, [self.a, self.b], SKETCH_FUNCTIONS) {
            let initial = self.zoomed(&pair, vec![start], [k, SKETCH_FUNCTIONS])?.into_iter();
            found.extend(initial.map(|found| Candidate { score: found.score / CLEARLY_WORSE, ..found }));
        }
        Ok(self.respecting(found))
    }

    /// The maps of orientations that respect the landmarks: the best one is not clearly worse than that of the other.
    fn respecting(&self, mut found: Vec<Candidate>) -> Vec<Candidate> {
        if self.known.landmarks.is_empty() {
            return found;
        }
        let costs = MapKind::ALL.map(|kind| {
            let of_kind = found.iter().filter(|found| found.kind() == kind);
            of_kind.map(Candidate::cost).fold(f64::MAX, f64::min)
        });
        let least = costs.into_iter().fold(f64::MAX, f64::min);
        found.retain(|found| costs[found.kind() as usize] <= CLEARLY_WORSE * least);
        found
    }

    /// Refuses landmarks of both orientations: maps that were found without them show it, the direct and the mirrored one that fit
    /// most of them.
    fn check_orientation(&self, found: &[Candidate]) -> Result<(), MapError> {
        let best = |kind| {
            let of_kind = found.iter().rev().filter(|found| found.kind() == kind && !found.is_mixture(PURE));
            of_kind.max_by_key(|found| found.misses.iter().filter(|miss| **miss < RESPECTED).count())
        };
        let [Some(direct), Some(mirrored)] = [MapKind::Direct, MapKind::Mirrored].map(best) else {
            return Ok(());
        };
        let all: Vec<[f64; 2]> = direct.misses.iter().zip(&mirrored.misses).map(|(x, y)| [*x, *y]).collect();
        let fits = |miss: f64| miss < OUTLYING * RESPECTED;
        let only = |i: usize| all.iter().position(|both| fits(both[i]) && both[1 - i] > UNFIT * RESPECTED);
        match (only(0), only(1)) {
            // Maps that are both wrong leave others.
            (Some(i), Some(j)) if all.iter().all(|[x, y]| fits(x.min(*y))) => {
                let (landmarks, how) = ([i.min(j), i.max(j)], LandmarkConflict::Orientation);
                Err(MapError::Contradiction { landmarks, how })
            }
            _ => Ok(()),
        }
    }

    /// Different maps that are fitted with these signs, or follow from alignments of the forms.
    fn starts(&self, signs: &[f64]) -> Result<Vec<Candidate>, DescriptorError> {
        let (a, b) = (self.a, self.b);
        let pair = first_samples([a, b], ROUGH);
        let operators = || a.operators.iter().zip(&b.operators);
        let fits = signs.iter().flat_map(|sign| operators().flat_map(|(x, y)| fitted(x, y, *sign)));
        let mut found = self.refined_fits(fits)?;
        found.extend(self.zoomed(&pair, aligned(a, b, pair.a.nrows())?, [FIRST, ROUGH_FUNCTIONS])?);
        Ok(distinct(found))
    }

    /// Maps of few samples from maps of functions that were fitted in closed form.
    fn refined_fits(&self, fits: impl Iterator<Item = Matrix>) -> Result<Vec<Candidate>, DescriptorError> {
        let pair = first_samples([self.a, self.b], ROUGH);
        let fits = fits.map(|forth| FunctionalMaps::of_one(&forth).sample_maps(&pair)).collect();
        self.zoomed(&pair, fits, [FITTED, ROUGH_FUNCTIONS])
    }

    /// The sketches that follow from maps of functions.
    fn sketched<'m>(
        &self,
        starts: impl Iterator<Item = &'m FunctionalMaps>,
    ) -> Result<Vec<Candidate>, DescriptorError> {
        let pair = first_samples([self.a, self.b], SKETCHED);
        let starts = starts.map(|start| start.sample_maps(&pair)).collect();
        self.zoomed(&pair, starts, [FITTED, SKETCH_FUNCTIONS])
    }

    /// These maps and those that differ from them by a mirror of a surface, if there is one. A map and the one that differs by
    /// left and right stand and fall together: each has the score of both. Other mirrors only lead to more maps, since a right
    /// map and a wrong one may differ by front and back.
    fn with_mirrored(&self, mut found: Vec<Candidate>) -> Result<Vec<Candidate>, DescriptorError> {
        let mirrors = [mirrors(self.a, self.budget)?, mirrors(self.b, self.budget)?];
        let others = mirrors.map(|of| &of.others[..]);
        let turned: Vec<_> = found.iter().flat_map(|one| mirrored(one, others)).collect();
        found.extend(self.sketched(turned.iter())?);
        let sides = mirrors.map(|of| of.sides.as_slice());
        let mut all = Vec::new();
        for one in distinct(found) {
            let others: Vec<_> = mirrored(&one, sides).collect();
            let mut others = self.sketched(others.iter())?;
            others.retain(|other| other.kind() != one.kind());
            others.iter_mut().for_each(|other| other.score = (one.score * other.score).sqrt());
            let least = others.iter().map(|other| other.score).reduce(f64::min);
            all.push(Candidate { score: least.unwrap_or(one.score), ..one });
            all.extend(others);
        }
        Ok(all)
    }

    /// The best map of candidates of one kind, refined on all samples and eigenfunctions.
    fn best(&self, mut found: Vec<Candidate>) -> Result<Option<SurfaceMap>, DescriptorError> {
        let least = least_agreement(&found);
        let is_mixture = |found: &Candidate| found.is_mixture(least);
        found.sort_by(|x, y| is_mixture(x).cmp(&is_mixture(y)).then(x.cost().total_cmp(&y.cost())));
        let Some(best) = found.first() else { return Ok(None) };
        let mut rivals = found.iter().filter(|other| is_mixture(best) || !is_mixture(other));
        let rival = rivals.find(|other| !best.is_same(other));
        let confidence = odds(best.cost(), rival.map(Candidate::cost), STEEPNESS);
        let limit = if is_mixture(best) { DOUBTED } else { 1.0 };
        let mut first = self.refined(best)?;
        let mut confidence = KnownMap::doubted(confidence.min(limit), &first.misses);
        let rival = rival.filter(|_| confidence < SurfaceMap::CERTAIN);
        let mut rival = rival.map(|rival| self.refined(rival)).transpose()?;
        // An initial map stands unless another one is clearly better, which the sketches tell.
        let is_better =
            |second: &&mut Candidate| self.known.initial.is_empty() && second.cost() < first.cost();
        if let Some(second) = rival.as_mut().filter(is_better) {
            std::mem::swap(&mut first, second);
            confidence = confidence.min(DOUBTED);
        }
        let mut map = self.on_all_vertices(&first, confidence)?;
        if let Some(second) = rival {
            map.alternative = Some(Box::new(self.on_all_vertices(&second, 1.0 - confidence)?));
        }
        Ok(Some(map))
    }

    /// A map on all samples and eigenfunctions.
    fn refined(&self, sketch: &Candidate) -> Result<Candidate, DescriptorError> {
        let shapes = [self.a, self.b];
        let all = self.known.and_landmarks(first_samples(shapes, usize::MAX), shapes);
        let start = sketch.functional.sample_maps(&all);
        let refined = self.zoomed(&all, vec![start], [SKETCH_FUNCTIONS, self.eigenfunctions])?;
        // Refinement may mix two maps, where the sketch is right.
        let agrees = |found: &Candidate| match (sketch.agreement, found.agreement) {
            (Some(before), Some(after)) => after * before.signum() > before.abs() - LOST,
            _ => true,
        };
        Ok(refined.into_iter().find(agrees).unwrap_or_else(|| sketch.clone()))
    }

    /// A map on all vertices.
    fn on_all_vertices(&self, found: &Candidate, confidence: f64) -> Result<SurfaceMap, DescriptorError> {
        let (a, b) = (self.a, self.b);
        let Placed { on_a, on_b, coarse } =
            found.functional.placed([&a.spectrum.vectors, &b.spectrum.vectors]);
        let forth = b.nearest_vertices(&on_b, &coarse, &on_a);
        let back = a.nearest_vertices(&on_a, &coarse, &on_b.select_rows(b.landmarks()));
        Ok(SurfaceMap {
            kind: found.kind(),
            agreement: found.agreement,
            functional: found.functional.forth.clone(),
            confidence,
            ..SurfaceMap::of_vertices([a, b], &forth, &back)?
        })
    }

    /// Refines maps of samples, from some eigenfunctions to more.
    fn zoomed(
        &self,
        pair: &SampledPair,
        starts: Vec<TwoWayMap>,
        ends: [usize; 2],
    ) -> Result<Vec<Candidate>, DescriptorError> {
        let n = pair.a.nrows().min(pair.b.nrows());
        let known = pair.a.ncols().min(pair.b.ncols()).min((n / 4).max(1));
        let [first, last] = ends.map(|k| k.min(known).min(self.eigenfunctions.max(1)));
        let counts = schedule(first, last);
        let one = |start: TwoWayMap| {
            self.budget.check().map_err(LinalgError::from)?;
            let (maps, functional) = zoom_out(pair, start, &counts);
            Candidate::new([self.a, self.b], self.known, &maps, functional)
        };
        starts.into_par_iter().map(one).collect()
    }
}

/// How likely a map is the right one, and not its rival: the odds are the ratio of their scores to a power.
pub(super) fn odds(score: f64, rival: Option<f64>, steepness: f64) -> f64 {
    rival.map_or(1.0, |rival| Boundary::new(rival.max(f64::MIN_POSITIVE), steepness).probability(score))
}

/// The best maps of each orientation that are not the same; those of none only if there are no others.
fn distinct(mut found: Vec<Candidate>) -> Vec<Candidate> {
    if found.iter().any(|found| found.kind() != MapKind::Unoriented) {
        found.retain(|found| found.kind() != MapKind::Unoriented);
    }
    found.sort_by(|x, y| x.cost().total_cmp(&y.cost()));
    let mut kept: Vec<Candidate> = Vec::new();
    for next in found {
        let of_kind = || kept.iter().filter(|other| other.kind() == next.kind());
        if of_kind().count() < SKETCHES && !of_kind().any(|other| next.is_same(other)) {
            kept.push(next);
        }
    }
    kept
}

/// Eigenfunctions at the first samples of both surfaces.
fn first_samples(shapes: [&MapShape; 2], n: usize) -> SampledPair {
    let n = shapes.iter().fold(n, |n, shape| n.min(shape.samples.len()));
    let [a, b] = shapes.map(|shape| shape.at_samples.rows(0, n).into_owned());
    SampledPair::new(a, b)
}

/// A map, before or after mirrors of the surfaces.
fn mirrored<'m>(
    one: &'m Candidate,
    [of_a, of_b]: [&'m [FunctionalMaps]; 2],
) -> impl Iterator<Item = FunctionalMaps> + 'm {
    let before = of_a.iter().map(|mirror| mirror.then(&one.functional));
    before.chain(of_b.iter().map(|mirror| one.functional.then(mirror)))
}

/// Different maps of the first samples to the nearest ones in aligned forms.
fn aligned(a: &MapShape, b: &MapShape, n: usize) -> Result<Vec<TwoWayMap>, DescriptorError> {
    // The first samples are evenly spread, too; a partner further down the list stands for one that is not far away.
    let places = |shape: &MapShape| {
        NearestPoints::new(shape.samples[..n].iter().map(|&v| shape.form.points()[v]).collect())
    };
    let (on_a, on_b) = (places(a)?, places(b)?);
    let near = |from: &NearestPoints, to: &NearestPoints, motion: &Alignment| {
        from.points().iter().map(|p| to.nearest(&motion.apply(p)).0).collect()
    };
    let mut found: Vec<TwoWayMap> = alignments(&a.form, &b.form)
        .iter()
        .map(|motion| TwoWayMap {
            forth: near(&on_a, &on_b, motion),
            back: near(&on_b, &on_a, &motion.inverse()),
        })
        .collect();
    found.dedup();
    Ok(found)
}

impl Candidate {
    fn new(
        [a, b]: [&MapShape; 2],
        known: &KnownMap,
        maps: &TwoWayMap,
        functional: FunctionalMaps,
    ) -> Result<Self, DescriptorError> {
        let images = |from: &MapShape, map: &[usize], to: &MapShape| -> Vec<usize> {
            map.iter().take(from.landmarks().len()).map(|&i| to.samples[i]).collect()
        };
        let to_images = b.distances_to(&images(a, &maps.forth, b))?;
        let distortion = codistortion(&a.distances_to(&images(b, &maps.back, a))?, &to_images);
        let agreement = orientation(a, b, &functional, &maps.forth);
        let missing = agreement.map_or(1.0, |agreement| (1.0 - agreement.abs()).max(FULL));
        let mismatch = match (&a.curvature, &b.curvature) {
            // Rounding may take the mismatch of equal curvatures below zero.
            (Some(x), Some(y)) => (0.5 * (mismatch(x, y, &maps.forth) + mismatch(y, x, &maps.back))).max(0.0),
            _ => 1.0,
        };
        let score = distortion * functional.defect() * missing * mismatch;
        let misses = known.misses(&functional, [a, b])?;
        let penalty = KnownMap::penalty(&misses, STEEPNESS);
        Ok(Self { functional, to_images, distortion, agreement, score, misses, penalty })
    }
}

/// How far a map of samples preserves orientation.
fn orientation(a: &MapShape, b: &MapShape, functional: &FunctionalMaps, partners: &[usize]) -> Option<f64> {
    let (oriented, forms) = (a.oriented.as_ref()?, b.area_forms.as_ref()?);
    let k = functional.k();
    let pulled: Matrix = a.spectrum.vectors.columns(0, k) * functional.forth.columns(0, k.min(FORMS + 1));
    Some(agreement(&oriented.area_forms(&pulled, &a.samples[..partners.len()]), forms, partners))
}
