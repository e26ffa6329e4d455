//! The geometry of a mesh file in space, prepared to be compared with that of others.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::OnceLock;

use base::ContentHash;
use mesh::{TriMesh, coordinate_spacing, is_noisy};
use nalgebra::Point3;
use rigid::{NearestPoints, RigidSurface, align_surfaces};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use surface::{Components, EdgeId, VertexId, components_of_faces};

use super::calibration::{EXACT, FARTHEST, FEW, MAX_NOISE};

/// How coarsely files round coordinates, relative to the largest coordinate: text with six digits, twice. Numbers of 32 bits
/// are finer. A tolerance of rounding.
pub(super) const ROUNDING: f64 = 1e-5;

/// Text is not taken to round vertices by more than this, relative to the size, wherever the mesh lies. Sizes and places of one geometry
/// are equal up to this share.
pub(super) const MAX_ROUNDING: f64 = 10.0 * ROUNDING;

/// Rounding and other triangles change the sizes of two meshes by at most this multiple of how far their vertices or surfaces are apart, or
/// by [`ROUNDING`], which may be the same for all vertices.
pub(super) const SIZE_BY_DISTANCE: f64 = 10.0;

/// Most components that are compared on their own, the largest by area.
const MAX_COMPONENTS: usize = 200;

/// Most faces at whose corners two meshes are compared. A limit of effort.
const MAX_FACES: usize = 2000;

/// The least share of the whole area of a component that is compared on its own. A safety limit: it saves time.
const MIN_COMPONENT: f64 = 1e-3;

/// All triangles of a mesh file in space: every component, before any repair but the merging of vertices in the same
/// position. It is kept at unit area, centered at the centroid of the surface.
///
/// ```
/// use canonform_relations::MeshGeometry;
/// use mesh::shapes;
///
/// let mut cube = shapes::cube(1);
/// cube.positions.iter_mut().for_each(|p| p.x += 3.0);
/// let plate = shapes::disjoint(&[shapes::icosphere(2), cube]);
/// let geometry = MeshGeometry::new(&plate, None).unwrap();
/// assert_eq!((geometry.n_vertices(), geometry.n_components()), (plate.n_vertices(), 2));
/// ```
#[derive(Debug)]
pub struct MeshGeometry {
    /// Hash of the file.
    pub(super) content: Option<ContentHash>,
    /// Without degenerate and duplicate faces and unused vertices.
    pub(super) surface: RigidSurface,
    /// How far the file may have rounded vertices, in mesh units.
    rounding: f64,
    components: Components,
    closed: OnceLock<Option<(f64, isize)>>,
    rim: OnceLock<BTreeSet<VertexId>>,
    noisy: OnceLock<bool>,
    pub(super) noise: OnceLock<Option<f64>>,
    pub(super) exactness: OnceLock<Exactness>,
    parts: OnceLock<Vec<MeshGeometry>>,
}

/// What tells how exactly a mesh states a surface, beside its noise.
#[derive(Debug)]
pub(super) struct Exactness {
    /// Vertices without which the surface would be another one.
    pub(super) n_needed: usize,
    /// Angles by which normals turn at edges, times their lengths, summed, at unit area. Other triangles of a surface hardly change
    /// it, and noise increases it.
    pub(super) bending: f64,
}

/// What a geometry is sent as: all that is not found from it.
#[derive(Serialize, Deserialize)]
struct Record {
    content: Option<ContentHash>,
    positions: Vec<[f64; 3]>,
    faces: Vec<[VertexId; 3]>,
    size: f64,
    center: [f64; 3],
    axis_std: [f64; 3],
    rounding: f64,
}

impl Serialize for MeshGeometry {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        let Self { content, surface, rounding, .. } = self;
        let record = Record {
            content: *content,
            positions: surface.mesh().positions.iter().map(|p| (*p).into()).collect(),
            faces: surface.mesh().faces.clone(),
            size: surface.size,
            center: surface.center.into(),
            axis_std: surface.axis_std,
            rounding: *rounding,
        };
        record.serialize(out)
    }
}

impl<'de> Deserialize<'de> for MeshGeometry {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let Record { content, positions, faces, size, center, axis_std, rounding } =
            Record::deserialize(from)?;
        if faces.iter().flatten().any(|v| v.index() >= positions.len()) {
            return Err(D::Error::custom("a face has a vertex that is not there"));
        }
        let mesh = TriMesh { positions: positions.into_iter().map(Point3::from).collect(), faces };
        let surface = RigidSurface::from_parts(mesh, size, center.into(), axis_std);
        Ok(Self { content, ..Self::from_surface(surface, rounding) })
    }
}

