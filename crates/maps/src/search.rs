//! Sketches of maps: from starts, refined with few samples, scored.

use base::Budget;
use descriptors::DescriptorError;
use linalg::{LinalgError, Matrix};
use rayon::prelude::*;

use crate::error::MapError;
use crate::functional::{FunctionalMaps, SampledPair};
use crate::known::KnownMap;
use crate::nearest_rows::nearest_rows;
use crate::operators::fitted;
use crate::params::MapParams;
use crate::score::Scored;
use crate::shape::MapShape;
use crate::sketch::Sketch;
use crate::start::Start;
use crate::surface_map::MapKind;

/// A search with what is known and its parameters.
#[derive(Clone, Copy)]
pub(crate) struct MapSearch<'a> {
    pub(crate) shapes: [&'a MapShape; 2],
    pub(crate) known: &'a KnownMap,
    pub(crate) params: &'a MapParams,
    pub(crate) budget: &'a Budget,
}

impl MapSearch<'_> {
    /// Different sketches from all starts, and those that differ from them by a mirror.
    pub(crate) fn sketches(&self) -> Result<Vec<Scored>, MapError> {
        let MapSearch { params, known, .. } = self;
        let mut starts = self.starts(&[1.0, -1.0])?;
        known.check_orientation(&starts, params)?;
        let fits = known.fitted(self.shapes).into_iter().map(FunctionalMaps::from);
        starts.extend(self.sketched(&self.stage(2), fits)?);
        // What is beside an identity, whose score is rounding, has its mirrors already. Those of two poses are near 1e-5.
        if starts.iter().all(|start| start.score > f64::EPSILON.sqrt()) {
            let turned = self.turned(&params.distinct(starts.clone()))?;
            starts.extend(self.sketched(&self.stage(2), turned.into_iter())?);
        }
        let stage = self.stage(1);
        let found =
            self.sketched(&stage, params.distinct(starts).into_iter().map(|start| start.functional))?;
        let mut found = self.with_mirrored(params.distinct(found))?;
        let initial = known.start(&stage.pair, self.shapes, stage.last).into_iter().collect();
        let coset = found.len();
        let favored = |one: Scored| Scored { score: one.score / params.clearly, coset, ..one };
        found.extend(self.scored(&stage, initial)?.into_iter().map(favored));
        Ok(known.respecting(found, params))
    }

    /// Different maps that are fitted with these signs, or follow from alignments of the forms; on few samples.
    pub(crate) fn starts(&self, signs: &[f64]) -> Result<Vec<Scored>, DescriptorError> {
        let stage = self.stage(2);
        let [a, b] = self.shapes;
        let operators = || a.operators.iter().zip(&b.operators);
        let fits = signs.iter().flat_map(|sign| operators().flat_map(|(x, y)| fitted(&[[x, y]], *sign)));
        let mut found = self.sketched(&stage, fits.map(FunctionalMaps::from))?;
        found.extend(self.scored(&stage, Start::aligned(a, b, stage.pair.n_points())?)?);
        Ok(self.params.distinct(found))
    }

    /// Maps that take the ends of limbs to where found ones take them, with the other orientation: of people, those that exchange
    /// front and back.
    fn turned(&self, found: &[Scored]) -> Result<Vec<FunctionalMaps>, DescriptorError> {
        let [a, b] = self.shapes;
        let ends = a.ends_of_limbs()?;
        let (Some(of_a), Some(of_b)) = (a.operators.first(), b.operators.first()) else {
            return Ok(Vec::new());
        };
        let heat_on_a = a.heat_operators(&ends);
        let rows = a.spectrum.vectors.select_rows(&ends);
        let other = b.spectrum.vectors.select_rows(&b.samples);
        let one = |found: &Scored| {
            let sign = match found.kind() {
                MapKind::Direct => -1.0,
                MapKind::Mirrored => 1.0,
                MapKind::Unoriented => return Vec::new(),
            };
            let [images, _] =
                nearest_rows(&found.functional.places(0, &rows), &found.functional.places(1, &other));
            let images: Vec<usize> = images.into_iter().map(|y| b.samples[y]).collect();
            fitted(&[[of_a, of_b], [&heat_on_a, &b.heat_operators(&images)]], sign)
        };
        let all: Vec<Vec<Matrix>> = found.par_iter().map(one).collect();
        Ok(all.into_iter().flatten().map(FunctionalMaps::from).collect())
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
        let [a, b] = self.shapes;
        let mirrors = [a.mirrors(self.budget)?, b.mirrors(self.budget)?];
        let others = mirrors.map(|of| &of.others[..]);
        let stage = self.stage(1);
        let turned: Vec<_> = found.iter().flat_map(|one| mirrored(one, others)).collect();
        found.extend(self.sketched(&stage, turned.into_iter())?);
        let sides = mirrors.map(|of| of.sides.as_slice());
        let mut all = Vec::new();
        for (coset, one) in self.params.distinct(found).into_iter().enumerate() {
            let mut others = self.sketched(&stage, mirrored(&one, sides))?;
            // What mixes two maps says nothing about either.
            others.retain(|other| {
                other.kind() != one.kind() && !other.is_mixture(self.params.pure - self.params.lost)
            });
            for other in &mut others {
                other.score = (one.score * other.score).sqrt();
                other.coset = coset;
            }
            let least = others.iter().map(|other| other.score).reduce(f64::min);
            all.push(Scored { score: least.unwrap_or(one.score), coset, ..one });
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
        let n = self.shapes.iter().fold(n, |n, shape| n.min(shape.samples.len()));
        SampledPair::new(self.shapes.map(|shape| shape.spectrum.vectors.select_rows(&shape.samples[..n])))
    }

    /// Refines starts.
    pub(crate) fn scored(&self, stage: &Stage, starts: Vec<Start>) -> Result<Vec<Scored>, DescriptorError> {
        let last = stage.last.min(self.params.eigenfunctions);
        let one = |start: Start| {
            self.budget.check().map_err(LinalgError::from)?;
            Scored::new(self.shapes, self.known, self.params, Sketch::new(&stage.pair, start, last))
        };
        starts.into_par_iter().map(one).collect()
    }
}

/// Samples by which maps are refined, and eigenfunctions of the last step.
pub(crate) struct Stage {
    pub(crate) pair: SampledPair,
    pub(crate) last: usize,
}

/// A map, before or after mirrors of the surfaces.
pub(crate) fn mirrored<'m>(
    one: &'m Scored,
    [of_a, of_b]: [&'m [FunctionalMaps]; 2],
) -> impl Iterator<Item = FunctionalMaps> + 'm {
    let before = of_a.iter().map(|mirror| mirror.then(&one.functional));
    before.chain(of_b.iter().map(|mirror| one.functional.then(mirror)))
}
