//! What is known of a map before it is searched for.

use linalg::Matrix;
use surface::VertexId;

use super::curvature::smoothed;
use super::functional_map::{FunctionalMaps, SampledPair, TwoWayMap};
use super::nearest_rows::nearest_rows;
use super::operators::{Operators, fitted};
use super::shape::MapShape;
use super::surface_map::SurfaceMap;
use descriptors::DescriptorError;

/// Maps that take every landmark within this of its partner respect them, as a share of the square root of the area. A safety
/// limit: two maps that are as far apart on average are one.
pub(super) const RESPECTED: f64 = 0.06;

/// Where no map takes all landmarks so near, those respect them that miss by no more than this multiple of the least. A safety
/// limit, for landmarks that were placed by hand.
const BARELY: f64 = 1.5;

/// A map is torn if the share of its vertices whose confidence is below one half exceeds that of another map by this. Between
/// built-in cats with one landmark, mixtures exceed by 0.09 to 0.39, right maps by 0.01.
const TORN: f64 = 0.05;

/// The direct map comes second if its distortion is more than this multiple of the mirrored one's. A convention.
pub(super) const CLEARLY_WORSE: f64 = 1.5;

/// An initial map is refined from one function for so many of its pairs. A convention.
const PAIRS_A_FUNCTION: usize = 4;

/// What is known of a map from one surface to another, before the rest of it is searched for. By default, nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct KnownMap {
    /// Corresponding points: a vertex of the first surface, and one of the second. Maps that do not respect them are not
    /// returned, and those that do contain these pairs.
    pub landmarks: Vec<[VertexId; 2]>,
    /// A map to start from: the partner of each vertex of the first surface, where there is one. Empty if there is no such map.
    pub initial: Vec<Option<VertexId>>,
    /// Functions that correspond, as columns with a row for every vertex: one matrix for each surface.
    pub functions: Option<[Matrix; 2]>,
}

impl KnownMap {
    /// Whether nothing is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The pairs of the initial map: a vertex of the first surface, and one of the second.
    pub(super) fn initial_pairs(&self) -> impl Iterator<Item = [VertexId; 2]> {
        self.initial.iter().enumerate().filter_map(|(x, y)| Some([VertexId::from(x), (*y)?]))
    }

    /// Maps of functions that are fitted to the landmarks and functions, alone and together with what surfaces have in common.
    pub(super) fn fitted(&self, [a, b]: [&MapShape; 2]) -> Vec<Matrix> {
        let known = [(a, 0), (b, 1)].map(|(shape, side)| self.operators(shape, side));
        let [Some(on_a), Some(on_b)] = known else { return Vec::new() };
        let both = a.operators.iter().zip(&b.operators).map(|(x, y)| [x.and(&on_a), y.and(&on_b)]);
        let mut all: Vec<[Operators; 2]> = both.collect();
        all.push([on_a, on_b]);
        all.iter().flat_map(|[x, y]| [1.0, -1.0].into_iter().flat_map(|sign| fitted(x, y, sign))).collect()
    }

    /// The functions known on one side: heat that was placed at the landmarks, and those that were given.
    fn operators(&self, shape: &MapShape, side: usize) -> Option<Operators> {
        let spectrum = &shape.spectrum;
        let heat = |pair: &[VertexId; 2]| {
            let at = spectrum.vectors.row(pair[side].index()).transpose();
            smoothed(&at, &spectrum.values, &spectrum.vectors, 1.0)
        };
        let heat: Vec<Matrix> = self.landmarks.iter().map(heat).collect();
        let given = self.functions.iter().flat_map(|both| both[side].column_iter());
        let columns: Vec<_> = heat.iter().flat_map(|heat| heat.column_iter()).chain(given).collect();
        let functions = (!columns.is_empty()).then(|| Matrix::from_columns(&columns))?;
        Some(Operators::new(spectrum, functions, shape.oriented.as_ref()))
    }

