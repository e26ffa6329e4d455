//! Noise: telling it from shape, and smoothing it away.

use nalgebra::Vector3;
use surface::{EdgeId, Topology, VertexId};

use crate::orientation::turned_faces;
use crate::regions::SmoothRegions;
use crate::tri_mesh::TriMesh;

/// Below this [coherence](Bending::coherence) a mesh is noisy. Of the built-in shapes, clean ones with 1,000 to 8,000 vertices
/// have 0.85 to 0.92, simplified ones 0.38 to 0.65, and subdivided ones, whose new vertices lie in flat faces, 0.32 to 0.35.
/// Noise of 0.5 % of the diagonal brings 3,400 vertices to -0.11 or less.
const NOISY: f64 = 0.15;

/// Vertices that stick out less than this share of the mean edge change neither distances nor areas, and those of flat faces
/// only stick out by rounding.
const SLIGHT: f64 = 0.03;

/// Smoothing ends when the coherence is that of a simplified mesh without noise.
const SMOOTH: f64 = 0.4;

/// Rounds between two measurements of the coherence. On the built-in shapes, five rounds are the best for most amounts of
/// noise.
const ROUNDS: usize = 5;

/// Most measurements.
const MAX_PASSES: usize = 12;

/// Share of the way to its neighbors that a vertex moves in the two steps of a round: forth and back. The second undoes the
/// shrinkage of the first.
const STEPS: [f64; 2] = [0.5, -0.53];

/// The mesh without its noise, if it is noisy: smoothed until neighboring vertices bend alike. The faces stay.
///
/// Smooths like Taubin 1995 (`taubin1995` in `REFERENCES.bib`), which hardly shrinks. A vertex on an edge that does not have
/// two faces follows its neighbors along such edges, so boundaries stay boundaries.
///
/// ```
/// use canonform_mesh::{denoise, shapes};
///
/// let mut ball = shapes::icosphere(4);
/// assert!(denoise(&ball, &ball.topology()).is_none());
/// for (i, p) in ball.positions.iter_mut().enumerate() {
///     p.coords *= 1.0 + 0.02 * (12.9 * i as f64).sin();
/// }
/// let smooth = denoise(&ball, &ball.topology()).unwrap();
/// let sphere = 4.0 * std::f64::consts::PI;
/// assert!((smooth.area() / sphere - 1.0).abs() < 0.02 && ball.area() > 1.05 * sphere);
/// ```
pub fn denoise(mesh: &TriMesh, topology: &Topology) -> Option<TriMesh> {
    let (mut smooth, umbrellas) = noisy(mesh, topology)?;
    for _ in 0..MAX_PASSES {
        for step in [STEPS; ROUNDS].into_iter().flatten() {
            let offsets = umbrellas.offsets(&smooth, 1.0);
            smooth.positions.iter_mut().zip(offsets).for_each(|(p, offset)| *p -= offset * step);
        }
        if umbrellas.bending(&smooth).coherence >= SMOOTH {
            break;
        }
    }
    Some(TriMesh { faces: mesh.faces.clone(), ..smooth })
}

/// Whether [`denoise`] changes a mesh. The edges of [mechanical parts](SmoothRegions::is_mechanical) are not noise.
///
/// # Panics
/// If a face has a repeated vertex or one that does not exist, see [`Topology::new`].
pub fn is_noisy(mesh: &TriMesh) -> bool {
    noisy(mesh, &mesh.topology()).is_some()
}

/// A noisy mesh with its faces oriented consistently, and the neighbors of every vertex.
fn noisy(mesh: &TriMesh, topology: &Topology) -> Option<(TriMesh, Umbrellas)> {
    let mut oriented = mesh.clone();
    let turned = turned_faces(&mesh.positions, topology);
    oriented.faces.iter_mut().zip(turned).filter(|(_, turned)| *turned).for_each(|(face, _)| face.swap(1, 2));
    let umbrellas = Umbrellas::of(topology);
    let is_noisy = umbrellas.bending(&oriented).is_noisy() && !SmoothRegions::of(mesh).is_mechanical;
    is_noisy.then_some((oriented, umbrellas))
}

