//! The search for the best maps.

use base::{Budget, Observer};
use linalg::{LinalgError, Matrix};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use surface::VertexId;

use super::functional_map::{FunctionalMaps, SampleMaps, SampledPair, schedule, zoom_out};
use super::nearest_rows::Cells;
use super::orientation::agreement;
use super::shape::MapShape;
use descriptors::Alignment;
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
    /// The partner of each vertex of the first surface.
    pub vertices: Vec<VertexId>,
}

// `experiments run matching` measures the maps that follow from these limits.

/// Maps agree with an orientation beyond this. A safety limit: it is near 1 or -1 for smooth maps, and 0 for random ones.
const AGREEMENT: f64 = 0.1;

/// A sketched map agrees with an orientation everywhere beyond this; below, it may be a mixture of two maps. A safety limit:
/// without such maps, all beyond [`AGREEMENT`] are taken.
const SURE: f64 = 0.5;

/// Samples by which the maps of all alignments are compared.
const SKETCHED: usize = 400;

/// Eigenfunctions of the first step of a map from an alignment, and from the composition of two maps.
const FIRST: usize = 6;
const COMPOSED_FIRST: usize = 14;

/// Eigenfunctions of the last step of a sketch.
const SKETCH_FUNCTIONS: usize = 24;

/// Distinct sketches of each orientation that are refined.
const REFINED: usize = 3;

/// Sketches that are composed with the symmetries of both surfaces.
const COMPOSED: usize = 3;

/// A map of a surface to itself of at most this distortion is a symmetry. A safety limit: more symmetries cost time only.
const SYMMETRY: f64 = 0.08;

/// Maps whose images are less than this apart on average, as a share of the square root of the area, are one. A safety limit:
/// fewer maps are refined.
const SAME: f64 = 0.06;

/// Of maps whose distortions are within this factor, the one that keeps the wave kernels better is chosen: measured by
/// `experiments run matching`.
const NEAR_BEST: f64 = 1.25;

/// The direct map comes second if its distortion is more than this multiple of the mirrored one's. A convention.
const CLEARLY_WORSE: f64 = 1.5;

/// A map of samples and of functions, with what ranks it among others.
struct Candidate {
    maps: SampleMaps,
    functional: FunctionalMaps,
    /// Vertices of the second surface: the images of the landmarks of the first.
    images: Vec<usize>,
    distortion: f64,
    agreement: Option<f64>,
    /// How far the wave kernels of corresponding samples differ, from 0 to 1.
    waves: f64,
}

