//! The search for the best maps.

use base::{Budget, Observer};
use descriptors::{DescriptorError, Side};
use linalg::LinalgError;
use rayon::prelude::*;

use crate::error::MapError;
use crate::functional::{FunctionalMaps, SampledPair};
use crate::known::KnownMap;
use crate::mirror::mirrored;
use crate::operators::fitted;
use crate::params::MapParams;
use crate::part::part_maps;
use crate::refine::Refined;
use crate::score::Scored;
use crate::shape::MapShape;
use crate::sketch::Sketch;
use crate::start::Start;
use crate::surface_map::{MapKind, SurfaceMap};

/// A surface with a boundary may be a part if its area is such a share of that of the other surface, both in the same unit. A
/// larger one is mapped as a whole, and of a smaller one too little is known. Safety limits.
const SHARES: [f64; 2] = [0.25, 0.92];

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
/// maps miss the landmarks is part of their score, and the last fit is to them as well; and an initial map is one more start, which
/// comes out unless another map is clearly better.
///
/// If one surface has a boundary and is clearly smaller, it may be a part of the other that a cut has left, if both have the
/// same unit of length. Then maps of a part are sought, too, and those that change distances less are returned.
/// [`SurfaceMap::part`] tells which. With known functions, both are mapped as wholes. A part:
///
/// 1. Twelve landmarks of the part go one after the other to all landmarks of the whole. What keeps distances, curvature and
///    areas of discs is kept.
/// 2. All other samples go where their distances from these fit best, and then all again by their distances from all
///    landmarks. Of distances that a path through what is missing may shorten, only bounds are known.
/// 3. Of each orientation, the map that keeps distances, curvature and the products of functions best is taken.
///
/// # Errors
/// [`MapError::Contradiction`] for landmarks that cannot all be right; [`MapError::Descriptor`], also if the budget of the observer
/// is exceeded.
pub fn map_surfaces(
    a: &MapShape,
    b: &MapShape,
    known: &KnownMap,
    params: &MapParams,
    observer: &dyn Observer,
) -> Result<Vec<SurfaceMap>, MapError> {
    let side = possible_part(a, b);
    known.check([a, b], side)?;
    let budget = observer.budget();
    let search = MapSearch { a, b, known, params, budget: &budget };
    let mut maps = search.maps()?;
    if let Some(side) = side.filter(|_| known.functions.is_none()) {
        let of_part = part_maps(&search, side)?;
        let least = |maps: &[SurfaceMap]| maps.iter().map(|map| map.distortion).fold(f64::INFINITY, f64::min);
        if least(&of_part) < least(&maps) {
            maps = of_part;
        }
    }
    Ok(known.finished(maps, b, params)?)
}

/// The surface that may be a part of the other; `None` if neither has a boundary and is much smaller.
fn possible_part(a: &MapShape, b: &MapShape) -> Option<Side> {
    let share = (a.size / b.size).powi(2);
    let is_part =
        |shape: &MapShape, share: f64| shape.from_cut.is_some() && share > SHARES[0] && share < SHARES[1];
    match () {
        () if is_part(a, share) => Some(Side::First),
        () if is_part(b, 1.0 / share) => Some(Side::Second),
        () => None,
    }
}

/// A search with what is known and its parameters.
#[derive(Clone, Copy)]
pub(crate) struct MapSearch<'a> {
    pub(crate) a: &'a MapShape,
    pub(crate) b: &'a MapShape,
    pub(crate) known: &'a KnownMap,
    pub(crate) params: &'a MapParams,
    pub(crate) budget: &'a Budget,
}

