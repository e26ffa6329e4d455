//! The shapes that are mapped, and what is known of their vertices.

use std::borrow::Cow;
use std::collections::HashSet;

use anyhow::{Context as _, Result};
use canonform::Surface;
use canonform::maps::{MapKind, MappedSurface};
use datasets::{ArticulatedOptions, Damage, Family, RestedShape, articulated_at_rest};
use mesh::TriMesh;
use nalgebra::Point3;
use rigid::NearestPoints;
use surface::VertexId;

use crate::collection::{LabeledSurface, Setting, SurfaceCollection};

/// A shape that is ready to be mapped.
pub(super) type PreparedShape<'a> = (&'a PlacedShape<'a>, MappedSurface<&'a Surface>);

/// Vertices of shapes that get triangles of their own, as in published comparisons.
const REMESHED: usize = 5000;

/// The least share of the edges of a mesh that another one with the same numbering has. Poses of TOSCA agree in more than 93 %,
/// since a few of their edges were flipped.
const SAME_EDGES: f64 = 0.9;

/// All pairs of groups of so many shapes are mapped, and each shape to the next one of a larger group.
const FEW: usize = 7;

/// Bodies of the group of different bodies.
const BODIES: usize = 8;

/// The groups of built-in shapes that are not in the collection.
const TOUCHING: &str = "person";
const DIFFERENT: &str = "bodies";

/// A shape with the place of every vertex on a surface on which all shapes of its group correspond.
pub(super) struct PlacedShape<'a> {
    pub(super) name: String,
    pub(super) surface: Cow<'a, Surface>,
    pub(super) places: VertexPlaces,
}

/// Where the vertices of a shape are on a common surface.
pub(super) enum VertexPlaces {
    Unknown,
    /// On one of the shapes.
    Known(NearestPoints),
    /// On a body that is its own mirror image at `x = 0`.
    Symmetric(NearestPoints),
}

/// Shapes that are mapped to each other.
pub(super) struct MapGroup<'a> {
    pub(super) name: String,
    pub(super) shapes: Vec<PlacedShape<'a>>,
}

impl VertexPlaces {
    /// The true partner of vertex `x` among the vertices of `to`, directly or mirrored; `None` if it is not known.
    pub(super) fn partner(&self, x: usize, to: &Self, kind: MapKind) -> Option<usize> {
        match (self, to, kind) {
            (Self::Symmetric(from), Self::Symmetric(to), MapKind::Mirrored) => {
                let p = from.points()[x];
                Some(to.nearest(&Point3::new(-p.x, p.y, p.z)).0)
            }
            (Self::Known(from), Self::Known(to), MapKind::Direct)
            | (Self::Symmetric(from), Self::Symmetric(to), MapKind::Direct) => {
                Some(to.nearest(&from.points()[x]).0)
            }
            _ => None,
        }
    }
}

impl<'a> MapGroup<'a> {
    /// The groups of a run: the classes of the collection, and if they are all built-in ones, people whose limbs touch, and
    /// people of different bodies.
    pub(super) fn all(collection: &'a SurfaceCollection, seed: u64) -> Result<Vec<Self>> {
        let is_built_in = collection.is_built_in();
        let of_class = |class: &String| -> Result<Self> {
            let all: Vec<_> = collection.shapes.iter().filter(|shape| shape.label == *class).collect();
            let one = |(i, shape): (usize, &&'a LabeledSurface)| match is_built_in {
                true => built_in(shape, seed),
                false => from_file(shape, all[0], i as u64),
            };
            let shapes = all.iter().enumerate().map(one).collect::<Result<_>>()?;
            Ok(Self { name: class.clone(), shapes })
        };
        let mut groups = collection.classes.iter().map(of_class).collect::<Result<Vec<_>>>()?;
        if let Some(first) = collection.shapes.first().filter(|_| collection.setting() == Setting::BuiltIn) {
            let options = ArticulatedOptions { seed, n_vertices: first.surface.mesh().n_vertices() };
            let poses = Family::Person.n_shapes();
            groups.push(Self::generated(TOUCHING, (0..poses).map(|pose| [0, pose]), &options)?);
            // Every body in a pose of its own.
            groups.push(Self::generated(DIFFERENT, (1..=BODIES).map(|body| [body, body % poses]), &options)?);
        }
        Ok(groups)
    }

    /// Shapes of people, by the numbers of body and pose.
    fn generated(
        name: &str,
        shapes: impl Iterator<Item = [usize; 2]>,
        options: &ArticulatedOptions,
    ) -> Result<Self> {
        let one = |[body, pose]: [usize; 2]| {
            let RestedShape { shape, rest } = articulated_at_rest(Family::Person, body, pose, options, &())?;
            let surface = Cow::Owned(Surface::new(&shape.mesh, &Default::default(), &())?);
            let places = VertexPlaces::Symmetric(NearestPoints::new(rest.positions)?);
            Ok(PlacedShape { name: shape.name, surface, places })
        };
        Ok(Self { name: name.to_owned(), shapes: shapes.map(one).collect::<Result<_>>()? })
    }
}

