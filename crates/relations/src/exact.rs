//! Whether two meshes have the same vertices, after a motion, a reflection and a change of size.

use std::collections::HashSet;

use nalgebra::{Point3, Vector3};
use rigid::{NearestPoints, Similarity};
use surface::VertexId;

use super::calibration::FEW;
use super::geometry::MeshGeometry;

/// Most pairs of vertices that are tried as images of two vertices of the first mesh.
const MAX_PAIRS: usize = 2_000_000;

/// Most motions that are checked on all vertices.
const MAX_CHECKED: usize = 500;

/// A motion is found from two or three points, and moves others a few times as far as these are off. It is made precise
/// afterwards: half and twice as much change no answer about pieces.
pub(super) const LEVERAGE: f64 = 20.0;

/// Vertices of two meshes that coincide after a similarity.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SameVertices {
    /// Takes the first mesh onto the second, both at unit area, about their centroids.
    pub(super) map: Similarity,
    /// The largest distance between partners, relative to the size.
    pub(super) gap: f64,
    /// Whether the faces are the same too, apart from their orientation.
    pub(super) same_faces: bool,
}

/// The map that takes the vertices of `a` onto those of `b`, up to the rounding of files. One that maps faces to faces comes
/// first, then one without reflection.
pub(super) fn same_vertices(a: &MeshGeometry, b: &MeshGeometry) -> Option<SameVertices> {
    if a.n_vertices() != b.n_vertices() {
        return None;
    }
    let search = VertexSearch::new(a, b, a.rounding() + b.rounding())?;
    preferred([false, true].into_iter().filter_map(|reflected| search.run(reflected)))
}

/// The first map with the same faces, else the first one.
fn preferred(mut found: impl Iterator<Item = SameVertices>) -> Option<SameVertices> {
    let first = found.next()?;
    if first.same_faces {
        return Some(first);
    }
    Some(found.find(|other| other.same_faces).unwrap_or(first))
}

struct VertexSearch<'a> {
    geometries: [&'a MeshGeometry; 2],
    tolerance: f64,
    nearest: NearestPoints,
    faces: HashSet<[VertexId; 3]>,
    /// Two vertices of the first mesh, and the vertices of the second at the same distance from the centroid.
    base: [Point3<f64>; 2],
    images: [Vec<Point3<f64>>; 2],
    probes: Vec<Point3<f64>>,
}

impl<'a> VertexSearch<'a> {
    /// `None` if distances from the centroids differ.
    fn new(a: &'a MeshGeometry, b: &'a MeshGeometry, tolerance: f64) -> Option<Self> {
        let (p, q) = (&a.mesh().positions, &b.mesh().positions);
        // The centroid is off by rounding too.
        let slack = 2.0 * tolerance;
        let by_radius = |points: &[Point3<f64>]| {
            let mut radii: Vec<(f64, usize)> =
                points.iter().enumerate().map(|(i, p)| (p.coords.norm(), i)).collect();
            radii.sort_by(|x, y| x.0.total_cmp(&y.0));
            radii
        };
        let (radii_a, radii_b) = (by_radius(p), by_radius(q));
        if radii_a.iter().zip(&radii_b).any(|(x, y)| (x.0 - y.0).abs() > slack) {
            return None;
        }
        let at_radius = |r: f64| {
            let start = radii_b.partition_point(|x| x.0 < r - slack);
            let end = radii_b.partition_point(|x| x.0 <= r + slack);
            &radii_b[start..end]
        };
        // The vertices with the fewest images.
        let count = |i: usize| at_radius(p[i].coords.norm()).len();
        let rarest = |lever: &dyn Fn(usize) -> f64| {
            // Either of two vertices may move the farthest one by half of what is allowed.
            let least = 2.0 / LEVERAGE * (0..p.len()).map(lever).fold(0.0, f64::max);
            (0..p.len()).filter(|&i| lever(i) > least).min_by(|&i, &j| {
                let radius = |i: usize| p[i].coords.norm();
                count(i).cmp(&count(j)).then(radius(j).total_cmp(&radius(i))).then(i.cmp(&j))
            })
        };
        let first = rarest(&|i| p[i].coords.norm())?;
        let direction = p[first].coords.normalize();
        let second = rarest(&|i| p[i].coords.cross(&direction).norm())?;
        let images = [first, second].map(|i| {
            let mut found: Vec<usize> = at_radius(p[i].coords.norm()).iter().map(|&(_, j)| j).collect();
            // Most copies keep the order of vertices.
            found.sort_by_key(|&j| j != i);
            found.into_iter().map(|j| q[j]).collect::<Vec<_>>()
        });
        let step = (p.len() / FEW).max(1);
        Some(Self {
            geometries: [a, b],
            tolerance,
            nearest: NearestPoints::new(q.clone()).ok()?,
            faces: b.mesh().faces.iter().map(|face| VertexId::sorted(*face)).collect(),
            base: [p[first], p[second]],
            images,
            probes: p.iter().step_by(step).copied().collect(),
        })
    }

