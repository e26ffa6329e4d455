//! The errors of the maps of a pair.

use anyhow::{Context as _, Result};
use canonform::maps::{CorrespondOptions, Correspondence, MapKind, VertexMap, correspond};
use geodesics::{DistanceSolver, Method};
use rayon::prelude::*;
use surface::VertexId;

use super::shapes::PreparedShape;
use crate::sweep::{mean, median};

/// Vertices of a pair whose errors are measured.
const CHECKED: usize = 300;

/// A map with a larger mean error has failed. A front-back error shows as .08 and more, since limbs are thin.
const FAILED: f64 = 0.1;

/// A map with a larger mean error is wrong, if only in parts: right ones have .04 and less, and a centaur whose trunk is turned
/// back to front .08.
const WRONG: f64 = 0.05;

/// A map with the errors of its vertices, as shares of the square root of the area; none if their partners are not known.
#[derive(Debug, Clone, Default)]
pub(super) struct JudgedMap {
    pub(super) errors: Vec<f64>,
    pub(super) is_certain: bool,
    pub(super) distortion: f64,
}

/// What is known of a pair.
pub(super) struct MappedPair {
    pub(super) direct: Option<JudgedMap>,
    pub(super) mirrored: Option<JudgedMap>,
    /// From a vertex to its image under the better map there and the map of the same kind back; measured without known partners.
    pub(super) there_and_back: Vec<f64>,
    /// Whether partners are known.
    pub(super) is_known: bool,
    pub(super) seconds: f64,
}

impl JudgedMap {
    pub(super) fn mean(&self) -> f64 {
        mean(self.errors.iter().copied())
    }

    pub(super) fn has_failed(&self) -> bool {
        self.mean() > FAILED
    }

    /// Whether it has failed, at least in parts.
    pub(super) fn is_wrong(&self) -> bool {
        self.mean() > WRONG
    }
}

impl MappedPair {
    /// Maps one shape to another and judges the maps.
    pub(super) fn new(
        a: &PreparedShape<'_>,
        b: &PreparedShape<'_>,
        options: &CorrespondOptions,
    ) -> Result<Self> {
        let forth = correspond(&a.mapped, &b.mapped, options, &())?;
        let checked = Checked::new(a)?;
        let on_b = SizedDistances::new(b)?;
        let judged = |kind| -> Result<Option<JudgedMap>> {
            let Some(map) = of_kind(&forth, kind) else { return Ok(None) };
            let error = |x: &usize| -> Result<Option<f64>> {
                let truth = a.places.partner(*x, &b.places, kind);
                truth.zip(map.vertices[*x]).map(|(truth, image)| on_b.distance(truth, image)).transpose()
            };
            let errors = checked.0.par_iter().map(error).collect::<Result<Vec<_>>>()?;
            let errors = errors.into_iter().flatten().collect();
            Ok(Some(JudgedMap { errors, is_certain: map.is_certain(), distortion: map.distortion }))
        };
        let is_known = a.places.partner(0, &b.places, MapKind::Direct).is_some();
        let there_and_back = if is_known { Vec::new() } else { round_trip(a, b, &forth, options, &checked)? };
        let [direct, mirrored] = [judged(MapKind::Direct)?, judged(MapKind::Mirrored)?];
        Ok(Self { direct, mirrored, there_and_back, is_known, seconds: forth.seconds })
    }

    /// Whether the mirrored map has the lesser distortion.
    pub(super) fn is_flipped(&self) -> bool {
        let distortion = |map: &Option<JudgedMap>| map.as_ref().map_or(f64::INFINITY, |map| map.distortion);
        distortion(&self.mirrored) < distortion(&self.direct)
    }

    /// The distortion of the better map.
    pub(super) fn distortion(&self) -> f64 {
        self.maps().map(|map| map.distortion).fold(f64::INFINITY, f64::min)
    }

    /// Whether there is no direct map, or it has failed.
    pub(super) fn has_failed(&self) -> bool {
        self.direct.as_ref().is_none_or(JudgedMap::has_failed)
    }

    fn maps(&self) -> impl Iterator<Item = &JudgedMap> {
        self.direct.iter().chain(&self.mirrored)
    }

    /// The maps whose errors are known.
    pub(super) fn judged(&self) -> impl Iterator<Item = &JudgedMap> {
        self.maps().filter(|map| !map.errors.is_empty())
    }

    /// The mean error of the direct map, if it is known.
    pub(super) fn error(&self) -> Option<f64> {
        self.direct.as_ref().filter(|map| !map.errors.is_empty()).map(JudgedMap::mean)
    }
}

/// The vertices of a shape whose errors are measured.
struct Checked(Vec<usize>);

impl Checked {
    fn new(a: &PreparedShape<'_>) -> Result<Self> {
        let n = a.mapped.surface().mesh().n_vertices();
        anyhow::ensure!(n > 0, "a surface has vertices");
        Ok(Self((0..n).step_by(n.div_ceil(CHECKED)).collect()))
    }
}

/// Distances on a surface as shares of the square root of its area.
struct SizedDistances<'a> {
    solver: Box<dyn DistanceSolver + 'a>,
    size: f64,
}

impl<'a> SizedDistances<'a> {
    fn new(shape: &'a PreparedShape<'_>) -> Result<Self> {
        let surface = shape.mapped.surface();
        let solver = Method::default().prepare(surface.intrinsic(), &())?;
        Ok(Self { solver, size: surface.mesh().area().sqrt() })
    }

    fn distance(&self, from: usize, to: VertexId) -> Result<f64> {
        Ok(self.solver.distances(VertexId::from(from))?[to.index()] / self.size)
    }
}

fn of_kind(found: &Correspondence, kind: MapKind) -> Option<&VertexMap> {
    found.maps.iter().find(|map| map.kind == kind)
}

fn round_trip(
    a: &PreparedShape<'_>,
    b: &PreparedShape<'_>,
    forth: &Correspondence,
    options: &CorrespondOptions,
    checked: &Checked,
) -> Result<Vec<f64>> {
    let back = correspond(&b.mapped, &a.mapped, options, &())?;
    let map = forth.maps.first().context("a map")?;
    let Some(inverse) = of_kind(&back, map.kind) else { return Ok(Vec::new()) };
    let on_a = SizedDistances::new(a)?;
    let gap = |x: &usize| -> Result<Option<f64>> {
        let home = map.vertices[*x].and_then(|y| inverse.vertices[y.index()]);
        home.map(|home| on_a.distance(*x, home)).transpose()
    };
    let gaps = checked.0.par_iter().map(gap).collect::<Result<Vec<_>>>()?;
    Ok(gaps.into_iter().flatten().collect())
}

/// The median of errors.
pub(super) fn middle(errors: &[f64]) -> f64 {
    median(errors).1
}
