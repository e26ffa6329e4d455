//! Noise on mechanical parts, by the planes that they have.

use std::collections::VecDeque;

use mesh::TriMesh;
use nalgebra::{Matrix3, Point3, Vector3};
use surface::{FaceId, Topology};

use super::geometry::{MAX_ROUNDING, MeshGeometry};

/// How often the tolerance of planes doubles, from that of rounding. Noise of up to a fifth of the last one is measured; beyond, parts of
/// curved surfaces look flat.
const DOUBLINGS: i32 = 7;

/// The farthest vertex of a plane is nearer than this share of the tolerance: a curved surface ends where the tolerance does. Of 10,000
/// vertices with normal noise, none is as far as 4.5 times its root mean square.
const MAX_GAP: f64 = 0.75;

/// Faces of a plane, and faces that lie on each other, turn by less than this (cosine), also with noise, and most of the boundary of a
/// plane is an edge that turns by more. As at sharp edges of parts, 40°.
pub(super) const MIN_COSINE: f64 = 0.766;

/// The least share of the area that planes of a part have, the two ends of a shaft for example, and the least that each of them has: as
/// much of that share.
const MIN_PLANES: f64 = 0.05;
const MIN_PLANE: f64 = MIN_PLANES * MIN_PLANES;

/// A plane through vertices, in least squares.
#[derive(Default)]
struct Fit {
    n: f64,
    sum: Vector3<f64>,
    squares: Matrix3<f64>,
}

impl Fit {
    fn add(&mut self, p: &Point3<f64>) {
        self.n += 1.0;
        self.sum += p.coords;
        self.squares += p.coords * p.coords.transpose();
    }

    /// A point and the normal.
    fn plane(&self) -> (Point3<f64>, Vector3<f64>) {
        let center = self.sum / self.n;
        let eigen = (self.squares / self.n - center * center.transpose()).symmetric_eigen();
        (center.into(), eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned())
    }
}

/// The noise of two parts. At least one must be mechanical as it is: what else has planes within a tolerance may be a body.
pub(super) fn noise_of_parts(meshes: [&MeshGeometry; 2]) -> Option<[f64; 2]> {
    let noise = |mesh: &MeshGeometry| mesh.noise().or(mesh.is_mechanical().then_some(0.0));
    let [a, b] = meshes;
    if !(a.is_mechanical() || b.is_mechanical()) {
        return None;
    }
    Some([noise(a)?, noise(b)?])
}

impl MeshGeometry {
    /// How far vertices are from the planes of a mechanical part, root mean square, relative to the size; `None` if planes are no
    /// considerable part of the surface.
    pub(super) fn noise(&self) -> Option<f64> {
        *self.noise.get_or_init(|| {
            let mesh = self.mesh();
            let topology = mesh.topology();
            let vectors: Vec<Vector3<f64>> = (0..mesh.n_faces()).map(|f| mesh.area_vector(f)).collect();
            let mut order: Vec<usize> = (0..vectors.len()).collect();
            order.sort_by(|&f, &g| {
                vectors[g].norm_squared().total_cmp(&vectors[f].norm_squared()).then(f.cmp(&g))
            });
            let (mut planes, mut most) = (Vec::new(), MIN_PLANES);
            for tolerance in (0..=DOUBLINGS).map(|i| MAX_ROUNDING * 2f64.powi(i)) {
                let [area, squares] = Planes::new(mesh, &topology, &vectors, tolerance).grow_from(&order);
                most = f64::max(most, area);
                planes.push([area, squares]);
                // A few vertices may lie in a plane by chance.
                planes.retain(|[area, _]| *area >= 0.5 * most && *area >= MIN_PLANES);
                // No tolerance finds planes with twice as much of the area.
                if planes.first().is_some_and(|[area, _]| *area >= 0.5) {
                    break;
                }
            }
            planes.first().map(|[area, squares]| (squares / area).sqrt())
        })
    }
}

/// Planes within a tolerance, which grow one after the other.
struct Planes<'a> {
    mesh: &'a TriMesh,
    topology: &'a Topology,
    /// The area vectors of the faces.
    vectors: &'a [Vector3<f64>],
    tolerance: f64,
    /// Whether a face is in a plane.
    is_taken: Vec<bool>,
    /// The seed of the last plane that reached a face, and that has a vertex.
    reached: Vec<usize>,
    seen: Vec<usize>,
}

/// What grew from a face.
#[derive(Default)]
struct Grown {
    fit: Fit,
    vertices: Vec<usize>,
    area: f64,
    /// Whether it met another one: then it is a curved surface.
    meets_another: bool,
    /// Lengths of the boundary at blunt and at sharp edges.
    boundary: [f64; 2],
}

