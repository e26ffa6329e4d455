//! The search for the best maps.

use base::{Budget, Observer};
use linalg::{LinalgError, Matrix};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use surface::VertexId;

use super::functional_map::{FunctionalMaps, SampleMaps, SampledPair, schedule, zoom_out};
use super::nearest_rows::Cells;
use super::operators::{FITTED, fitted};
use super::orientation::agreement;
use super::part_of_whole::PartOfWhole;
use super::shape::MapShape;
use descriptors::Alignment;
use descriptors::Boundary;
use descriptors::DescriptorError;
use descriptors::alignments;

/// How surfaces are mapped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct MapOptions {
    /// Most eigenfunctions of each surface. Default: 150.
    pub eigenfunctions: usize,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self { eigenfunctions: 150 }
    }
}

/// How a map treats the orientation of the surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapKind {
    /// It keeps the orientation: left goes to left.
    Direct,
    /// It reverses the orientation, as a mirror does: left goes to right.
    Mirrored,
    /// A surface cannot be oriented, or the map is too irregular to tell.
    Unoriented,
}

impl MapKind {
    /// The name on the command line and in records.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Mirrored => "mirrored",
            Self::Unoriented => "unoriented",
        }
    }
}

/// A map from the vertices of one surface to those of another.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceMap {
    /// Whether it keeps the orientation.
    pub kind: MapKind,
    /// The mean change of distances, as a share of the square root of the area: `|d(x, g y) - d(f x, y)|` over landmarks `x` of
    /// the first and `y` of the second surface, both at unit area, with the map `f` and its inverse `g` (the codistortion of
    /// `memoli2005`, as a mean).
    pub distortion: f64,
    /// How far the map preserves orientation, from -1 to 1; `None` if a surface cannot be oriented.
    pub agreement: Option<f64>,
    /// How likely this map is the right one of its kind, and not the next best: a guide, which is not calibrated (decision
    /// 19).
    pub confidence: f64,
    /// The partner of each vertex of the first surface.
    pub vertices: Vec<VertexId>,
    /// The map of functions of the second surface to functions of the first, in their eigenfunctions: `C`, as in
    /// [`LaplaceSpectrum`](descriptors::LaplaceSpectrum).
    pub functional: Matrix,
    /// The next best map of this kind, unless this one is [certain](Self::CERTAIN).
    pub alternative: Option<Box<SurfaceMap>>,
    /// Which surface is a part of the other; `None` if both are mapped as wholes.
    pub part: Option<PartOfWhole>,
}

impl SurfaceMap {
    /// Maps of at least this confidence are certain: the next best one is so much worse that it is not refined. A convention.
    pub const CERTAIN: f64 = 0.7;
}

// `experiments run matching` measures the maps that follow from these limits.

/// Maps agree with an orientation beyond this. A safety limit: it is near 1 or -1 for smooth maps, and 0 for random ones.
const AGREEMENT: f64 = 0.1;

/// A map agrees with an orientation everywhere beyond this; below, it may be a mixture of two maps. A safety limit: without
/// such maps, all beyond [`AGREEMENT`] are taken.
const SURE: f64 = 0.5;

/// Samples by which the maps of all starts are compared, and eigenfunctions of their last step.
const SKETCHED: usize = 400;
const SKETCH_FUNCTIONS: usize = 60;

/// Eigenfunctions of the first step of a map from an alignment.
const FIRST: usize = 6;

/// A map from an alignment, or from another map and a mirror, is taken if its [score](Candidate::score) is below this share
/// of that of all fitted maps, which know inside from outside. Chosen on built-in people of 1,000 vertices: with 0.8 and
/// more, one more of 15 mirrored maps is wrong.
const CLEARLY_BETTER: f64 = 0.7;

/// Maps whose images are less than this apart on average, as a share of the square root of the area, are one. A safety limit.
const SAME: f64 = 0.06;

/// The odds that a map is right, and not the next best, are the ratio of their scores to this power. A convention, which is
/// not calibrated: maps that are divided by [`CLEARLY_BETTER`] count as so much worse.
const STEEPNESS: f64 = 8.0;

/// The direct map comes second if its distortion is more than this multiple of the mirrored one's. A convention.
const CLEARLY_WORSE: f64 = 1.5;

/// A map of samples and of functions, with what ranks it among others.
struct Candidate {
    maps: SampleMaps,
    functional: FunctionalMaps,
    /// Vertices of the second surface: the images of the landmarks of the first.
    images: Vec<usize>,
    agreement: Option<f64>,
    /// Lower is better: the distortion of distances times the distance of the maps of functions from orthogonal ones,
    /// `(|C'C - I|² + |D'D - I|²) / k`. A man turned back to front keeps distances nearly as well as another pose does, but
    /// his map is no isometry in detail.
    score: f64,
}

