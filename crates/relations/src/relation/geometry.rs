//! The geometry of a mesh file in space, prepared to be compared with that of others.

use std::collections::HashMap;
use std::sync::OnceLock;

use base::ContentHash;
use descriptors::{CanonicalForm, PreparedForm};
use mesh::{SmoothRegions, TriMesh, is_noisy};
use nalgebra::Point3;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use surface::{Components, VertexId, components_of_faces};

use super::triangles::TriangleTree;

/// Points of a surface that look for their nearest points when two surfaces are aligned.
const SAMPLES: usize = 2000;

/// How coarsely files round coordinates, relative to the largest coordinate: text with six digits, twice. Numbers of 32 bits
/// are finer. A tolerance of rounding.
const ROUNDING: f64 = 1e-5;

/// Vertices of one geometry are never farther apart than this, relative to the size, wherever the mesh lies. A safety limit.
const MOST_ROUNDING: f64 = 1e-4;

/// Most components that are compared on their own, the largest by area.
const MOST_COMPONENTS: usize = 200;

/// The least share of the whole area of a component that is compared on its own. A safety limit: it saves time.
const LEAST_COMPONENT: f64 = 1e-3;

/// All triangles of a mesh file in space: every component, before any repair but the merging of vertices in the same
/// position. It is kept at unit area, centred at the centroid of the surface.
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
    pub(super) mesh: TriMesh,
    /// The square root of the area, in mesh units.
    pub(super) size: f64,
    /// The centroid of the surface, in mesh units.
    pub(super) centre: Point3<f64>,
    /// How far vertices may be apart because files round them, relative to the size.
    pub(super) rounding: f64,
    /// Root mean square distance of the surface from its centroid along its principal axes, descending.
    pub(super) spreads: [f64; 3],
    /// The largest coordinate in the file, in mesh units.
    farthest: f64,
    components: Components,
    samples: OnceLock<Vec<Point3<f64>>>,
    tree: OnceLock<TriangleTree>,
    form: OnceLock<Option<PreparedForm>>,
    noisy: OnceLock<bool>,
    regions: OnceLock<SmoothRegions>,
    parts: OnceLock<Vec<MeshGeometry>>,
}

/// What a geometry is sent as: all that is not found from it.
#[derive(Serialize, Deserialize)]
struct Record {
    content: Option<ContentHash>,
    positions: Vec<[f64; 3]>,
    faces: Vec<[VertexId; 3]>,
    size: f64,
    centre: [f64; 3],
    rounding: f64,
    spreads: [f64; 3],
    farthest: f64,
}

impl Serialize for MeshGeometry {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        let Self { content, mesh, size, centre, rounding, spreads, farthest, .. } = self;
        let record = Record {
            content: *content,
            positions: mesh.positions.iter().map(|p| (*p).into()).collect(),
            faces: mesh.faces.clone(),
            size: *size,
            centre: (*centre).into(),
            rounding: *rounding,
            spreads: *spreads,
            farthest: *farthest,
        };
        record.serialize(out)
    }
}

impl<'de> Deserialize<'de> for MeshGeometry {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let Record { content, positions, faces, size, centre, rounding, spreads, farthest } =
            Record::deserialize(from)?;
        if faces.iter().flatten().any(|v| v.index() >= positions.len()) {
            return Err(D::Error::custom("a face has a vertex that is not there"));
        }
        let mesh = TriMesh { positions: positions.into_iter().map(Point3::from).collect(), faces };
        Ok(Self { content, ..Self::of_parts(mesh, size, centre.into(), rounding, spreads, farthest) })
    }
}

impl MeshGeometry {
    /// The geometry of a mesh, exactly as its file states it; `content` is the hash of the file, if there is one. `None` for
    /// a mesh without area, or with coordinates that are not finite.
    #[must_use]
    pub fn new(mesh: &TriMesh, content: Option<ContentHash>) -> Option<Self> {
        let farthest = mesh.positions.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
        Some(Self { content, ..Self::of_welded(welded(mesh), farthest)? })
    }

    fn of_welded(mut mesh: TriMesh, farthest: f64) -> Option<Self> {
        let size = mesh.root_of_area();
        if !(size > 0.0 && size.is_finite() && farthest.is_finite()) {
            return None;
        }
        let origin = mesh.bounds()?[0];
        mesh.positions.iter_mut().for_each(|p| *p = Point3::from((*p - origin) / size));
        let (centroid, covariance) = mesh.moments();
        mesh.positions.iter_mut().for_each(|p| *p -= centroid);
        let mut spreads: [f64; 3] = covariance.symmetric_eigenvalues().map(|x| x.max(0.0).sqrt()).into();
        spreads.sort_by(|a, b| b.total_cmp(a));
        let rounding = (ROUNDING * farthest / size).min(MOST_ROUNDING);
        Some(Self::of_parts(mesh, size, origin + centroid * size, rounding, spreads, farthest))
    }

