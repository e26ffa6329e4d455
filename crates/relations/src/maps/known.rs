//! What is known of a map before it is searched for.

use linalg::Matrix;
use surface::VertexId;

use super::curvature::smoothed;
use super::error::{LandmarkConflict, MapError};
use super::functional_map::{FunctionalMaps, SampledPair, TwoWayMap};
use super::local::{between, least_distance};
use super::nearest_rows::nearest_rows;
use super::operators::{Operators, fitted};
use super::shape::MapShape;
use super::surface_map::SurfaceMap;
use crate::relation::Side;
use descriptors::{Boundary, DescriptorError};

/// Right maps take 95 % of the landmarks within this of their partners, as a share of the square root of the area. A safety
/// limit: two maps that are as far apart on average are one.
pub(super) const RESPECTED: f64 = 0.06;

/// The direct map comes second if its distortion is more than this multiple of the mirrored one's. A convention.
pub(super) const CLEARLY_WORSE: f64 = 1.5;

/// Landmarks that are missed by more than this multiple of [`RESPECTED`] count alike: one of them may be wrong. A safety limit.
pub(super) const OUTLYING: f64 = 2.0;

/// A map that misses the landmarks by so much, as a mean square, is as likely wrong as right. A convention.
const FIT: Boundary = Boundary::new(OUTLYING * RESPECTED, 4.0);

/// A landmark weighs as much as one in so many of the samples. A convention: as many landmarks are spread over a surface.
const A_HUNDREDTH: f64 = 100.0;

/// Distances of two landmarks may differ by this between the surfaces, as a share of the diameter. A safety limit: poses and
/// persons change them by less.
const CHANGED: f64 = 0.3;

/// A landmark that a map misses by more than this multiple of [`RESPECTED`] does not fit it. A safety limit, beyond the errors of
/// right maps.
pub(super) const UNFIT: f64 = 5.0;

/// An initial map is refined from one function for so many of its pairs. A convention.
const PAIRS_A_FUNCTION: usize = 4;

/// What is known of a map from one surface to another, before the rest of it is searched for. By default, nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct KnownMap {
    /// Corresponding points: a vertex of the first surface, and one of the second. They choose among maps, which are fitted to
    /// them and contain these pairs.
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

    fn landmarks_on(&self, side: usize) -> Vec<usize> {
        self.landmarks.iter().map(|pair| pair[side].index()).collect()
    }

    /// Refuses landmarks that give a vertex two partners, or whose distances differ too much. If a surface is possibly a `part` of
    /// the other in the same unit, paths in it may also be longer.
    pub(super) fn check(&self, [a, b]: [&MapShape; 2], part: Option<Side>) -> Result<(), MapError> {
        if self.landmarks.len() < 2 {
            return Ok(());
        }
        let on = |shape: &MapShape, side: usize| -> Result<(Matrix, f64), DescriptorError> {
            let to = shape.distances_to(&self.landmarks_on(side))?;
            Ok((between(&to, &to), shape.all_distances()?.max()))
        };
        let ((on_a, of_a), (on_b, of_b)) = (on(a, 0)?, on(b, 1)?);
        let diameter = of_a.max(of_b);
        let mut worst = (CHANGED * diameter, None);
        for (i, p) in self.landmarks.iter().enumerate() {
            for (j, q) in self.landmarks.iter().enumerate().skip(i + 1) {
                if (p[0] == q[0]) != (p[1] == q[1]) {
                    let how = LandmarkConflict::SharedVertex;
                    return Err(MapError::Contradiction { landmarks: [i, j], how });
                }
                let (x, y) = (on_a[(i, j)], on_b[(i, j)]);
                let in_unit = y * b.size / a.size;
                let gap = match part {
                    None => (x - y).abs(),
                    Some(Side::First) => (x - y).abs().min(in_unit - x),
                    Some(Side::Second) => (x - y).abs().min(x - in_unit),
                };
                if gap > worst.0 {
                    let how = LandmarkConflict::Distance([x / diameter, y / diameter]);
                    worst = (gap, Some(MapError::Contradiction { landmarks: [i, j], how }));
                }
            }
        }
        worst.1.map_or(Ok(()), Err)
    }

    /// Samples and landmarks, which maps of functions take to each other.
    pub(super) fn and_landmarks(&self, pair: SampledPair, shapes: [&MapShape; 2]) -> SampledPair {
        let weight = (pair.a.nrows() as f64 / A_HUNDREDTH).sqrt();
        let rows = |side: usize| shapes[side].spectrum.vectors.select_rows(&self.landmarks_on(side)) * weight;
        SampledPair { landmarks: [0, 1].map(rows), ..pair }
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
        let known = SampledPair::new(rows(a, &xs), rows(b, &ys));
        let all: Vec<usize> = (0..xs.len()).collect();
        let functional = FunctionalMaps::new(&known, &TwoWayMap { forth: all.clone(), back: all }, k);
        Some((functional.sample_maps(pair), k))
    }

    /// How much less likely a map is the right one by the landmarks, as a factor for its score with the odds that follow: misses are
    /// as those of a normal distribution, but for outliers.
    pub(super) fn penalty(misses: &[f64], steepness: f64) -> f64 {
        let loss = |miss: &f64| 2.0 * (miss / RESPECTED).min(OUTLYING).powi(2);
        // Finite for any number of landmarks.
        (misses.iter().map(loss).sum::<f64>() / steepness).min(100.0).exp()
    }

    /// How likely a right map would miss the landmarks by so much.
    pub(super) fn fit(misses: &[f64]) -> f64 {
        let mean = misses.iter().map(|miss| miss * miss).sum::<f64>() / misses.len().max(1) as f64;
        FIT.probability(mean.sqrt())
    }

    /// How far a map takes each landmark from its partner, as a share of the square root of the area.
    pub(super) fn misses(
        &self,
        functional: &FunctionalMaps,
        [a, b]: [&MapShape; 2],
    ) -> Result<Vec<f64>, DescriptorError> {
        if self.landmarks.is_empty() {
            return Ok(Vec::new());
        }
        let [from, to] = [0, 1].map(|side| self.landmarks_on(side));
        let queries = functional.places_a(&a.spectrum.vectors.select_rows(&from));
        let [images, _] = nearest_rows(&queries, &functional.places_b(&b.spectrum.vectors));
        // Two points are at least as far apart as their distances from any landmark of the form differ.
        let (found, sought) = (b.distances_to(&images)?, b.distances_to(&to)?);
        Ok(found.column_iter().zip(sought.column_iter()).map(|(p, q)| least_distance(p, q)).collect())
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
}
