//! Noise on mechanical parts, by the planes that they have.

use std::collections::VecDeque;

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
                let [area, squares] = self.planes_within(tolerance, &topology, &vectors, &order);
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

    /// The area of planes within a tolerance, and the squared distances of vertices from them, times the areas.
    /// `vectors` are the area vectors of faces, `order` has those with the largest first.
    fn planes_within(
        &self,
        tolerance: f64,
        topology: &Topology,
        vectors: &[Vector3<f64>],
        order: &[usize],
    ) -> [f64; 2] {
        let mesh = self.mesh();
        let (mut is_taken, mut stamp) = (vec![false; vectors.len()], vec![usize::MAX; vectors.len()]);
        let mut seen = vec![usize::MAX; mesh.n_vertices()];
        let (mut area, mut squares) = (0.0, 0.0);
        for &seed in order {
            if is_taken[seed] || vectors[seed].norm_squared() == 0.0 {
                continue;
            }
            let (mut fit, mut vertices, mut own) = (Fit::default(), Vec::new(), 0.0);
            let mut normal = vectors[seed].normalize();
            let (mut center, mut next_fit, mut n_faces) = (mesh.triangle(seed)[0], 4, 0);
            let (mut pending, mut is_whole) = (VecDeque::from([(seed, seed, 0.0)]), true);
            // Lengths of the boundary at blunt and at sharp edges.
            let mut boundary = [0.0; 2];
            stamp[seed] = seed;
            while let Some((f, from, length)) = pending.pop_front() {
                let is_near = |p: &Point3<f64>| normal.dot(&(p - center)).abs() < tolerance;
                let is_along = vectors[f].dot(&normal) > MIN_COSINE * vectors[f].norm();
                if !(is_along && mesh.triangle(f).iter().all(is_near)) {
                    let is_sharp = vectors[f].dot(&vectors[from])
                        < MIN_COSINE * vectors[f].norm() * vectors[from].norm();
                    boundary[usize::from(is_sharp)] += length;
                    continue;
                }
                // What another plane has, too, is a curved surface.
                if is_taken[f] {
                    is_whole = false;
                    continue;
                }
                is_taken[f] = true;
                own += 0.5 * vectors[f].norm();
                n_faces += 1;
                for v in mesh.faces[f].map(|v| v.index()) {
                    if std::mem::replace(&mut seen[v], seed) != seed {
                        fit.add(&mesh.positions[v]);
                        vertices.push(v);
                    }
                }
                if n_faces == next_fit {
                    let (middle, direction) = fit.plane();
                    (center, normal) = (middle, direction * direction.dot(&normal).signum());
                    next_fit *= 2;
                }
                for edge in FaceId::from(f).corners().map(|corner| topology.opposite_edge(corner)) {
                    let [p, q] = topology.edges()[edge.index()].map(|v| mesh.positions[v.index()]);
                    for g in topology.edge_corners(edge).iter().map(|other| other.face().index()) {
                        if std::mem::replace(&mut stamp[g], seed) != seed {
                            pending.push_back((g, f, (p - q).norm()));
                        }
                    }
                }
            }
            if !is_whole || boundary[0] > boundary[1] || own < MIN_PLANE || vertices.len() < 4 {
                continue;
            }
            let (center, normal) = fit.plane();
            let gaps = || vertices.iter().map(|&v| normal.dot(&(mesh.positions[v] - center)));
            if gaps().all(|gap| gap.abs() < MAX_GAP * tolerance) {
                area += own;
                squares += own * gaps().map(|gap| gap * gap).sum::<f64>() / (vertices.len() - 3) as f64;
            }
        }
        [area, squares]
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
