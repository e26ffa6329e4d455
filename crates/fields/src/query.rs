//! Questions to a field.

use geodesics::{DistanceSolver, Source};
use rayon::prelude::*;
use serde::Serialize;
use surface::VertexId;

use crate::distance_field::DistanceField;
use crate::error::FieldError;
use crate::metric::Interval;
use base::Observer;

/// Which pairs are finished by exact propagation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finish {
    /// None.
    Never,
    /// Those whose interval is wider than this share of its lower end. Where the intervals hold, no distance is then wrong by a
    /// larger share.
    Beyond(f64),
}

impl Default for Finish {
    /// Beyond 5 %.
    fn default() -> Self {
        Self::Beyond(0.05)
    }
}

impl Finish {
    fn wants(self, pair: &PairDistance) -> bool {
        let Self::Beyond(share) = self else { return false };
        pair.kind == PairKind::Estimated && pair.upper - pair.lower > share * pair.lower
    }
}

/// The distance between two vertices, with bounds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PairDistance {
    /// A vertex of the input.
    pub a: VertexId,
    /// Another.
    pub b: VertexId,
    /// Their distance along the surface, in mesh units. Infinite if the repair dropped one of them.
    pub distance: f64,
    /// No distance is below this.
    pub lower: f64,
    /// No distance is above this.
    pub upper: f64,
    /// How the distance was found.
    pub kind: PairKind,
}

/// How the distance of a pair was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PairKind {
    /// Estimated from the landmarks.
    Estimated,
    /// By exact propagation; only rounding is left.
    Exact,
    /// The repair dropped one of the vertices.
    Dropped,
}

/// The rounding of exact distances, as a share of them.
const ROUNDING: f64 = 1e-9;

impl PairDistance {
    fn exact([a, b]: [VertexId; 2], distance: f64) -> Self {
        let [lower, upper] = [distance * (1.0 - ROUNDING), distance * (1.0 + ROUNDING)];
        Self { a, b, distance, lower, upper, kind: PairKind::Exact }
    }
}

impl DistanceField {
    /// The distance of two vertices of the input, estimated, in well below a microsecond.
    ///
    /// # Errors
    /// [`FieldError::Geodesic`] for a vertex that does not exist.
    pub fn pair(&self, a: VertexId, b: VertexId) -> Result<PairDistance, FieldError> {
        let (Some(on_a), Some(on_b)) = (self.repaired(a)?, self.repaired(b)?) else {
            let [distance, lower, upper] = [f64::INFINITY; 3];
            return Ok(PairDistance { a, b, distance, lower, upper, kind: PairKind::Dropped });
        };
        if on_a == on_b {
            return Ok(PairDistance::exact([a, b], 0.0));
        }
        let (distance, Interval { lower, upper }) = self.metric.pair(on_a.index(), on_b.index());
        Ok(PairDistance { a, b, distance, lower, upper, kind: PairKind::Estimated })
    }

    /// The distances of many pairs of vertices of the input, in parallel, in their order. Finished pairs are grouped by vertex,
    /// so pairs that share one cost less.
    ///
    /// # Errors
    /// [`FieldError::Geodesic`] for a vertex that does not exist; [`FieldError::Exceeded`].
    pub fn pairs(
        &self,
        pairs: &[[VertexId; 2]],
        finish: Finish,
        observer: &dyn Observer,
    ) -> Result<Vec<PairDistance>, FieldError> {
        let answers = pairs.par_iter().with_min_len(1024).map(|[a, b]| self.pair(*a, *b));
        let mut answers = answers.collect::<Result<Vec<_>, FieldError>>()?;
        let open = answers.iter().enumerate().filter(|(_, answer)| finish.wants(answer));
        // From the lower vertex, so that both directions of a pair give the same number.
        let from_lower = |(place, answer): (usize, &PairDistance)| {
            let [a, b] = [self.remap.to_new(answer.a)?, self.remap.to_new(answer.b)?];
            Some((a.min(b), place, a.max(b)))
        };
        let mut unfinished: Vec<(VertexId, usize, VertexId)> = open.filter_map(from_lower).collect();
        unfinished.sort_unstable();
        let groups: Vec<_> = unfinished.chunk_by(|a, b| a.0 == b.0).collect();
        observer.begin("near pairs", groups.len());
        let finished = groups.par_iter().map_init(Vec::new, |distances, group| {
            let radius = group.iter().map(|(_, place, _)| answers[*place].upper).fold(0.0, f64::max);
            self.propagate(group[0].0, radius, distances, observer)?;
            if group.iter().any(|(.., target)| distances[target.index()].is_infinite()) {
                // The error of the columns was larger than stated.
                self.propagate(group[0].0, f64::INFINITY, distances, observer)?;
            }
            observer.step();
            Ok(group.iter().map(|(_, place, to)| (*place, distances[to.index()])).collect::<Vec<_>>())
        });
        for (place, distance) in finished.collect::<Result<Vec<_>, FieldError>>()?.into_iter().flatten() {
            answers[place] = PairDistance::exact(pairs[place], distance);
        }
        Ok(answers)
    }

