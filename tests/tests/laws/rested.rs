//! Surfaces whose true partners are known: poses of a body, and what a cut has left of them.

use std::sync::LazyLock;

use canonform::maps::{CorrespondOptions, KnownMap, MapKind, MappedSurface, SurfaceMap, correspond};
use datasets::{ArticulatedOptions, Damage, Family, articulated_at_rest};
use geodesics::Method;
use mesh::TriMesh;
use nalgebra::Point3;
use rigid::NearestPoints;
use surface::VertexId;

use crate::support::surface;

/// Two poses of a cat, and the maps between them if nothing is known.
pub(crate) static CATS: LazyLock<([Rested; 2], Vec<SurfaceMap>)> = LazyLock::new(|| {
    let cats = [0, 4].map(|pose| Rested::pose(Family::Cat, pose, 1000));
    let maps = cats[0].maps_to(&cats[1]);
    (cats, maps)
});

/// A mesh, ready for dense maps.
pub(crate) fn prepared(mesh: &TriMesh) -> MappedSurface {
    MappedSurface::new(surface(mesh), &CorrespondOptions::default(), &()).unwrap()
}

/// The maps that fit what is known of them.
pub(crate) fn maps_with(known: KnownMap, [a, b]: [&MappedSurface; 2]) -> Vec<SurfaceMap> {
    let options = CorrespondOptions { known, ..CorrespondOptions::default() };
    correspond(a, b, &options, &()).unwrap().maps
}

pub(crate) fn maps(a: &MappedSurface, b: &MappedSurface) -> Vec<SurfaceMap> {
    maps_with(KnownMap::default(), [a, b])
}

pub(crate) fn of_kind(maps: &[SurfaceMap], kind: MapKind) -> &SurfaceMap {
    maps.iter().find(|map| map.kind == kind).unwrap_or_else(|| panic!("no {kind:?} map"))
}

/// A surface with the places of its vertices on the body at rest.
pub(crate) struct Rested {
    pub(crate) mapped: MappedSurface,
    pub(crate) mesh: TriMesh,
    pub(crate) at_rest: NearestPoints,
}

impl Rested {
    pub(crate) fn new(mesh: TriMesh, at_rest: Vec<Point3<f64>>) -> Self {
        Self { mapped: prepared(&mesh), mesh, at_rest: NearestPoints::new(at_rest).unwrap() }
    }

    pub(crate) fn pose(family: Family, pose: usize, n_vertices: usize) -> Self {
        let options = ArticulatedOptions { n_vertices, ..ArticulatedOptions::default() };
        let rested = articulated_at_rest(family, 0, pose, &options, &()).unwrap();
        Self::new(rested.shape.mesh, rested.rest.positions)
    }

    /// What a plane has left of it.
    pub(crate) fn part(&self, share: f64, seed: u64) -> Self {
        let part = Damage::Slice(share).apply(&self.mesh, seed);
        let originals = NearestPoints::new(self.mesh.positions.clone()).unwrap();
        let at_rest = part.positions.iter().map(|p| self.at_rest.points()[originals.nearest(p).0]);
        let at_rest = at_rest.collect();
        Self::new(part, at_rest)
    }

    pub(crate) fn maps_to(&self, other: &Self) -> Vec<SurfaceMap> {
        maps(&self.mapped, &other.mapped)
    }

    /// The true partner of a vertex, directly (1) or mirrored (-1), and how far away at rest it is.
    pub(crate) fn partner(&self, other: &Self, x: usize, sign: f64) -> (VertexId, f64) {
        let p = self.at_rest.points()[x];
        let p = Point3::new(sign * p.x, p.y, p.z);
        let y = other.at_rest.nearest(&p).0;
        (VertexId::from(y), (other.at_rest.points()[y] - p).norm())
    }

    /// The true partners of all vertices.
    pub(crate) fn partners(&self, other: &Self) -> Vec<VertexId> {
        (0..self.mesh.n_vertices()).map(|x| self.partner(other, x, 1.0).0).collect()
    }

    /// The mean distance on the other surface between images and true partners, over a unit of length.
    pub(crate) fn error(&self, other: &Self, map: &SurfaceMap, unit: f64) -> f64 {
        let sign = if map.kind == MapKind::Mirrored { -1.0 } else { 1.0 };
        let solver = Method::default().prepare(other.mesh.intrinsic(), &()).unwrap();
        let matched = map.vertices.iter().enumerate().filter_map(|(x, y)| Some((x, (*y)?.index())));
        let error =
            |(x, y): (usize, usize)| solver.distances(self.partner(other, x, sign).0).unwrap()[y] / unit;
        let errors: Vec<f64> = matched.step_by(10).map(error).collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    }
}
