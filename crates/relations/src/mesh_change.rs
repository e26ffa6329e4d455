//! How the triangles of one surface changed.

use mesh::TriMesh;
use nalgebra::{Point3, Vector3};
use rigid::{NearestPoints, Similarity};
use surface::VertexId;

use super::Change;
use super::calibration::STANDARD_ERRORS;
use super::geometry::MeshGeometry;

/// Meshes have about as many vertices, or vertices that matter, if the numbers differ by less than this share. Vertices that a
/// subdivision keeps, nearly all, are found again within this distance, relative to the mean edge. Half and twice as much change no
/// answer.
pub(super) const ABOUT: f64 = 0.05;

/// Displacements of neighboring vertices are independent, as those by noise, if their correlation along edges is below
/// this. A safety limit: it is 0 for noise and 1 for a smooth deformation.
const INDEPENDENT: f64 = 0.5;

/// What happened to the triangles of a surface; `map` takes the first mesh onto the second. Of meshes with the same faces it is
/// [`Change::Noisy`] if displacements do not depend on those of neighbors, else [`Change::Posed`].
pub(super) fn mesh_change([a, b]: [&MeshGeometry; 2], map: &Similarity) -> Change {
    if a.n_vertices() == b.n_vertices() && a.mesh().faces == b.mesh().faces {
        let is_noise = Displacements::between([a, b]).is_some_and(|found| found.correlation < INDEPENDENT);
        return if is_noise { Change::Noisy } else { Change::Posed };
    }
    let ratio = b.n_vertices() as f64 / a.n_vertices() as f64;
    if ratio < 1.0 - ABOUT {
        Change::Decimated
    } else if ratio > 1.0 + ABOUT && has_vertices(b, a, map) {
        Change::Subdivided
    } else {
        Change::Remeshed
    }
}

/// How vertices of a mesh are displaced from another surface, over the corners of faces.
pub(super) struct Displacements {
    /// Root mean square.
    pub(super) rms: f64,
    /// The fourth moment, in squares of the second.
    pub(super) kurtosis: f64,
    /// Of the ends of edges.
    pub(super) correlation: f64,
    pub(super) n_edges: f64,
}

impl Displacements {
    /// Of vertices at some faces.
    fn new(
        mesh: &TriMesh,
        faces: impl Iterator<Item = usize>,
        mut of: impl FnMut(VertexId) -> Vector3<f64>,
    ) -> Self {
        let (mut n, mut joint, mut squares, mut fourths) = (0.0, 0.0, 0.0, 0.0);
        for [a, b, c] in faces.map(|f| mesh.faces[f].map(&mut of)) {
            n += 3.0;
            joint += a.dot(&b) + b.dot(&c) + c.dot(&a);
            for square in [a, b, c].map(|d| d.norm_squared()) {
                squares += square;
                fourths += square * square;
            }
        }
        let (rms, kurtosis) = ((squares / n).sqrt(), n * fourths / (squares * squares));
        // An edge has two faces.
        Self { rms, kurtosis, correlation: joint / squares, n_edges: 0.5 * n }
    }

    /// Of two meshes with the same faces, best laid over each other.
    fn between([a, b]: [&MeshGeometry; 2]) -> Option<Self> {
        let [own, others] = [a, b].map(|geometry| &geometry.mesh().positions);
        let pairs: Vec<_> = own.iter().copied().zip(others.iter().copied()).collect();
        let fits = [false, true].into_iter().filter_map(|reflected| {
            let map = Similarity::fit_scaled(&pairs, reflected)?;
            let displaced = |v: VertexId| map.apply(&own[v.index()]) - others[v.index()];
            Some(Self::new(a.mesh(), 0..a.n_faces(), displaced))
        });
        fits.min_by(|x, y| x.rms.total_cmp(&y.rms))
    }

    /// Of vertices of one mesh from the surface of another, under the map from one to the other.
    pub(super) fn from_surface(from: &MeshGeometry, to: &MeshGeometry, map: &Similarity) -> Self {
        // Vertices are corners of several faces.
        let mut known = vec![None; from.n_vertices()];
        Self::new(from.mesh(), from.some_faces(), |v| {
            *known[v.index()].get_or_insert_with(|| {
                let p = map.apply(&from.mesh().positions[v.index()]);
                to.surface.tree().nearest(&p).map_or(Vector3::zeros(), |near| p - near.point)
            })
        })
    }
}

/// How far vertices of meshes with the same faces are displaced together with their neighbors, root mean square, beyond what
/// independent noise may seem to be.
pub(super) fn systematic_displacement(meshes: [&MeshGeometry; 2]) -> f64 {
    let Some(found) = Displacements::between(meshes) else { return 0.0 };
    // The product of two independent displacements in space has a third of the variance of their squares.
    let error = STANDARD_ERRORS / (3.0 * found.n_edges).sqrt();
    found.rms * (found.correlation - error).max(0.0).sqrt()
}

/// Whether nearly all vertices of `coarse` are vertices of `fine`; `map` takes the first onto the second.
fn has_vertices(fine: &MeshGeometry, coarse: &MeshGeometry, map: &Similarity) -> bool {
    let Ok(nearest) = NearestPoints::new(fine.mesh().positions.clone()) else { return false };
    // The side of equilateral triangles of unit area in total.
    let edge = (4.0 / (3f64.sqrt() * fine.n_faces() as f64)).sqrt();
    let is_kept = |p: &Point3<f64>| nearest.nearest(&map.apply(p)).1 < (ABOUT * edge).powi(2);
    let kept = coarse.mesh().positions.iter().filter(|p| is_kept(p)).count();
    kept as f64 > (1.0 - ABOUT) * coarse.n_vertices() as f64
}