impl MeshGeometry {
    /// The geometry of a mesh, exactly as its file states it; `content` is the hash of the file, if there is one. `None` for
    /// a mesh without area, or with coordinates that are not finite.
    pub fn new(mesh: &TriMesh, content: Option<ContentHash>) -> Option<Self> {
        let farthest = mesh.positions.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
        let size = Some(mesh.root_of_area()).filter(|_| farthest.is_finite())?;
        let (spacing, _) = coordinate_spacing(mesh.positions.iter());
        let rounding = (ROUNDING * farthest).min(MAX_ROUNDING * size).max(spacing.min(MAX_NOISE * size));
        let surface = RigidSurface::new(welded(mesh, rounding))?;
        Some(Self { content, ..Self::from_surface(surface, rounding) })
    }

    fn from_surface(surface: RigidSurface, rounding: f64) -> Self {
        let components = components_of_faces(surface.mesh().n_vertices(), &surface.mesh().faces);
        let (closed, rim, noisy, noise, exactness, parts) = Default::default();
        Self { content: None, surface, rounding, components, closed, rim, noisy, noise, exactness, parts }
    }

    /// How far vertices may be apart because files round them, relative to the size.
    pub(super) fn rounding(&self) -> f64 {
        self.rounding / self.size()
    }

    /// The mesh at unit area, about its centroid.
    pub(super) fn mesh(&self) -> &TriMesh {
        self.surface.mesh()
    }

    /// Number of vertices in different positions.
    pub fn n_vertices(&self) -> usize {
        self.mesh().n_vertices()
    }

    /// Number of faces, without degenerate and duplicate ones.
    pub fn n_faces(&self) -> usize {
        self.mesh().n_faces()
    }

    /// Evenly chosen faces.
    pub(super) fn some_faces(&self) -> impl Iterator<Item = usize> + Clone {
        (0..self.n_faces()).step_by(self.n_faces().div_ceil(MAX_FACES))
    }

    /// Number of connected components.
    pub fn n_components(&self) -> usize {
        self.components.count
    }

    /// The square root of the area, in mesh units.
    pub fn size(&self) -> f64 {
        self.surface.size
    }

    /// The mesh in its own units and place, without repeated positions, degenerate and duplicate faces and unused vertices.
    pub fn to_mesh(&self) -> TriMesh {
        let place = |p: &Point3<f64>| self.surface.center + p.coords * self.size();
        TriMesh {
            positions: self.mesh().positions.iter().map(place).collect(),
            faces: self.mesh().faces.clone(),
        }
    }

    /// Approximate size in memory.
    pub fn n_bytes(&self) -> usize {
        // With the tree, the samples and the components, which are made when they are needed.
        100 * self.n_vertices() + 250 * self.n_faces()
    }

    /// The enclosed volume at unit area, and the Euler characteristic; `None` unless every edge has two faces.
    pub(super) fn closed(&self) -> Option<(f64, isize)> {
        *self.closed.get_or_init(|| {
            let topology = self.mesh().topology();
            let [n_vertices, n_edges, n_faces] =
                [topology.n_vertices(), topology.n_edges(), topology.n_faces()].map(|n| n as isize);
            let mut edges = (0..topology.n_edges()).map(EdgeId::from);
            let is_closed = edges.all(|edge| topology.edge_corners(edge).len() == 2);
            is_closed.then(|| (self.mesh().signed_volume().abs(), n_vertices - n_edges + n_faces))
        })
    }

    /// The vertices on edges of one face.
    pub(super) fn rim(&self) -> &BTreeSet<VertexId> {
        self.rim.get_or_init(|| rim(self.mesh()))
    }

    /// Whether planes and cylinders with sharp edges between them make up the surface, as in parts of machines.
    pub(super) fn is_mechanical(&self) -> bool {
        self.surface.is_mechanical()
    }

    /// Whether it is mechanical without noise, which breaks planes and cylinders up: holes and steps of a noisy part are not those that
    /// it has.
    pub(super) fn is_exact_part(&self) -> bool {
        self.is_mechanical() && !self.has_noisy_planes()
    }

    /// Whether vertices have noise that is independent of their neighbors'.
    pub(super) fn is_noisy(&self) -> bool {
        *self.noisy.get_or_init(|| is_noisy(self.mesh()))
    }

    /// Whether its planes have noise, so that it may be a copy of a part without being one by its own edges and planes.
    pub fn has_noisy_planes(&self) -> bool {
        self.noise().is_some_and(|noise| noise >= EXACT / FARTHEST)
    }

    /// How far two surfaces are apart in space, root mean square, relative to the size, after the best motion, reflection and change of
    /// size; `None` if noise does not explain it.
    pub fn noise_beside(&self, other: &Self) -> Option<f64> {
        let gap = align_surfaces(&self.surface, &other.surface)?.gap.rms;
        (gap < MAX_NOISE).then_some(gap)
    }