impl Candidate {
    fn kind(&self) -> MapKind {
        kind(self.agreement, AGREEMENT)
    }
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
/// 1. Every alignment of the forms maps samples to the nearest ones. These maps are refined on few eigenfunctions of the
///    Laplacian, there and back (ZoomOut, `melzi2019` in `REFERENCES.bib`).
/// 2. The best of them are composed with the symmetries of both surfaces, their maps to themselves, which are found in the
///    same way. So no map is missed because the alignment that leads to it fits badly.
/// 3. The best maps of each orientation that differ from each other are refined on all samples and eigenfunctions.
/// 4. Of those of nearly the least distortion, one is chosen by the wave kernels of corresponding points. A man turned back
///    to front keeps distances nearly as well as another pose does, but not the wave kernels of face, chest and feet.
/// 5. All vertices follow.
///
/// Shapes that are alike under a mirror have two maps of small distortion; for others, one of the two has a large
/// distortion. If a surface cannot be oriented, there is one map.
///
/// # Errors
/// [`DescriptorError::Linalg`], also if the budget of the observer is exceeded.
pub fn map_surfaces(
    a: &MapShape,
    b: &MapShape,
    options: &MapOptions,
    observer: &dyn Observer,
) -> Result<Vec<SurfaceMap>, DescriptorError> {
    let search = MapSearch { options, budget: observer.budget() };
    let n_sketched = SKETCHED.min(a.samples.len()).min(b.samples.len());
    let found = search.sketches(a, b, n_sketched)?;
    let [of_a, of_b] = [search.symmetries(a, n_sketched)?, search.symmetries(b, n_sketched)?];
    let composed = found.iter().take(COMPOSED).flat_map(|map| {
        let before = of_a.iter().map(|symmetry| symmetry.maps.then(&map.maps));
        before.chain(of_b.iter().map(|symmetry| map.maps.then(&symmetry.maps)))
    });
    let composed: Vec<SampleMaps> = composed.collect();
    let composed = search.zoomed(a, b, composed, n_sketched, [COMPOSED_FIRST, SKETCH_FUNCTIONS])?;
    let sketched = distinct(b, found.into_iter().chain(composed).collect())?;
    let mut maps = Vec::new();
    for sought in [MapKind::Direct, MapKind::Mirrored, MapKind::Unoriented] {
        if sought == MapKind::Unoriented && !maps.is_empty() {
            break;
        }
        if let Some(best) = search.refined(a, b, &sketched, sought)? {
            maps.push(best.on_all_vertices(a, b)?);
        }
    }
    if let [direct, mirrored] = &maps[..]
        && mirrored.distortion * CLEARLY_WORSE < direct.distortion
    {
        maps.reverse();
    }
    Ok(maps)
}

/// A search with its options.
struct MapSearch<'a> {
    options: &'a MapOptions,
    budget: Budget,
}