impl<'a> Planes<'a> {
    fn new(mesh: &'a TriMesh, topology: &'a Topology, vectors: &'a [Vector3<f64>], tolerance: f64) -> Self {
        let (n, p) = (vectors.len(), mesh.n_vertices());
        let (reached, seen) = (vec![usize::MAX; n], vec![usize::MAX; p]);
        Self { mesh, topology, vectors, tolerance, is_taken: vec![false; n], reached, seen }
    }

    /// The area of the planes that grow from faces in this order, and the squared distances of vertices from them, times the areas.
    fn grow_from(mut self, order: &[usize]) -> [f64; 2] {
        let (mut area, mut squares) = (0.0, 0.0);
        for &seed in order {
            if self.is_taken[seed] || self.vectors[seed].norm_squared() == 0.0 {
                continue;
            }
            let Grown { fit, vertices, area: own, meets_another, boundary } = self.grown(seed);
            if meets_another || boundary[0] > boundary[1] || own < MIN_PLANE || vertices.len() < 4 {
                continue;
            }
            let (center, normal) = fit.plane();
            let gaps = || vertices.iter().map(|&v| normal.dot(&(self.mesh.positions[v] - center)));
            if gaps().all(|gap| gap.abs() < MAX_GAP * self.tolerance) {
                area += own;
                squares += own * gaps().map(|gap| gap * gap).sum::<f64>() / (vertices.len() - 3) as f64;
            }
        }
        [area, squares]
    }

    /// The faces around a seed that lie in one plane, which is fitted again whenever they have doubled.
    fn grown(&mut self, seed: usize) -> Grown {
        let Self { mesh, topology, vectors, tolerance, .. } = *self;
        let (mut grown, mut n_faces, mut next_fit) = (Grown::default(), 0, 4);
        let (mut center, mut normal) = (mesh.triangle(seed)[0], vectors[seed].normalize());
        let mut pending = VecDeque::from([(seed, seed, 0.0)]);
        self.reached[seed] = seed;
        while let Some((f, from, length)) = pending.pop_front() {
            let is_near = |p: &Point3<f64>| normal.dot(&(p - center)).abs() < tolerance;
            let is_along = vectors[f].dot(&normal) > MIN_COSINE * vectors[f].norm();
            if !(is_along && mesh.triangle(f).iter().all(is_near)) {
                let [cosine, norms] =
                    [vectors[f].dot(&vectors[from]), vectors[f].norm() * vectors[from].norm()];
                grown.boundary[usize::from(cosine < MIN_COSINE * norms)] += length;
                continue;
            }
            if std::mem::replace(&mut self.is_taken[f], true) {
                grown.meets_another = true;
                continue;
            }
            grown.area += 0.5 * vectors[f].norm();
            for v in mesh.faces[f].map(|v| v.index()) {
                if std::mem::replace(&mut self.seen[v], seed) != seed {
                    grown.fit.add(&mesh.positions[v]);
                    grown.vertices.push(v);
                }
            }
            n_faces += 1;
            if n_faces == next_fit {
                let (middle, direction) = grown.fit.plane();
                (center, normal) = (middle, direction * direction.dot(&normal).signum());
                next_fit *= 2;
            }
            for edge in FaceId::from(f).corners().map(|corner| topology.opposite_edge(corner)) {
                let [p, q] = topology.edges()[edge.index()].map(|v| mesh.positions[v.index()]);
                for g in topology.edge_corners(edge).iter().map(|other| other.face().index()) {
                    if std::mem::replace(&mut self.reached[g], seed) != seed {
                        pending.push_back((g, f, (p - q).norm()));
                    }
                }
            }
        }
        grown
    }
}

#[cfg(test)]
mod tests {
    use base::SplitMix;
    use mesh::{TriMesh, shapes};

    use super::*;

    #[test]
    fn the_noise_of_parts_is_measured_and_shape_is_not_noise() {
        let noise = |mesh: &TriMesh| MeshGeometry::new(mesh, None).unwrap().noise();
        let cube = shapes::cube(4);
        assert!(noise(&cube).unwrap() < 1e-9);
        for share in [3e-4, 1e-3, 2e-3] {
            let (mut noisy, mut random) = (cube.clone(), SplitMix(5));
            // Sums of three uniform numbers have unit variance.
            let mut shift = || share * cube.root_of_area() * (0..3).map(|_| random.uniform()).sum::<f64>();
            noisy.positions.iter_mut().for_each(|p| *p += Vector3::from_fn(|_, _| shift()));
            let found = noise(&noisy).unwrap_or_default() / share;
            assert!((0.8..1.25).contains(&found), "{share}: {found}");
        }
        for body in [
            shapes::icosphere(4),
            shapes::icosphere(2),
            shapes::torus(40, 16, 2.0, 0.7),
            shapes::lopsided_torus(),
        ] {
            assert_eq!(noise(&body), None);
        }
    }
}
