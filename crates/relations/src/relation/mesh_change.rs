//! How the triangles of one surface changed.

use mesh::TriMesh;
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
        let is_noise = displacements([a, b]).is_some_and(|[joint, own, _]| joint < INDEPENDENT * own);
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

/// How far vertices of meshes with the same faces are displaced together with their neighbors, root mean square, beyond what
/// independent noise may seem to be.
pub(super) fn systematic_displacement(meshes: [&MeshGeometry; 2]) -> f64 {
    let Some([joint, own, n]) = displacements(meshes) else { return 0.0 };
    // The product of two independent displacements in space has a third of the variance of their squares.
    let error = own / (3.0 * n).sqrt();
    ((joint - STANDARD_ERRORS * error) / n).max(0.0).sqrt()
}

/// Of the displacements of vertices, in meshes with the same faces: products over the ends of edges, squares, and how many edges.
fn displacements([a, b]: [&MeshGeometry; 2]) -> Option<[f64; 3]> {
    let pairs: Vec<_> = a.mesh().positions.iter().copied().zip(b.mesh().positions.iter().copied()).collect();
    let fits = [false, true].map(|reflected| {
        let map = Similarity::fit_scaled(&pairs, reflected)?;
        let moved: Vec<_> = pairs.iter().map(|(p, q)| map.apply(p) - q).collect();
        let square: f64 = moved.iter().map(|d| d.norm_squared()).sum();
        Some((square, moved))
    });
    let (_, moved) = fits.into_iter().flatten().min_by(|x, y| x.0.total_cmp(&y.0))?;
    Some(products_along_edges(a.mesh(), |v, w| moved[v].dot(&moved[w])))
}

/// The products over the ends of edges, the squares at them, and how many edges there are.
fn products_along_edges(mesh: &TriMesh, product: impl Fn(usize, usize) -> f64) -> [f64; 3] {
    let (mut joint, mut own) = (0.0, 0.0);
    let topology = mesh.topology();
    for [v, w] in topology.edges().iter().map(|edge| edge.map(VertexId::index)) {
        joint += product(v, w);
        own += 0.5 * (product(v, v) + product(w, w));
    }
    [joint, own, topology.n_edges() as f64]
}

/// Whether nearly all vertices of `coarse` are vertices of `fine`; `map` takes the first onto the second.
fn has_vertices(fine: &MeshGeometry, coarse: &MeshGeometry, map: &Similarity) -> bool {
    let Ok(nearest) = NearestPoints::new(fine.mesh().positions.clone()) else { return false };
    // About the side of equilateral triangles of unit area in total.
    let edge = (2.3 / fine.n_faces() as f64).sqrt();
    let is_kept = |p: &nalgebra::Point3<f64>| nearest.nearest(&map.apply(p)).1 < (ABOUT * edge).powi(2);
    let kept = coarse.mesh().positions.iter().filter(|p| is_kept(p)).count();
    kept as f64 > (1.0 - ABOUT) * coarse.n_vertices() as f64
}