/// The pairs of so many shapes that are mapped.
pub(super) fn pairs(n: usize) -> Vec<[usize; 2]> {
    match n {
        0..=FEW => (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j])).collect(),
        _ => (0..n).map(|i| [i, (i + 1) % n]).collect(),
    }
}

/// A shape of the collection with its vertices on the body at rest.
fn built_in(shape: &LabeledSurface, seed: u64) -> Result<PlacedShape<'_>> {
    let family = Family::all().into_iter().find(|family| family.name() == shape.label);
    let family = family.context("a built-in family")?;
    let pose = shape.name.strip_prefix(family.name()).and_then(|pose| pose.parse().ok()).context("a pose")?;
    let options = ArticulatedOptions { seed, n_vertices: shape.surface.mesh().n_vertices() };
    let rested = articulated_at_rest(family, 0, pose, &options, &())?;
    anyhow::ensure!(rested.shape.mesh == *shape.surface.mesh(), "the shape is generated again");
    let places = VertexPlaces::Symmetric(NearestPoints::new(rested.rest.positions)?);
    Ok(PlacedShape { name: shape.name.clone(), surface: Cow::Borrowed(&shape.surface), places })
}

/// A shape from a file. If its vertices are numbered as those of the first shape of its class, it gets triangles of its own, as
/// the same triangulation would help, and every new vertex the place of the nearest old one on the first shape.
fn from_file<'a>(shape: &'a LabeledSurface, first: &LabeledSurface, seed: u64) -> Result<PlacedShape<'a>> {
    let name = shape.name.clone();
    let [mesh, rest] = [shape, first].map(|shape| shape.surface.mesh());
    if !is_numbered_alike(mesh, rest) {
        let surface = Cow::Borrowed(&shape.surface);
        return Ok(PlacedShape { name, surface, places: VertexPlaces::Unknown });
    }
    let share = REMESHED as f64 / mesh.n_vertices() as f64;
    let own = Damage::Sample(share.min(1.0)).apply(mesh, seed);
    let surface = Surface::new(&own, &Default::default(), &())?;
    let originals = NearestPoints::new(mesh.positions.clone())?;
    let at = |p: &Point3<f64>| rest.positions[originals.nearest(p).0];
    let places = NearestPoints::new(surface.mesh().positions.iter().map(at).collect())?;
    Ok(PlacedShape { name, surface: Cow::Owned(surface), places: VertexPlaces::Known(places) })
}

/// Whether two meshes have equally many vertices and most of their edges between the same ones.
fn is_numbered_alike(a: &TriMesh, b: &TriMesh) -> bool {
    let edges = |mesh: &TriMesh| -> HashSet<[VertexId; 2]> {
        let sides = mesh.faces.iter().flat_map(|&[x, y, z]| [[x, y], [y, z], [z, x]]);
        sides.map(|[x, y]| [x.min(y), x.max(y)]).collect()
    };
    if a.n_vertices() != b.n_vertices() {
        return false;
    }
    let (a, b) = (edges(a), edges(b));
    a.intersection(&b).count() as f64 >= SAME_EDGES * a.len().max(b.len()) as f64
}

#[cfg(test)]
mod tests {
    use mesh::shapes;

    use super::*;

    #[test]
    fn meshes_with_few_flipped_edges_are_numbered_alike_and_others_are_not() {
        let grid = shapes::grid(21, 21, 0.1);
        let mut flipped = grid.clone();
        flipped.faces[0] = [0, 50, 100].map(VertexId);
        assert!(is_numbered_alike(&grid, &flipped));
        let n = grid.n_vertices();
        let faces = grid.faces.iter().map(|f| f.map(|v| VertexId::from((v.index() * 10) % n))).collect();
        assert!(!is_numbered_alike(&grid, &TriMesh { faces, ..grid.clone() }));
        assert!(!is_numbered_alike(&grid, &shapes::grid(21, 20, 0.1)));
    }

    #[test]
    fn places_give_partners_directly_and_mirrored() {
        let places = |points: [[f64; 3]; 2]| NearestPoints::new(points.map(Point3::from).into()).unwrap();
        let points = || places([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]);
        let symmetric = VertexPlaces::Symmetric(points());
        assert_eq!(symmetric.partner(0, &symmetric, MapKind::Direct), Some(0));
        assert_eq!(symmetric.partner(0, &symmetric, MapKind::Mirrored), Some(1));
        let known = VertexPlaces::Known(points());
        assert_eq!(known.partner(1, &known, MapKind::Direct), Some(1));
        assert_eq!(known.partner(1, &known, MapKind::Mirrored), None);
        assert_eq!(VertexPlaces::Unknown.partner(0, &known, MapKind::Direct), None);
    }

    #[test]
    fn few_shapes_are_mapped_in_all_pairs_and_many_in_a_ring() {
        assert_eq!((pairs(1), pairs(3)), (vec![], vec![[0, 1], [0, 2], [1, 2]]));
        assert_eq!((pairs(7).len(), pairs(8).len(), pairs(8)[7]), (21, 8, [7, 0]));
    }
}