impl MapSearch<'_> {
    /// The best map of each orientation of two wholes.
    fn maps(&self) -> Result<Vec<SurfaceMap>, MapError> {
        let mut sketches = self.sketches()?;
        let mut maps = Vec::new();
        for sought in MapKind::ALL {
            if sought == MapKind::Unoriented && !maps.is_empty() {
                break;
            }
            let (of_kind, others) = sketches.into_iter().partition(|found| found.kind() == sought);
            sketches = others;
            let best = Refined::best(self, of_kind)?;
            maps.extend(best.map(|best| best.on_all_vertices([self.a, self.b])).transpose()?);
        }
        Ok(maps)
    }

    /// Different sketches from all starts, and those that differ from them by a mirror.
    fn sketches(&self) -> Result<Vec<Scored>, MapError> {
        let MapSearch { params, known, .. } = self;
        let mut starts = self.starts(&[1.0, -1.0])?;
        known.check_orientation(&starts, params)?;
        let fits = known.fitted([self.a, self.b]).into_iter().map(FunctionalMaps::from);
        starts.extend(self.sketched(&self.stage(2), fits)?);
        let stage = self.stage(1);
        let found =
            self.sketched(&stage, params.distinct(starts).into_iter().map(|start| start.functional))?;
        let mut found = self.with_mirrored(params.distinct(found))?;
        let initial = known.start(&stage.pair, [self.a, self.b], stage.last).into_iter().collect();
        let favored = |found: Scored| Scored { score: found.score / params.clearly, ..found };
        found.extend(self.scored(&stage, initial)?.into_iter().map(favored));
        Ok(known.respecting(found, params))
    }

    /// Different maps that are fitted with these signs, or follow from alignments of the forms; on few samples.
    pub(crate) fn starts(&self, signs: &[f64]) -> Result<Vec<Scored>, DescriptorError> {
        let stage = self.stage(2);
        let operators = || self.a.operators.iter().zip(&self.b.operators);
        let fits = signs.iter().flat_map(|sign| operators().flat_map(|(x, y)| fitted(&[[x, y]], *sign)));
        let mut found = self.sketched(&stage, fits.map(FunctionalMaps::from))?;
        found.extend(self.scored(&stage, Start::aligned(self.a, self.b, stage.pair.a.nrows())?)?);
        Ok(self.params.distinct(found))
    }

    /// The sketches that follow from maps of functions.
    pub(crate) fn sketched(
        &self,
        stage: &Stage,
        maps: impl Iterator<Item = FunctionalMaps>,
    ) -> Result<Vec<Scored>, DescriptorError> {
        self.scored(stage, maps.map(|functional| Start::functional(&functional, &stage.pair)).collect())
    }

    /// These maps and those that differ from them by a mirror of a surface, if there is one. A map and the one that differs by
    /// left and right stand and fall together: each has the score of both. Other mirrors only lead to more maps, since a right
    /// map and a wrong one may differ by front and back.
    fn with_mirrored(&self, mut found: Vec<Scored>) -> Result<Vec<Scored>, DescriptorError> {
        let mirrors = [self.a.mirrors(self.budget)?, self.b.mirrors(self.budget)?];
        let others = mirrors.map(|of| &of.others[..]);
        let stage = self.stage(1);
        let turned: Vec<_> = found.iter().flat_map(|one| mirrored(one, others)).collect();
        found.extend(self.sketched(&stage, turned.into_iter())?);
        let sides = mirrors.map(|of| of.sides.as_slice());
        let mut all = Vec::new();
        for one in self.params.distinct(found) {
            let mut others = self.sketched(&stage, mirrored(&one, sides))?;
            others.retain(|other| other.kind() != one.kind());
            others.iter_mut().for_each(|other| other.score = (one.score * other.score).sqrt());
            let least = others.iter().map(|other| other.score).reduce(f64::min);
            all.push(Scored { score: least.unwrap_or(one.score), ..one });
            all.extend(others);
        }
        Ok(all)
    }

    /// Refinement by one over so many of the samples and eigenfunctions of sketches.
    pub(crate) fn stage(&self, over: usize) -> Stage {
        Stage { pair: self.samples(self.params.samples / over), last: self.params.functions / over }
    }

    /// Eigenfunctions at the first `n` samples of both surfaces.
    pub(crate) fn samples(&self, n: usize) -> SampledPair {
        let n = n.min(self.a.samples.len()).min(self.b.samples.len());
        let [a, b] = [self.a, self.b].map(|shape| shape.spectrum.vectors.select_rows(&shape.samples[..n]));
        SampledPair::new(a, b)
    }

    /// Refines starts.
    pub(crate) fn scored(&self, stage: &Stage, starts: Vec<Start>) -> Result<Vec<Scored>, DescriptorError> {
        let last = stage.last.min(self.params.eigenfunctions);
        let one = |start: Start| {
            self.budget.check().map_err(LinalgError::from)?;
            Scored::new([self.a, self.b], self.known, self.params, Sketch::new(&stage.pair, start, last))
        };
        starts.into_par_iter().map(one).collect()
    }
}

/// Samples by which maps are refined, and eigenfunctions of the last step.
pub(crate) struct Stage {
    pub(crate) pair: SampledPair,
    pub(crate) last: usize,
}