    fn of_parts(
        mesh: TriMesh,
        size: f64,
        centre: Point3<f64>,
        rounding: f64,
        spreads: [f64; 3],
        farthest: f64,
    ) -> Self {
        Self {
            content: None,
            size,
            centre,
            rounding,
            spreads,
            farthest,
            components: components_of_faces(mesh.n_vertices(), &mesh.faces),
            mesh,
            samples: OnceLock::new(),
            tree: OnceLock::new(),
            form: OnceLock::new(),
            noisy: OnceLock::new(),
            regions: OnceLock::new(),
            parts: OnceLock::new(),
        }
    }

    /// Number of vertices in different positions.
    #[must_use]
    pub fn n_vertices(&self) -> usize {
        self.mesh.n_vertices()
    }

    /// Number of faces, without degenerate and duplicate ones.
    #[must_use]
    pub fn n_faces(&self) -> usize {
        self.mesh.n_faces()
    }

    /// Number of connected components.
    #[must_use]
    pub fn n_components(&self) -> usize {
        self.components.count
    }

    /// The square root of the area, in mesh units.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The mesh in its own units and place, without repeated positions, degenerate and duplicate faces and unused vertices.
    #[must_use]
    pub fn to_mesh(&self) -> TriMesh {
        let positions = self.mesh.positions.iter().map(|p| self.centre + p.coords * self.size).collect();
        TriMesh { positions, faces: self.mesh.faces.clone() }
    }

    /// Approximate size in memory.
    #[must_use]
    pub fn n_bytes(&self) -> usize {
        // With the tree, the samples and the components, which are made when they are needed.
        100 * self.n_vertices() + 250 * self.n_faces()
    }

    /// Evenly spread points of the surface.
    pub(super) fn samples(&self) -> &[Point3<f64>] {
        self.samples.get_or_init(|| sampled(&self.mesh, SAMPLES))
    }

    pub(super) fn tree(&self) -> &TriangleTree {
        self.tree.get_or_init(|| TriangleTree::new(&self.mesh))
    }