    /// The components with enough area as geometries of their own, largest first; none if there is only one.
    pub(super) fn parts(&self) -> &[Self] {
        self.parts.get_or_init(|| {
            if self.n_components() < 2 {
                return Vec::new();
            }
            let mut faces = vec![Vec::new(); self.n_components()];
            let mut areas = vec![0.0; faces.len()];
            for (face, area) in self.mesh().faces.iter().zip(self.mesh().face_areas()) {
                let Some(component) = self.components.of(face[0]) else { continue };
                faces[component].push(*face);
                areas[component] += area;
            }
            let mut order: Vec<usize> = (0..areas.len()).filter(|&i| areas[i] >= MIN_COMPONENT).collect();
            order.sort_by(|&i, &j| areas[j].total_cmp(&areas[i]).then(i.cmp(&j)));
            let mut whole = self.to_mesh();
            let part = |&i: &usize| {
                whole.faces = std::mem::take(&mut faces[i]);
                let surface = RigidSurface::new(whole.without_unused_vertices())?;
                Some(Self::from_surface(surface, self.rounding))
            };
            order.iter().take(MAX_COMPONENTS).filter_map(part).collect()
        })
    }
}

/// The mesh without repeated positions, cracks as wide as rounding, degenerate and duplicate faces and unused vertices. Vertices stay
/// in order.
fn welded(mesh: &TriMesh, rounding: f64) -> TriMesh {
    let mut first = HashMap::with_capacity(mesh.n_vertices());
    // Minus zero equals zero.
    let place = |p: &Point3<f64>| [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
    let mut same = |(v, p)| *first.entry(place(p)).or_insert(VertexId::from(v));
    let mesh = merged(mesh, &mesh.positions.iter().enumerate().map(&mut same).collect::<Vec<_>>());
    let rim: Vec<VertexId> = rim(&mesh).into_iter().collect();
    let at = |v: &VertexId| mesh.positions[v.index()];
    let Ok(nearest) = NearestPoints::new(rim.iter().map(at).collect()) else { return mesh };
    let mut into: Vec<VertexId> = (0..mesh.n_vertices()).map(VertexId::from).collect();
    for v in &rim {
        let near = nearest.near(&at(v), rounding, FEW).into_iter().map(|i| into[rim[i].index()]);
        into[v.index()] = near.min().unwrap_or(*v);
    }
    merged(&mesh, &into)
}

/// The vertices on edges of one face.
fn rim(mesh: &TriMesh) -> BTreeSet<VertexId> {
    let topology = mesh.topology();
    topology.boundary_edges().flat_map(|edge| topology.edges()[edge.index()]).collect()
}

/// The mesh with every vertex in the place of another one.
fn merged(mesh: &TriMesh, into: &[VertexId]) -> TriMesh {
    let faces = mesh.faces.iter().map(|face| face.map(|v| into[v.index()]));
    let mut faces: Vec<_> = faces.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    let mut seen = HashSet::with_capacity(faces.len());
    faces.retain(|face| seen.insert(VertexId::sorted(*face)));
    TriMesh { positions: mesh.positions.clone(), faces }.without_unused_vertices()
}

#[cfg(test)]
mod tests {
    use mesh::shapes;

    use super::*;

    #[test]
    fn a_soup_of_triangles_is_the_same_geometry_also_with_cracks() {
        let ball = shapes::icosphere(2);
        for crack in [0.0, 1e-6] {
            let mut soup = testkit::soup(&ball);
            soup.positions.iter_mut().enumerate().for_each(|(i, p)| p.x += crack * (i as f64).sin());
            let [a, b] = [&ball, &soup].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
            assert_eq!((a.n_vertices(), a.n_faces()), (b.n_vertices(), b.n_faces()));
            assert!((a.size() - b.size()).abs() < 1e-5);
        }
        assert!(MeshGeometry::new(&TriMesh::default(), None).is_none());
    }

    #[test]
    fn components_are_geometries_of_their_own() {
        let mut apart = [shapes::cube(1), shapes::icosphere(2), shapes::cube(1)];
        for (i, mesh) in apart.iter_mut().enumerate() {
            mesh.positions.iter_mut().for_each(|p| p.x += 5.0 * i as f64);
        }
        let geometry = MeshGeometry::new(&shapes::disjoint(&apart), None).unwrap();
        let parts = geometry.parts();
        assert_eq!((geometry.n_components(), parts.len()), (3, 3));
        assert_eq!(parts[0].n_vertices(), shapes::icosphere(2).n_vertices(), "the largest area first");
        assert!((parts[1].size() / shapes::cube(1).root_of_area() - 1.0).abs() < 1e-9);
        assert!(parts[0].parts().is_empty());
    }
}