impl Candidate {
    fn kind(&self) -> MapKind {
        kind_of(self.agreement)
    }

    fn is_sure(&self) -> bool {
        self.kind() == kind(self.agreement, SURE)
    }
}

/// The kind of a map of some agreement.
pub(super) fn kind_of(agreement: Option<f64>) -> MapKind {
    kind(agreement, AGREEMENT)
}

fn kind(agreement: Option<f64>, least: f64) -> MapKind {
    match agreement {
        Some(value) if value > least => MapKind::Direct,
        Some(value) if value < -least => MapKind::Mirrored,
        _ => MapKind::Unoriented,
    }
}

/// The best maps of the first surface to the second, one for each orientation: the direct one first, unless it distorts
/// distances clearly more.
///
/// 1. Maps of functions are fitted in closed form to the curvature and the wave kernels of both surfaces, once for each
///    orientation (`ren2018` in `REFERENCES.bib`). Each alignment of the forms maps samples to the nearest ones, too.
/// 2. All these maps are refined with few samples, by taking in eigenfunctions of higher frequency, there and back (ZoomOut,
///    `melzi2019`).
/// 3. Of each orientation, the one that keeps distances and the products of functions best is refined on all samples and
///    eigenfunctions, and all vertices follow. How much worse the next best is says how certain it is.
///
/// Shapes that are alike under a mirror have two maps of small distortion; for others, one of the two has a large
/// distortion. If a surface cannot be oriented, there is one map.
pub(super) fn map_wholes(
    a: &MapShape,
    b: &MapShape,
    options: &MapOptions,
    observer: &dyn Observer,
) -> Result<Vec<SurfaceMap>, DescriptorError> {
    let budget = observer.budget();
    let search = MapSearch { a, b, options, budget: &budget };
    let mut sketches = search.sketches()?;
    let mut maps = Vec::new();
    for sought in [MapKind::Direct, MapKind::Mirrored, MapKind::Unoriented] {
        if sought == MapKind::Unoriented && !maps.is_empty() {
            break;
        }
        let (of_kind, others) = sketches.into_iter().partition(|found| found.kind() == sought);
        sketches = others;
        maps.extend(search.best(of_kind)?);
    }
    Ok(in_order(maps))
}

/// The direct map first, unless it distorts distances clearly more.
pub(super) fn in_order(mut maps: Vec<SurfaceMap>) -> Vec<SurfaceMap> {
    if let [direct, mirrored] = &maps[..]
        && mirrored.distortion * CLEARLY_WORSE < direct.distortion
    {
        maps.reverse();
    }
    maps
}

/// The images of the first samples of a surface under its best mirror, if it has one.
pub(super) fn mirrored_samples(
    shape: &MapShape,
    options: &MapOptions,
    budget: &Budget,
) -> Result<Option<Vec<u32>>, DescriptorError> {
    let search = MapSearch { a: shape, b: shape, options, budget };
    let rows = shape.at_samples.rows(0, SKETCHED.min(shape.samples.len())).into_owned();
    Ok(search.mirror(shape, &rows)?.map(|maps| maps.forth))
}

/// A search with its options.
#[derive(Clone, Copy)]
struct MapSearch<'a> {
    a: &'a MapShape,
    b: &'a MapShape,
    options: &'a MapOptions,
    budget: &'a Budget,
}

