//! Simplified meshes for viewing.

use std::collections::{BTreeMap, BTreeSet};

use mesh::TriMesh;
use nalgebra::{Point3, Vector3};
use surface::VertexId;

/// The greatest number of cells along the longest side of a mesh.
const FINEST: usize = 2048;

/// Simplifies a mesh to at most `limit` vertices by vertex clustering (Rossignac and Borrel 1993), for viewing only.
///
/// In each cell of the finest cubic grid that has at most `limit` occupied cells, the vertex nearest to the mean remains.
/// Faces with two corners in one cell are dropped. Returns the vertices that remain, ascending, and the mesh over them.
/// They keep their positions, so canonical forms and values can be simplified in the same way.
pub(crate) fn coarse(mesh: &TriMesh, limit: usize) -> (Vec<usize>, TriMesh) {
    if mesh.n_vertices() <= limit {
        return ((0..mesh.n_vertices()).collect(), mesh.clone());
    }
    // The number of occupied cells grows almost monotonically with the number along a side.
    let (mut fits, mut too_fine) = (1, FINEST);
    while fits + 1 < too_fine {
        let middle = usize::midpoint(fits, too_fine);
        let few = cells(mesh, middle).into_iter().collect::<BTreeSet<_>>().len() <= limit;
        if few { fits = middle } else { too_fine = middle }
    }
    thinned(mesh, &cells(mesh, fits))
}

/// The cell of every vertex in a grid with `n` cells along the longest side.
fn cells(mesh: &TriMesh, n: usize) -> Vec<[usize; 3]> {
    let [low, high] = mesh.bounds().unwrap_or_default();
    let side = (high - low).max() / n as f64;
    let cell = |p: &Point3<f64>| ((p - low) / side).map(|c| (c as usize).min(n - 1)).into();
    mesh.positions.iter().map(cell).collect()
}

fn thinned(mesh: &TriMesh, cells: &[[usize; 3]]) -> (Vec<usize>, TriMesh) {
    let mut members: BTreeMap<[usize; 3], Vec<usize>> = BTreeMap::new();
    cells.iter().enumerate().for_each(|(v, cell)| members.entry(*cell).or_default().push(v));
    let mut stays = vec![0; cells.len()];
    for vertices in members.values() {
        let sum: Vector3<f64> = vertices.iter().map(|&v| mesh.positions[v].coords).sum();
        let mean = sum / vertices.len() as f64;
        let off = |v: usize| (mesh.positions[v].coords - mean).norm_squared();
        let nearest = vertices.iter().copied().min_by(|&a, &b| off(a).total_cmp(&off(b)));
        vertices.iter().for_each(|&v| stays[v] = nearest.unwrap_or(v));
    }
    let vertices: Vec<usize> = (0..stays.len()).filter(|&v| stays[v] == v).collect();
    let mut place = vec![VertexId(0); stays.len()];
    vertices.iter().zip(0..).for_each(|(&v, at)| place[v] = VertexId(at));
    let mut seen = BTreeSet::new();
    let mut kept = |face: &[VertexId; 3]| {
        let mut corners = *face;
        corners.sort_unstable();
        corners[0] != corners[1] && corners[1] != corners[2] && seen.insert(corners)
    };
    let faces = mesh.faces.iter().map(|face| face.map(|v| place[stays[v.index()]]));
    let faces = faces.filter(|face| kept(face)).collect();
    let positions = vertices.iter().map(|&v| mesh.positions[v]).collect();
    (vertices, TriMesh { positions, faces })
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::shapes::icosphere;

    #[test]
    fn meshes_below_the_limit_are_unchanged() {
        let ball = icosphere(1);
        let (vertices, same) = coarse(&ball, ball.n_vertices());
        assert!(vertices.into_iter().eq(0..ball.n_vertices()));
        assert_eq!(same, ball);
    }

    #[test]
    fn a_simplified_ball_keeps_its_area() {
        let ball = icosphere(5);
        for limit in [100, 1000] {
            let (vertices, thin) = coarse(&ball, limit);
            let n = vertices.len();
            assert!(n <= limit && n > limit / 3, "{n} of {limit}");
            assert!(thin.faces.iter().flatten().all(|v| v.index() < n));
            assert!(vertices.iter().zip(&thin.positions).all(|(&v, at)| ball.positions[v] == *at));
            let area = thin.area() / ball.area();
            assert!((0.8..1.05).contains(&area), "{area}");
        }
    }

    #[test]
    fn a_mesh_without_extent_becomes_a_point() {
        let flat = TriMesh { positions: vec![Point3::origin(); 9], faces: vec![[0, 1, 2].map(VertexId)] };
        let (vertices, point) = coarse(&flat, 4);
        assert!(vertices.len() == 1 && point.faces.is_empty());
    }
}