    /// Root mean square distance of the surface from its centroid, relative to the size. Noise changes it less than the size.
    pub(super) fn spread(&self) -> f64 {
        self.spreads.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// The samples as a form of unit spread, ready to be aligned.
    pub(super) fn form(&self) -> Option<&PreparedForm> {
        let prepare = || {
            let points: Vec<_> = self.samples().iter().map(|p| p / self.spread()).collect();
            let weights = vec![1.0 / points.len() as f64; points.len()];
            PreparedForm::new(&CanonicalForm::from_parts(points, weights, Some(1.0)).ok()?).ok()
        };
        self.form.get_or_init(prepare).as_ref()
    }

    /// The smooth pieces between sharp edges.
    pub(super) fn regions(&self) -> &SmoothRegions {
        self.regions.get_or_init(|| SmoothRegions::of(&self.mesh))
    }

    /// Whether planes and cylinders with sharp edges between them make up the surface, as in parts of machines.
    pub(super) fn is_mechanical(&self) -> bool {
        self.regions().is_mechanical
    }

    /// Whether vertices have noise that is independent of their neighbours'.
    pub(super) fn is_noisy(&self) -> bool {
        *self.noisy.get_or_init(|| is_noisy(&self.mesh))
    }

    /// The components with enough area as geometries of their own, largest first; none if there is only one.
    pub(super) fn parts(&self) -> &[Self] {
        self.parts.get_or_init(|| {
            if self.n_components() < 2 {
                return Vec::new();
            }
            let mut parts = vec![TriMesh::default(); self.n_components()];
            let mut number = Vec::with_capacity(self.n_vertices());
            for (v, p) in self.mesh.positions.iter().enumerate() {
                // No face has the number of a vertex without faces.
                let component = self.components.of(VertexId::from(v));
                let Some(part) = component.map(|component| &mut parts[component]) else {
                    number.push(VertexId(u32::MAX));
                    continue;
                };
                number.push(VertexId::from(part.n_vertices()));
                part.positions.push(self.centre + p.coords * self.size);
            }
            let mut areas = vec![0.0; parts.len()];
            for (face, area) in self.mesh.faces.iter().zip(self.mesh.face_areas()) {
                let Some(label) = self.components.of(face[0]) else { continue };
                parts[label].faces.push(face.map(|v| number[v.index()]));
                areas[label] += area;
            }
            let mut order: Vec<usize> = (0..areas.len()).filter(|&i| areas[i] >= LEAST_COMPONENT).collect();
            order.sort_by(|&i, &j| areas[j].total_cmp(&areas[i]).then(i.cmp(&j)));
            let part = |&i: &usize| Self::of_welded(std::mem::take(&mut parts[i]), self.farthest);
            order.iter().take(MOST_COMPONENTS).filter_map(part).collect()
        })
    }
}

/// The mesh without repeated positions, degenerate and duplicate faces and unused vertices. Vertices stay in order.
fn welded(mesh: &TriMesh) -> TriMesh {
    let mut first = HashMap::with_capacity(mesh.n_vertices());
    let merged: Vec<VertexId> = mesh
        .positions
        .iter()
        .enumerate()
        // Minus zero equals zero.
        .map(|(v, p)| *first.entry([p.x, p.y, p.z].map(|x| (x + 0.0).to_bits())).or_insert(VertexId::from(v)))
        .collect();
    let faces = mesh.faces.iter().map(|face| face.map(|v| merged[v.index()]));
    let mut faces: Vec<_> = faces.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    let mut seen = std::collections::HashSet::with_capacity(faces.len());
    faces.retain(|face| seen.insert(sorted(*face)));
    TriMesh { positions: mesh.positions.clone(), faces }.without_unused_vertices()
}

/// The vertices of a face in ascending order.
pub(super) fn sorted(mut face: [VertexId; 3]) -> [VertexId; 3] {
    face.sort_unstable();
    face
}

/// Points of a surface, one in each of `n` pieces of equal area.
fn sampled(mesh: &TriMesh, n: usize) -> Vec<Point3<f64>> {
    // Steps of a sequence whose leading points fill a square evenly (Roberts' generalised golden ratio).
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let total: f64 = mesh.face_areas().sum();
    let mut points = Vec::with_capacity(n);
    let mut sum = 0.0;
    for (f, area) in mesh.face_areas().enumerate() {
        sum += area / total;
        while points.len() < n && (points.len() as f64 + 0.5) / (n as f64) < sum {
            let [mut u, mut v] = STEPS.map(|step| (0.5 + step * points.len() as f64).fract());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let [a, b, c] = mesh.triangle(f);
            points.push(a + (b - a) * u + (c - a) * v);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use mesh::shapes;
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn a_soup_of_triangles_is_the_same_geometry() {
        let ball = shapes::icosphere(2);
        let soup = TriMesh {
            positions: (0..ball.n_faces()).flat_map(|f| ball.triangle(f)).collect(),
            faces: (0..ball.n_faces()).map(|f| [0, 1, 2].map(|i| VertexId::from(3 * f + i))).collect(),
        };
        let [a, b] = [&ball, &soup].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
        assert_eq!((a.n_vertices(), a.n_faces()), (b.n_vertices(), b.n_faces()));
        assert!((a.size - b.size).abs() < 1e-12);
        assert!(MeshGeometry::new(&TriMesh::default(), None).is_none());
    }

    #[test]
    fn geometries_are_centred_at_unit_area() {
        let mut torus = shapes::torus(40, 20, 2.0, 0.7);
        torus.positions.iter_mut().for_each(|p| *p = *p * 25.4 + Vector3::new(300.0, -7.0, 20.0));
        let geometry = MeshGeometry::new(&torus, None).unwrap();
        assert!((geometry.mesh.area() - 1.0).abs() < 1e-12);
        assert!((geometry.centre - Point3::new(300.0, -7.0, 20.0)).norm() < 1e-9);
        assert!(geometry.mesh.moments().0.norm() < 1e-12);
        let samples = geometry.samples();
        assert_eq!(samples.len(), SAMPLES);
        let mean = samples.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords) / SAMPLES as f64;
        assert!(mean.norm() < 0.01, "{mean}");
        assert!(samples.iter().all(|p| geometry.tree().nearest(p).unwrap().sq_distance < 1e-24));
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
        assert!((parts[1].size / shapes::cube(1).root_of_area() - 1.0).abs() < 1e-9);
        assert!(parts[0].parts().is_empty());
    }
}