impl MapSearch<'_> {
    /// Maps of few samples and eigenfunctions from all starts.
    fn sketches(&self) -> Result<Vec<Candidate>, DescriptorError> {
        let (a, b) = (self.a, self.b);
        let n = SKETCHED.min(a.samples.len()).min(b.samples.len());
        let [rows_a, rows_b] = [a, b].map(|shape| shape.at_samples.rows(0, n).into_owned());
        let pair = SampledPair { a: &rows_a, b: &rows_b };
        let starts = [1.0, -1.0].into_iter().flat_map(|sign| fitted_starts(pair, [a, b], sign)).collect();
        let mut found = self.zoomed(starts, [FITTED, SKETCH_FUNCTIONS])?;
        let best = [MapKind::Direct, MapKind::Mirrored].map(|kind| best_of(&found, kind));
        let [of_a, of_b] = [self.mirror(a, &rows_a)?, self.mirror(b, &rows_b)?];
        let composed = best.into_iter().flatten().flat_map(|maps| {
            let before = of_a.iter().map(|mirror| mirror.then(maps));
            before.chain(of_b.iter().map(|mirror| maps.then(mirror)))
        });
        let composed = composed.collect();
        let aligned = alignments(&a.form, &b.form);
        let aligned = aligned.iter().map(|motion| nearest_samples(a, b, motion, n)).collect();
        let others = self.zoomed(composed, [FITTED, SKETCH_FUNCTIONS])?.into_iter();
        let others = others.chain(self.zoomed(aligned, [FIRST, SKETCH_FUNCTIONS])?);
        found.extend(others.map(|found| Candidate { score: found.score / CLEARLY_BETTER, ..found }));
        Ok(found)
    }

    /// The map of the samples of a surface to themselves that reverses its orientation and scores best.
    fn mirror(&self, shape: &MapShape, rows: &Matrix) -> Result<Option<SampleMaps>, DescriptorError> {
        let pair = SampledPair { a: rows, b: rows };
        let starts = fitted_starts(pair, [shape; 2], -1.0);
        let search = MapSearch { a: shape, b: shape, ..*self };
        let found = search.zoomed(starts, [FITTED, SKETCH_FUNCTIONS])?;
        Ok(best_of(&found, MapKind::Mirrored).cloned())
    }

    /// The best map of candidates of one kind, refined on all samples and eigenfunctions.
    fn best(&self, mut found: Vec<Candidate>) -> Result<Option<SurfaceMap>, DescriptorError> {
        if found.iter().any(Candidate::is_sure) {
            found.retain(Candidate::is_sure);
        }
        found.sort_by(|x, y| x.score.total_cmp(&y.score));
        let Some(best) = found.first() else { return Ok(None) };
        let rival = found.iter().find_map(|other| match self.is_same(best, other) {
            Ok(true) => None,
            Ok(false) => Some(Ok(other)),
            Err(error) => Some(Err(error)),
        });
        let rival = rival.transpose()?;
        let confidence = rival.map_or(1.0, |rival| {
            let boundary = Boundary { at: rival.score.max(f64::MIN_POSITIVE), steepness: STEEPNESS };
            boundary.probability(best.score)
        });
        let mut map = self.refined(best, confidence)?;
        if let Some(rival) = rival.filter(|_| confidence < SurfaceMap::CERTAIN) {
            map.alternative = Some(Box::new(self.refined(rival, 1.0 - confidence)?));
        }
        Ok(Some(map))
    }

    /// Whether two maps are nearly the same: the distance of two points is at least the difference of their distances from
    /// any landmark.
    fn is_same(&self, x: &Candidate, y: &Candidate) -> Result<bool, DescriptorError> {
        let [x, y] = [self.b.distances_to(&x.images)?, self.b.distances_to(&y.images)?];
        let gaps = x.column_iter().zip(y.column_iter()).map(|(x, y)| (x - y).amax());
        Ok(gaps.sum::<f64>() < SAME * x.ncols() as f64)
    }

    /// A map on all samples and eigenfunctions, and then on all vertices.
    fn refined(&self, sketch: &Candidate, confidence: f64) -> Result<SurfaceMap, DescriptorError> {
        let all = SampledPair { a: &self.a.at_samples, b: &self.b.at_samples };
        let start = sketch.functional.sample_maps(all);
        let refined = self.zoomed(vec![start], [SKETCH_FUNCTIONS, self.options.eigenfunctions])?;
        // Refinement may mix two maps; the sketch is not a mixture.
        match refined.iter().find(|found| found.kind() == sketch.kind()) {
            Some(found) => found.on_all_vertices(self.a, self.b, confidence),
            None => sketch.on_all_vertices(self.a, self.b, confidence),
        }
    }

    /// Refines maps of the first samples, from some eigenfunctions to more.
    fn zoomed(&self, starts: Vec<SampleMaps>, ends: [usize; 2]) -> Result<Vec<Candidate>, DescriptorError> {
        let (a, b) = (self.a, self.b);
        // A map of all samples is one of all on both sides, which may differ in number.
        let lengths = starts.first().map_or([0; 2], |start| [start.forth.len(), start.back.len()]);
        let n = lengths[0].min(lengths[1]);
        let known = a.vectors.ncols().min(b.vectors.ncols()).min((n / 4).max(1));
        let [first, last] = ends.map(|k| k.min(known).min(self.options.eigenfunctions.max(1)));
        let counts = schedule(first, last);
        let rows = |shape: &MapShape, n: usize| shape.at_samples.rows(0, n).into_owned();
        let (rows_a, rows_b) = (rows(a, lengths[0]), rows(b, lengths[1]));
        let pair = SampledPair { a: &rows_a, b: &rows_b };
        let one = |start: SampleMaps| {
            self.budget.check().map_err(LinalgError::from)?;
            let (maps, functional) = zoom_out(pair, start, &counts);
            Candidate::new(a, b, maps, functional)
        };
        starts.into_par_iter().map(one).collect()
    }
}

/// The maps of samples of one kind that score best.
fn best_of(found: &[Candidate], kind: MapKind) -> Option<&SampleMaps> {
    let of_kind = found.iter().filter(|found| found.kind() == kind);
    of_kind.min_by(|x, y| x.score.total_cmp(&y.score)).map(|found| &found.maps)
}