impl MapSearch<'_> {
    /// The maps of all alignments of the forms that differ from each other, refined on few samples and eigenfunctions;
    /// that of least distortion first.
    fn sketches(&self, a: &MapShape, b: &MapShape, n: usize) -> Result<Vec<Candidate>, DescriptorError> {
        let starts =
            alignments(&a.form, &b.form).iter().map(|motion| nearest_samples(a, b, motion, n)).collect();
        distinct(b, self.zoomed(a, b, starts, n, [FIRST, SKETCH_FUNCTIONS])?)
    }

    /// Maps of a surface to itself that distort distances little, except the identity.
    fn symmetries(&self, shape: &MapShape, n: usize) -> Result<Vec<Candidate>, DescriptorError> {
        let mut found = self.sketches(shape, shape, n.min(shape.samples.len()))?;
        let moves = |map: &Candidate| map.images.iter().zip(shape.landmarks()).any(|(y, x)| y != x);
        found.retain(|map| map.distortion < SYMMETRY && moves(map));
        Ok(found)
    }

    /// The best map of one orientation, refined on all samples and eigenfunctions.
    fn refined(
        &self,
        a: &MapShape,
        b: &MapShape,
        sketched: &[Candidate],
        sought: MapKind,
    ) -> Result<Option<Candidate>, DescriptorError> {
        let all = SampledPair { a: &a.at_samples, b: &b.at_samples };
        let starts = |least: f64| -> Vec<SampleMaps> {
            let of_kind = sketched.iter().filter(|found| kind(found.agreement, least) == sought);
            of_kind.take(REFINED).map(|found| found.functional.sample_maps(all)).collect()
        };
        let mut chosen = starts(if sought == MapKind::Unoriented { AGREEMENT } else { SURE });
        if chosen.is_empty() {
            chosen = starts(AGREEMENT);
        }
        let n_samples = a.samples.len().min(b.samples.len());
        let mut refined =
            self.zoomed(a, b, chosen, n_samples, [SKETCH_FUNCTIONS, self.options.eigenfunctions])?;
        // A map that keeps the orientation in one place and reverses it in another is a mixture of two.
        refined.retain(|found| found.kind() == sought);
        if refined.iter().any(|found| kind(found.agreement, SURE) == sought) {
            refined.retain(|found| kind(found.agreement, SURE) == sought);
        }
        by_distortion(&mut refined);
        let limit = refined.first().map_or(0.0, |best| best.distortion * NEAR_BEST);
        let near = refined.into_iter().filter(|found| found.distortion <= limit);
        Ok(near.min_by(|x, y| x.waves.total_cmp(&y.waves)))
    }

    /// Refines maps of the first `n` samples, from some eigenfunctions to more.
    fn zoomed(
        &self,
        a: &MapShape,
        b: &MapShape,
        starts: Vec<SampleMaps>,
        n: usize,
        ends: [usize; 2],
    ) -> Result<Vec<Candidate>, DescriptorError> {
        let known = a.vectors.ncols().min(b.vectors.ncols()).min((n / 4).max(1));
        let [first, last] = ends.map(|k| k.min(known).min(self.options.eigenfunctions.max(1)));
        let counts = schedule(first, last);
        // A map of all samples is one of all on both sides, which may differ in number.
        let rows = |shape: &MapShape, starts: usize| shape.at_samples.rows(0, starts).into_owned();
        let lengths = starts.first().map_or([0; 2], |start| [start.forth.len(), start.back.len()]);
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

fn by_distortion(found: &mut [Candidate]) {
    found.sort_by(|x, y| x.distortion.total_cmp(&y.distortion));
}

/// The maps by ascending distortion, without those that are nearly the same as one before. Maps of two orientations are never
/// the same, however thin the body is.
fn distinct(b: &MapShape, mut found: Vec<Candidate>) -> Result<Vec<Candidate>, DescriptorError> {
    by_distortion(&mut found);
    let mut kept: Vec<(Candidate, Matrix)> = Vec::new();
    for candidate in found {
        let places = b.distances_to(&candidate.images)?;
        // The distance of two points is at least the difference of their distances from any landmark.
        let is_same = |(kept, other): &(Candidate, Matrix)| {
            if kept.kind() != candidate.kind() {
                return false;
            }
            let gaps = places.column_iter().zip(other.column_iter()).map(|(x, y)| (x - y).amax());
            gaps.sum::<f64>() < SAME * places.ncols() as f64
        };
        if !kept.iter().any(is_same) {
            kept.push((candidate, places));
        }
    }
    Ok(kept.into_iter().map(|(candidate, _)| candidate).collect())
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
        let waves = wave_gap(&a.waves, &b.waves, &maps.forth);
        Ok(Self { maps, functional, images: forth, distortion, agreement, waves })
    }

    fn on_all_vertices(&self, a: &MapShape, b: &MapShape) -> Result<SurfaceMap, DescriptorError> {
        let (on_a, on_b) = (self.functional.partners_b(&b.vectors), self.functional.partners_a(&a.vectors));
        let near_b = Cells { rows: &on_a, centres: &b.samples, members: &b.cells };
        let near_a = Cells { rows: &on_b, centres: &a.samples, members: &a.cells };
        let forth = near_b.nearest(&self.functional.points_a(&a.vectors));
        let back = near_a.nearest(&self.functional.points_b(&b.vectors.select_rows(b.landmarks())));
        let images: Vec<usize> = a.landmarks().iter().map(|&x| forth[x] as usize).collect();
        let back: Vec<usize> = back.into_iter().map(|x| x as usize).collect();
        let distortion = codistortion(a, b, &images, &back)?;
        let vertices = forth.into_iter().map(VertexId).collect();
        Ok(SurfaceMap { kind: self.kind(), distortion, agreement: self.agreement, vertices })
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

/// The mean of `|w - v| / (w + v)` over the wave kernels of corresponding samples.
fn wave_gap(a: &Matrix, b: &Matrix, forth: &[u32]) -> f64 {
    let mut sum = 0.0;
    for (x, &y) in forth.iter().enumerate() {
        for (w, v) in a.row(x).iter().zip(b.row(y as usize).iter()) {
            sum += (w - v).abs() / (w + v).max(f64::MIN_POSITIVE);
        }
    }
    sum / (forth.len() * a.ncols()).max(1) as f64
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