    /// The distances from one vertex of the input to all, in the order of the input.
    ///
    /// # Errors
    /// As [`pairs`](Self::pairs).
    pub fn row(
        &self,
        source: VertexId,
        finish: Finish,
        observer: &dyn Observer,
    ) -> Result<Vec<PairDistance>, FieldError> {
        let from = self.repaired(source)?;
        let vertices = (0..self.n_vertices()).into_par_iter().with_min_len(1024);
        let row = vertices.map(|vertex| self.pair(source, VertexId::from(vertex)));
        let mut row = row.collect::<Result<Vec<_>, FieldError>>()?;
        let open = row.iter().filter(|answer| finish.wants(answer));
        let radius = open.map(|answer| answer.upper).reduce(f64::max);
        if let (Some(from), Some(radius)) = (from, radius) {
            let mut distances = Vec::new();
            self.propagate(from, radius, &mut distances, observer)?;
            for (vertex, answer) in row.iter_mut().enumerate() {
                if let Some(to) = self.remap.to_new(VertexId::from(vertex))
                    && distances[to.index()].is_finite()
                {
                    *answer = PairDistance::exact([answer.a, answer.b], distances[to.index()]);
                }
            }
        }
        Ok(row)
    }

    /// The `k` vertices of the input nearest to one of them along the surface, itself left out: exact distances, nearest
    /// first, equally near ones by their numbers. Fewer if there are fewer.
    ///
    /// # Errors
    /// As [`pairs`](Self::pairs).
    pub fn nearest(
        &self,
        source: VertexId,
        k: usize,
        observer: &dyn Observer,
    ) -> Result<Vec<PairDistance>, FieldError> {
        let Some(from) = self.repaired(source)? else { return Ok(Vec::new()) };
        let others: Vec<(VertexId, VertexId)> = (0..self.n_vertices())
            .map(VertexId::from)
            .filter(|input| *input != source)
            .filter_map(|input| Some((input, self.remap.to_new(input)?)))
            .collect();
        let k = k.min(others.len());
        if k == 0 {
            return Ok(Vec::new());
        }
        // At least k vertices are no farther than the k-th smallest upper bound.
        let upper = |(_, to): &(VertexId, VertexId)| self.metric.intervals(from.index(), to.index()).1.upper;
        let mut uppers: Vec<f64> = others.par_iter().with_min_len(1024).map(upper).collect();
        let (_, radius, _) = uppers.select_nth_unstable_by(k - 1, f64::total_cmp);
        let mut distances = Vec::new();
        let mut nearest = Vec::new();
        // The second limit is for columns whose error is larger than stated.
        for radius in [*radius, f64::INFINITY] {
            self.propagate(from, radius, &mut distances, observer)?;
            let found = others.iter().map(|(input, to)| (distances[to.index()], *input));
            nearest = found.filter(|(distance, _)| distance.is_finite()).collect();
            if nearest.len() >= k {
                break;
            }
        }
        nearest.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest.truncate(k);
        Ok(nearest
            .into_iter()
            .map(|(distance, input)| PairDistance::exact([source, input], distance))
            .collect())
    }

    /// Exact distances from a vertex of the repaired mesh, infinite beyond the radius.
    fn propagate(
        &self,
        source: VertexId,
        radius: f64,
        distances: &mut Vec<f64>,
        observer: &dyn Observer,
    ) -> Result<(), FieldError> {
        distances.resize(self.surface.n_vertices(), f64::INFINITY);
        let limit = radius * (1.0 + ROUNDING);
        Ok(self.exact(observer)?.solve_into(&[Source::vertex(source)], limit, distances)?)
    }
}
