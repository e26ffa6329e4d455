//! The errors of the maps of a pair.

use anyhow::Result;
use canonform::maps::{CorrespondOptions, MapKind, correspond};
use geodesics::Method;
use rayon::prelude::*;
use surface::VertexId;

use super::shapes::PreparedShape;
use crate::sweep::mean;

/// Vertices of a pair whose errors are measured.
const CHECKED: usize = 300;

/// A map with a larger mean error has failed. A front-back error shows as .08 and more, since limbs are thin.
const FAILED: f64 = 0.1;

/// A map with a larger mean error is wrong, if only in parts: right ones have .04 and less, and a centaur whose trunk is turned
/// back to front .08.
const WRONG: f64 = 0.05;

/// A map with the errors of its vertices, as shares of the square root of the area; none if their partners are not known.
pub(super) struct JudgedMap {
    pub(super) errors: Vec<f64>,
    pub(super) is_certain: bool,
    distortion: f64,
}

/// What is known of a pair.
pub(super) struct MappedPair {
    pub(super) direct: Option<JudgedMap>,
    pub(super) mirrored: Option<JudgedMap>,
    /// Whether partners are known.
    pub(super) is_known: bool,
    pub(super) seconds: f64,
}

impl JudgedMap {
    fn mean(&self) -> f64 {
        mean(self.errors.iter().copied())
    }

    /// Whether it has failed, at least in parts.
    pub(super) fn is_wrong(&self) -> bool {
        self.mean() > WRONG
    }
}

impl MappedPair {
    /// Maps one shape to another and judges the maps.
    pub(super) fn new(
        [(a, from), (b, to)]: [&PreparedShape<'_>; 2],
        options: &CorrespondOptions,
    ) -> Result<Self> {
        let found = correspond(from, to, options, &())?;
        let surface = to.surface();
        let (solver, size) =
            (Method::default().prepare(surface.intrinsic(), &())?, surface.mesh().root_of_area());
        let n = from.surface().mesh().n_vertices();
        let judged = |kind| -> Result<Option<JudgedMap>> {
            let Some(map) = found.maps.iter().find(|map| map.kind == kind) else { return Ok(None) };
            let checked = (0..n).step_by(n.div_ceil(CHECKED).max(1));
            let checked = checked.filter_map(|x| a.places.partner(x, &b.places, kind).zip(map.vertices[x]));
            let error = |(truth, image): (usize, VertexId)| {
                Ok(solver.distances(VertexId::from(truth))?[image.index()] / size)
            };
            let errors = checked.collect::<Vec<_>>().into_par_iter().map(error).collect::<Result<_>>()?;
            Ok(Some(JudgedMap { errors, is_certain: map.is_certain(), distortion: map.distortion }))
        };
        let is_known = a.places.partner(0, &b.places, MapKind::Direct).is_some();
        let [direct, mirrored] = [judged(MapKind::Direct)?, judged(MapKind::Mirrored)?];
        Ok(Self { direct, mirrored, is_known, seconds: found.seconds })
    }

    /// The distortions of the direct and the mirrored map.
    pub(super) fn distortions(&self) -> [f64; 2] {
        [&self.direct, &self.mirrored].map(|map| map.as_ref().map_or(f64::INFINITY, |map| map.distortion))
    }

    /// Whether there is no direct map, or it has failed.
    pub(super) fn has_failed(&self) -> bool {
        self.direct.as_ref().is_none_or(|map| map.mean() > FAILED)
    }

    /// The maps whose errors are known.
    pub(super) fn judged(&self) -> impl Iterator<Item = &JudgedMap> {
        self.direct.iter().chain(&self.mirrored).filter(|map| !map.errors.is_empty())
    }
}