    /// The maps of samples that follow from the initial map, and the number of eigenfunctions to refine it from.
    pub(super) fn initial_start(
        &self,
        pair: &SampledPair,
        [a, b]: [&MapShape; 2],
        most: usize,
    ) -> Option<(TwoWayMap, usize)> {
        let partner = |&x: &usize| Some((x, self.initial.get(x).copied().flatten()?.index()));
        // Samples are spread evenly; all vertices, where few of them have partners.
        let mut pairs: Vec<(usize, usize)> = a.samples.iter().filter_map(partner).collect();
        if pairs.len() < PAIRS_A_FUNCTION * most {
            pairs = (0..self.initial.len()).filter_map(|x| partner(&x)).collect();
        }
        let k = most.min(pairs.len() / PAIRS_A_FUNCTION).min(pair.a.ncols()).min(pair.b.ncols());
        if k == 0 {
            return None;
        }
        let (xs, ys): (Vec<usize>, Vec<usize>) = pairs.into_iter().unzip();
        let rows = |shape: &MapShape, vertices: &[usize]| shape.spectrum.vectors.select_rows(vertices);
        let known = SampledPair { a: rows(a, &xs), b: rows(b, &ys) };
        let all: Vec<usize> = (0..xs.len()).collect();
        let functional = FunctionalMaps::new(&known, &TwoWayMap { forth: all.clone(), back: all }, k);
        Some((functional.sample_maps(pair), k))
    }

    /// How far a map takes the landmark that it misses most from its partner, as a share of the square root of the area.
    fn miss(&self, functional: &FunctionalMaps, [a, b]: [&MapShape; 2]) -> Result<f64, DescriptorError> {
        let [from, to]: [Vec<usize>; 2] =
            [0, 1].map(|side| self.landmarks.iter().map(|pair| pair[side].index()).collect());
        let queries = functional.places_a(&a.spectrum.vectors.select_rows(&from));
        let [images, _] = nearest_rows(&queries, &functional.places_b(&b.spectrum.vectors));
        // Two points are at least as far apart as their distances from any landmark of the form differ.
        let gaps = b.distances_to(&images)? - b.distances_to(&to)?;
        Ok(gaps.amax())
    }

    /// With landmarks, drops maps that are torn: they respect the landmarks by a mixture of two maps.
    pub(super) fn without_mixtures(&self, maps: &mut Vec<SurfaceMap>) {
        let torn = |map: &SurfaceMap| {
            let n_torn = map.vertex_confidence.iter().filter(|confidence| **confidence < 0.5).count();
            n_torn as f64 / map.vertex_confidence.len().max(1) as f64
        };
        let least = maps.iter().map(torn).fold(f64::INFINITY, f64::min);
        maps.retain(|map| self.landmarks.is_empty() || torn(map) <= least + TORN);
    }

    /// The maps in their order, with the landmarks: the nearest to the initial map first, and the direct one, unless it distorts
    /// distances clearly more. `target` is the surface on which distances from the initial map are measured.
    pub(super) fn finished(
        &self,
        mut maps: Vec<SurfaceMap>,
        target: &MapShape,
    ) -> Result<Vec<SurfaceMap>, DescriptorError> {
        let known: Vec<[usize; 2]> = self.initial_pairs().map(|pair| pair.map(VertexId::index)).collect();
        let to = target.distances_to(&known.iter().map(|[_, y]| *y).collect::<Vec<_>>())?;
        let gap = |map: &SurfaceMap| -> Result<f64, DescriptorError> {
            let images: Vec<usize> = known.iter().map(|[x, _]| map.vertices[*x].index()).collect();
            Ok((target.distances_to(&images)? - &to).abs().sum())
        };
        let gaps: Vec<f64> = maps.iter().map(gap).collect::<Result<_, _>>()?;
        if let [first, second] = gaps[..]
            && second < first
        {
            maps.swap(0, 1);
        }
        if let [first, second] = &maps[..]
            && second.distortion * CLEARLY_WORSE < first.distortion
        {
            maps.swap(0, 1);
        }
        maps.iter_mut().for_each(|map| self.kept_by(map));
        Ok(maps)
    }

    /// Puts the landmarks into a map and its alternative.
    fn kept_by(&self, map: &mut SurfaceMap) {
        for [x, y] in &self.landmarks {
            map.vertices[x.index()] = *y;
            if let Some(part) = &mut map.part {
                part.partners[0][x.index()] = Some(*y);
                part.partners[1][y.index()] = Some(*x);
            }
        }
        if let Some(other) = &mut map.alternative {
            self.kept_by(other);
        }
    }

    /// Which of several maps respect the landmarks.
    pub(super) fn respected(
        &self,
        maps: &[&FunctionalMaps],
        shapes: [&MapShape; 2],
    ) -> Result<Vec<bool>, DescriptorError> {
        let misses: Vec<f64> = maps.iter().map(|map| self.miss(map, shapes)).collect::<Result<_, _>>()?;
        let least = misses.iter().copied().fold(f64::INFINITY, f64::min);
        Ok(misses.iter().map(|miss| *miss <= RESPECTED.max(BARELY * least)).collect())
    }
}