/// Maps of the first samples that follow from fitted maps of functions.
fn fitted_starts(pair: SampledPair<'_>, [a, b]: [&MapShape; 2], sign: f64) -> Vec<SampleMaps> {
    let fitted = a.operators.iter().zip(&b.operators).flat_map(|(x, y)| fitted(x, y, sign));
    fitted.map(|forth| FunctionalMaps { back: forth.transpose(), forth }.sample_maps(pair)).collect()
}

/// Maps each of the first samples to the nearest one in the aligned forms.
fn nearest_samples(a: &MapShape, b: &MapShape, motion: &Alignment, n: usize) -> SampleMaps {
    let back = motion.inverse();
    // The first samples are evenly spread, too; a partner further down the list stands for one that is not far away.
    let near = |from: &MapShape, to: &MapShape, motion: &Alignment| -> Vec<u32> {
        let of = |p: &nalgebra::Point3<f64>| {
            let q = motion.apply(p);
            let gaps = to.points[..n].iter().map(|r| (r - q).norm_squared());
            (0..).zip(gaps).min_by(|x, y| x.1.total_cmp(&y.1)).map_or(0, |(i, _)| i)
        };
        from.points[..n].iter().map(of).collect()
    };
    SampleMaps { forth: near(a, b, motion), back: near(b, a, &back) }
}

impl Candidate {
    fn new(
        a: &MapShape,
        b: &MapShape,
        maps: SampleMaps,
        functional: FunctionalMaps,
    ) -> Result<Self, DescriptorError> {
        let [n_a, n_b] = [a, b].map(|shape| shape.landmarks().len());
        let image = |map: &[u32], shape: &MapShape, n: usize| -> Vec<usize> {
            map.iter().take(n).map(|&i| shape.samples[i as usize]).collect()
        };
        let (forth, back) = (image(&maps.forth, b, n_a), image(&maps.back, a, n_b));
        let distortion = codistortion(a, b, &forth, &back)?;
        let pairs: Vec<(usize, usize)> =
            a.samples.iter().zip(&maps.forth).map(|(&x, &y)| (x, b.samples[y as usize])).collect();
        let agreement = orientation(a, b, &functional, &pairs);
        let score = distortion * functional.defect();
        Ok(Self { maps, functional, images: forth, agreement, score })
    }

    fn on_all_vertices(
        &self,
        a: &MapShape,
        b: &MapShape,
        confidence: f64,
    ) -> Result<SurfaceMap, DescriptorError> {
        let (on_a, on_b) = (self.functional.partners_b(&b.vectors), self.functional.partners_a(&a.vectors));
        let near_b = Cells { rows: &on_a, centres: &b.samples, members: &b.cells };
        let near_a = Cells { rows: &on_b, centres: &a.samples, members: &a.cells };
        let forth = near_b.nearest(&self.functional.points_a(&a.vectors));
        let back = near_a.nearest(&self.functional.points_b(&b.vectors.select_rows(b.landmarks())));
        let images: Vec<usize> = a.landmarks().iter().map(|&x| forth[x] as usize).collect();
        let back: Vec<usize> = back.into_iter().map(|x| x as usize).collect();
        let distortion = codistortion(a, b, &images, &back)?;
        let vertices = forth.into_iter().map(VertexId).collect();
        Ok(SurfaceMap {
            kind: self.kind(),
            distortion,
            agreement: self.agreement,
            confidence,
            vertices,
            functional: self.functional.forth.clone(),
            alternative: None,
            part: None,
        })
    }
}

/// The mean of `|d(x_i, g y_j) - d(f x_i, y_j)|` over landmarks; `forth` and `back` are the images of the landmarks.
fn codistortion(a: &MapShape, b: &MapShape, forth: &[usize], back: &[usize]) -> Result<f64, DescriptorError> {
    let on_a = a.distances_to(back)?;
    let on_b = b.distances_to(forth)?;
    let gaps = (0..on_a.nrows()).flat_map(|i| (0..on_a.ncols()).map(move |j| (i, j)));
    let sum: f64 = gaps.map(|(i, j)| (on_a[(i, j)] - on_b[(j, i)]).abs()).sum();
    Ok(sum / on_a.len().max(1) as f64)
}

/// How far a map of vertices preserves orientation.
fn orientation(
    a: &MapShape,
    b: &MapShape,
    functional: &FunctionalMaps,
    pairs: &[(usize, usize)],
) -> Option<f64> {
    let oriented = [a.oriented.as_ref()?, b.oriented.as_ref()?];
    let k = functional.k();
    let pulled: Matrix = a.vectors.columns(0, k) * &functional.forth;
    Some(agreement(oriented, &pulled, &b.vectors, pairs))
}