    /// The map with or without a reflection.
    fn run(&self, reflected: bool) -> Option<SameVertices> {
        let [p1, p2] = self.base;
        let apart = (p1 - p2).norm();
        let pairs = self.images[0].iter().flat_map(|q1| self.images[1].iter().map(move |q2| [*q1, *q2]));
        let is_apart = |[q1, q2]: &[Point3<f64>; 2]| ((q1 - q2).norm() - apart).abs() <= 4.0 * self.tolerance;
        let directions = |[p, q]: [Point3<f64>; 2]| Some([p.coords.try_normalize(0.0)?, q.coords]);
        let from = directions(self.base)?;
        let motion = |to| Similarity::between_frames(from, directions(to)?, reflected);
        let off = LEVERAGE * self.tolerance;
        let is_near = |motion: &Similarity| {
            self.probes.iter().all(|p| self.nearest.nearest(&motion.apply(p)).1 <= off * off)
        };
        let motions = pairs.take(MAX_PAIRS).filter(is_apart).filter_map(motion).filter(is_near);
        preferred(motions.take(MAX_CHECKED).filter_map(|motion| self.checked(motion, off)))
    }

    /// The vertices as partners under a motion that is off by at most `off`, which is made precise.
    fn checked(&self, rough: Similarity, off: f64) -> Option<SameVertices> {
        let [a, b] = self.geometries;
        let Fitted { map, gap, partners } = Fitted::new(&a.mesh().positions, &self.nearest, &rough, off)?;
        if gap > self.tolerance {
            return None;
        }
        let image =
            |face: &[VertexId; 3]| VertexId::sorted(face.map(|v| VertexId::from(partners[v.index()])));
        let same_faces =
            a.n_faces() == b.n_faces() && a.mesh().faces.iter().all(|face| self.faces.contains(&image(face)));
        let map = Similarity { translation: Vector3::zeros(), ..map };
        Some(SameVertices { map, gap, same_faces })
    }
}

/// Points that lie nearly on others, each on one of its own.
pub(super) struct Fitted {
    /// The map that takes them there best.
    pub(super) map: Similarity,
    /// How far they stay apart at most.
    pub(super) gap: f64,
    partners: Vec<usize>,
}

impl Fitted {
    /// Of the points that are nearest under a rough map. `None` if one is farther than `off`, or the nearest one of two.
    pub(super) fn new(
        points: &[Point3<f64>],
        others: &NearestPoints,
        rough: &Similarity,
        off: f64,
    ) -> Option<Self> {
        let mut is_taken = vec![false; others.points().len()];
        let partner = |p: &Point3<f64>| {
            let (i, sq) = others.nearest(&rough.apply(p));
            (sq <= off * off && !std::mem::replace(&mut is_taken[i], true)).then_some(i)
        };
        let partners: Vec<usize> = points.iter().map(partner).collect::<Option<_>>()?;
        let pairs: Vec<_> = points.iter().zip(&partners).map(|(p, &i)| (*p, others.points()[i])).collect();
        let map = Similarity::fit_scaled(&pairs, rough.reflected)?;
        let gap = pairs.iter().map(|(p, q)| (map.apply(p) - q).norm()).fold(0.0, f64::max);
        Some(Self { map, gap, partners })
    }
}

#[cfg(test)]
mod tests {
    use mesh::{TriMesh, shapes};
    use nalgebra::Rotation3;

    use super::*;
    use mesh::shapes::lopsided_torus;

    /// The mesh moved, with vertices and faces in another order, and rounded as files do.
    fn moved(mesh: &TriMesh, scale: f64, flip: f64) -> TriMesh {
        let turn = Rotation3::from_euler_angles(0.3, 2.0, -1.0);
        let motion = |p: &Point3<f64>| {
            let p = turn * Point3::new(flip * p.x, p.y, p.z) * scale + Vector3::new(1.0, 2.0, 3.0);
            p.map(|x| f64::from(x as f32))
        };
        testkit::renumbered(&testkit::moved(mesh, motion))
    }

    fn found(a: &TriMesh, b: &TriMesh) -> Option<SameVertices> {
        let [a, b] = [a, b].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
        same_vertices(&a, &b)
    }

    #[test]
    fn moved_and_reordered_vertices_are_found_again() {
        let rod = shapes::cylinder(12, 8, 0.01, 10.0);
        let symmetric = [shapes::icosphere(3), shapes::cube(4), shapes::tetrahedron(2), rod];
        for mesh in symmetric.iter().chain([&lopsided_torus()]) {
            let same = found(mesh, &moved(mesh, 25.4, 1.0)).unwrap();
            assert!(same.same_faces && !same.map.reflected && same.gap < 1e-6, "{same:?}");
            assert!((same.map.scale - 1.0).abs() < 1e-6, "at unit area: {}", same.map.scale);
        }
        let mirrored = found(&lopsided_torus(), &moved(&lopsided_torus(), 1.0, -1.0)).unwrap();
        assert!(mirrored.same_faces && mirrored.map.reflected);
        assert!(mirrored.map.rotation.determinant() < 0.0);
    }

    #[test]
    fn other_vertices_and_other_faces_are_told_apart() {
        let mesh = lopsided_torus();
        let mut nudged = mesh.clone();
        nudged.positions[77].x += 0.01;
        assert_eq!(found(&mesh, &nudged), None);
        // Two triangles of a square with the other diagonal.
        let mut flipped = shapes::grid(4, 5, 1.0);
        let whole = flipped.clone();
        let [first, second] = [whole.faces[0], whole.faces[1]];
        let shared: Vec<_> = first.into_iter().filter(|v| second.contains(v)).collect();
        let apart = |face: [VertexId; 3]| face.into_iter().find(|v| !shared.contains(v)).unwrap();
        for (i, end) in shared.iter().enumerate() {
            flipped.faces[i] = [apart(first), *end, apart(second)];
        }
        let same = found(&whole, &flipped).unwrap();
        assert!(!same.same_faces && same.gap < 1e-9);
        assert_eq!(found(&mesh, &shapes::icosphere(3)), None);
    }
}