/// How a surface bends at its vertices. Vertices on edges that do not have two faces are left out.
#[derive(Debug, Clone, Copy)]
struct Bending {
    /// How well neighboring vertices agree, -1 to 1: the correlation along edges of the heights of vertices over the mean of
    /// their neighbors. Near 1 on a finely sampled smooth surface, and near -0.2 for noise that is independent in every
    /// vertex, because a vertex that sticks out lowers its neighbors relative to theirs.
    coherence: f64,
    /// Root mean square of these heights, relative to the mean edge.
    height: f64,
}

impl Bending {
    fn is_noisy(self) -> bool {
        self.coherence < NOISY && self.height > SLIGHT
    }
}

/// The neighbors of every vertex.
struct Umbrellas {
    /// Pairs of a vertex and a neighbor that it follows.
    followed: Vec<[VertexId; 2]>,
    n_followed: Vec<u32>,
    /// Edges of which both ends are inside the surface.
    inside: Vec<[VertexId; 2]>,
}

impl Umbrellas {
    fn of(topology: &Topology) -> Self {
        let is_rim = |edge: usize| topology.edge_corners(EdgeId::from(edge)).len() != 2;
        let mut is_inside = vec![true; topology.n_vertices()];
        for (edge, ends) in topology.edges().iter().enumerate() {
            if is_rim(edge) {
                ends.iter().for_each(|v| is_inside[v.index()] = false);
            }
        }
        let (mut followed, mut inside) = (Vec::new(), Vec::new());
        let mut n_followed = vec![0; topology.n_vertices()];
        for (edge, &[a, b]) in topology.edges().iter().enumerate() {
            for [v, neighbor] in [[a, b], [b, a]] {
                if is_inside[v.index()] || is_rim(edge) {
                    followed.push([v, neighbor]);
                    n_followed[v.index()] += 1;
                }
            }
            if is_inside[a.index()] && is_inside[b.index()] {
                inside.push([a, b]);
            }
        }
        Self { followed, n_followed, inside }
    }

    /// The position of every vertex relative to the mean of the neighbors that it follows, in units of `unit`.
    fn offsets(&self, mesh: &TriMesh, unit: f64) -> Vec<Vector3<f64>> {
        let mut sums = vec![Vector3::zeros(); mesh.n_vertices()];
        for [v, neighbor] in &self.followed {
            sums[v.index()] += (mesh.positions[v.index()] - mesh.positions[neighbor.index()]) / unit;
        }
        sums.iter_mut().zip(&self.n_followed).for_each(|(sum, &n)| *sum /= f64::from(n.max(1)));
        sums
    }

    /// The faces must be oriented consistently.
    fn bending(&self, mesh: &TriMesh) -> Bending {
        let unit = mesh.unit();
        let normals = self.normals(mesh, unit);
        let offsets = self.offsets(mesh, unit);
        let heights: Vec<f64> = offsets.iter().zip(&normals).map(|(offset, n)| offset.dot(n)).collect();
        let (mut product, mut square, mut length) = (0.0, 0.0, 0.0);
        for [a, b] in self.inside.iter().map(|edge| edge.map(VertexId::index)) {
            product += heights[a] * heights[b];
            square += 0.5 * (heights[a].powi(2) + heights[b].powi(2));
            length += ((mesh.positions[a] - mesh.positions[b]) / unit).norm();
        }
        let n = self.inside.len().max(1) as f64;
        Bending {
            coherence: if square > 0.0 { product / square } else { 1.0 },
            height: if length > 0.0 { (square / n).sqrt() / (length / n) } else { 0.0 },
        }
    }

    /// Unit normals at the vertices, averaged over their surroundings so that noise does not tilt them.
    fn normals(&self, mesh: &TriMesh, unit: f64) -> Vec<Vector3<f64>> {
        let mut normals = vec![Vector3::zeros(); mesh.n_vertices()];
        for face in 0..mesh.n_faces() {
            let normal = mesh.area_vector_in(face, unit);
            mesh.faces[face].iter().for_each(|v| normals[v.index()] += normal);
        }
        for _ in 0..2 {
            let before = normals.clone();
            self.followed.iter().for_each(|[v, neighbor]| normals[v.index()] += before[neighbor.index()]);
        }
        normals.iter().map(|n| n.try_normalize(0.0).unwrap_or_default()).collect()
    }
}
