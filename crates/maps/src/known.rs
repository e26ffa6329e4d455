//! What is known of a map before it is searched for.

use descriptors::{DescriptorError, Side};
use linalg::Matrix;
use surface::VertexId;

use crate::error::{LandmarkConflict, MapError};
use crate::functional::{FunctionalMaps, SampledPair};
use crate::local::{between, least_distance};
use crate::nearest_rows::nearest_rows;
use crate::operators::{Operators, fitted};
use crate::params::MapParams;
use crate::shape::MapShape;
use crate::sketch::SAMPLES_A_FUNCTION;
use crate::start::Start;
use crate::surface_map::SurfaceMap;

/// Distances of two landmarks may differ by this between the surfaces, as a share of the diameter. A safety limit: true landmarks
/// of built-in men, cats and centaurs in two poses have 0.12 at most.
const CHANGED: f64 = 0.3;

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
    /// The pairs of the initial map: a vertex of the first surface, and one of the second.
    pub(crate) fn initial_pairs(&self) -> impl Iterator<Item = [VertexId; 2]> {
        self.initial.iter().enumerate().filter_map(|(x, y)| Some([VertexId::from(x), (*y)?]))
    }

    fn landmarks_on(&self, side: usize) -> Vec<usize> {
        self.landmarks.iter().map(|pair| pair[side].index()).collect()
    }

    /// Refuses landmarks that give a vertex two partners, or whose distances differ too much. If a surface is possibly a `part` of
    /// the other in the same unit, paths in it may also be longer.
    pub(crate) fn check(&self, [a, b]: [&MapShape; 2], part: Option<Side>) -> Result<(), MapError> {
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
                let landmarks = [i, j];
                if (p[0] == q[0]) != (p[1] == q[1]) {
                    return Err(MapError::Contradiction { landmarks, how: LandmarkConflict::SharedVertex });
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
                    worst = (gap, Some(MapError::Contradiction { landmarks, how }));
                }
            }
        }
        worst.1.map_or(Ok(()), Err)
    }

    /// Samples and landmarks, which maps of functions take to each other.
    pub(crate) fn and_landmarks(&self, pair: SampledPair, shapes: [&MapShape; 2]) -> SampledPair {
        // A landmark weighs as much as one of those of the form, which are spread over the surface.
        let weight = (pair.n_points() as f64 / shapes[0].landmarks().len() as f64).sqrt();
        let rows = |side: usize| shapes[side].spectrum.vectors.select_rows(&self.landmarks_on(side)) * weight;
        SampledPair { landmarks: [0, 1].map(rows), ..pair }
    }

    /// Maps of functions that are fitted to the landmarks and functions, alone and together with what surfaces have in common.
    pub(crate) fn fitted(&self, [a, b]: [&MapShape; 2]) -> Vec<Matrix> {
        let known = [(a, 0), (b, 1)].map(|(shape, side)| self.operators(shape, side));
        let [Some(on_a), Some(on_b)] = known else { return Vec::new() };
        let own = [&on_a, &on_b];
        let both = a.operators.iter().zip(&b.operators).map(|(x, y)| vec![[x, y], own]);
        let all = both.chain([vec![own]]);
        all.flat_map(|pairs| [1.0, -1.0].into_iter().flat_map(move |sign| fitted(&pairs, sign))).collect()
    }

    /// The functions known on one side: heat that was placed at the landmarks, and those that were given.
    fn operators(&self, shape: &MapShape, side: usize) -> Option<Operators> {
        let spectrum = &shape.spectrum;
        let heat = |pair: &[VertexId; 2]| shape.heat(pair[side].index());
        let heat: Vec<Matrix> = self.landmarks.iter().map(heat).collect();
        let given = self.functions.iter().flat_map(|both| both[side].column_iter());
        let columns: Vec<_> = heat.iter().flat_map(|heat| heat.column_iter()).chain(given).collect();
        let functions = (!columns.is_empty()).then(|| Matrix::from_columns(&columns))?;
        Some(Operators::new(spectrum, functions, shape.oriented.as_ref()))
    }

    /// The start that follows from the initial map, to be refined to at most so many eigenfunctions.
    pub(crate) fn start(&self, pair: &SampledPair, [a, b]: [&MapShape; 2], most: usize) -> Option<Start> {
        let partner = |&x: &usize| Some((x, self.initial.get(x).copied().flatten()?.index()));
        // Samples are spread evenly; all vertices, where few of them have partners.
        let mut pairs: Vec<(usize, usize)> = a.samples.iter().filter_map(partner).collect();
        if pairs.len() < SAMPLES_A_FUNCTION * most {
            pairs = (0..self.initial.len()).filter_map(|x| partner(&x)).collect();
        }
        let first = most.min(pairs.len() / SAMPLES_A_FUNCTION).min(pair.n_functions());
        if first == 0 {
            return None;
        }
        let (xs, ys): (Vec<usize>, Vec<usize>) = pairs.into_iter().unzip();
        let rows = |shape: &MapShape, vertices: &[usize]| shape.spectrum.vectors.select_rows(vertices);
        let known = SampledPair::new([rows(a, &xs), rows(b, &ys)]);
        let all: Vec<usize> = (0..xs.len()).collect();
        let functional = FunctionalMaps::new(&known, &[all.clone(), all], first);
        Some(Start { maps: functional.sample_maps(pair), first })
    }

    /// How far a map takes each landmark from its partner, as a share of the square root of the area.
    pub(crate) fn misses(
        &self,
        functional: &FunctionalMaps,
        [a, b]: [&MapShape; 2],
    ) -> Result<Vec<f64>, DescriptorError> {
        if self.landmarks.is_empty() {
            return Ok(Vec::new());
        }
        let [from, to] = [0, 1].map(|side| self.landmarks_on(side));
        let rows = [&a.spectrum.vectors.select_rows(&from), &b.spectrum.vectors];
        let [queries, all] = functional.placed(rows);
        let [images, _] = nearest_rows(&queries, &all);
        // Two points are at least as far apart as their distances from any landmark of the form differ.
        let (found, sought) = (b.distances_to(&images)?, b.distances_to(&to)?);
        Ok(found.column_iter().zip(sought.column_iter()).map(|(p, q)| least_distance(p, q)).collect())
    }

    /// The maps in their order, with the landmarks: the nearest to the initial map first, and the direct one, unless it distorts
    /// distances clearly more. Distances from the initial map are measured on the second surface, `b`.
    pub(crate) fn finished(
        &self,
        mut maps: Vec<SurfaceMap>,
        b: &MapShape,
        params: &MapParams,
    ) -> Result<Vec<SurfaceMap>, DescriptorError> {
        let gap = |map: &SurfaceMap| -> Result<f64, DescriptorError> {
            let both =
                self.initial_pairs().filter_map(|[x, y]| Some((map.vertices[x.index()]?.index(), y.index())));
            let (images, partners): (Vec<usize>, Vec<usize>) = both.unzip();
            Ok((b.distances_to(&images)? - b.distances_to(&partners)?).abs().sum())
        };
        if let [first, second] = &maps[..]
            && gap(second)? < gap(first)?
        {
            maps.swap(0, 1);
        }
        if let [first, second] = &maps[..]
            && second.distortion * params.clearly < first.distortion
        {
            maps.swap(0, 1);
        }
        maps.iter_mut().for_each(|map| self.kept_by(map));
        Ok(maps)
    }

    /// Puts the landmarks into a map and its alternative.
    fn kept_by(&self, map: &mut SurfaceMap) {
        map.landmarks.clone_from(&self.landmarks);
        for [x, y] in &self.landmarks {
            map.vertices[x.index()] = Some(*y);
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
