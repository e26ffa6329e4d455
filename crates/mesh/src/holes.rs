//! Closing small holes.

use nalgebra::{Point3, Vector3};
use surface::{Topology, VertexId};

use crate::boundary::simple_boundaries;
use crate::orientation::turned_faces;
use crate::remap::Remapped;
use crate::tri_mesh::TriMesh;

/// Closes the holes whose boundary is at most `longest` long, in mesh units: each gets a vertex in the middle of its
/// boundary, joined to it by triangles. It comes from a vertex of the boundary.
///
/// A hole is a closed loop of edges with one face. Loops that touch each other in a vertex are left open.
///
/// ```
/// use canonform_mesh::{fill_holes, shapes, validate};
///
/// let mut ball = shapes::icosphere(3);
/// ball.faces.truncate(ball.faces.len() - 4);
/// assert_eq!(validate(&ball).n_boundary_loops, 1);
/// assert_eq!(validate(&fill_holes(&ball, &ball.topology(), 1.0).mesh).n_boundary_loops, 0);
/// assert!(fill_holes(&ball, &ball.topology(), 0.1).remap.is_identity());
/// ```
pub fn fill_holes(mesh: &TriMesh, topology: &Topology, longest: f64) -> Remapped {
    let (mut filled, mut origins) = (mesh.clone(), Vec::new());
    for hole in holes(mesh, topology) {
        let Some(middle) = middle_within(mesh, &hole, longest) else { continue };
        let center = VertexId::from(filled.n_vertices());
        filled.positions.push(middle);
        origins.push(hole[0]);
        // Against the direction in which the faces outside run.
        filled.faces.extend(sides(&hole).map(|[a, b]| [b, a, center]));
    }
    Remapped::extended(filled, origins)
}

/// The sides of a closed loop.
fn sides(hole: &[VertexId]) -> impl Iterator<Item = [VertexId; 2]> {
    hole.iter().zip(hole.iter().cycle().skip(1)).map(|(&a, &b)| [a, b])
}

/// The center of gravity of a boundary, if it is short enough. Measured along the boundary, so that it does not depend on
/// where its vertices are.
fn middle_within(mesh: &TriMesh, hole: &[VertexId], longest: f64) -> Option<Point3<f64>> {
    let unit = mesh.unit();
    let (mut moment, mut length) = (Vector3::zeros(), 0.0);
    for [a, b] in sides(hole).map(|side| side.map(|v| mesh.positions[v.index()].coords / unit)) {
        let side = (b - a).norm();
        moment += (a + b) * (0.5 * side);
        length += side;
    }
    (length > 0.0 && length * unit <= longest).then(|| Point3::from(moment / length * unit))
}

/// The holes, each in the direction of the faces around it once they are oriented consistently.
fn holes(mesh: &TriMesh, topology: &Topology) -> Vec<Vec<VertexId>> {
    let mut holes = simple_boundaries(topology);
    if holes.is_empty() {
        return holes;
    }
    let turned = turned_faces(&mesh.positions, topology);
    let is_along = |side: [VertexId; 2]| {
        let corner = topology.edge_corners(topology.edge_between(side[0], side[1])?)[0];
        Some((topology.edge_ends(corner) == side) != turned[corner.face().index()])
    };
    holes.retain_mut(|hole| {
        let along: Vec<_> = sides(hole).map(is_along).collect();
        if along[0] == Some(false) {
            hole[1..].reverse();
        }
        along.iter().all(|other| *other == along[0])
    });
    holes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{shapes, validate};

    /// A torus without the faces at some vertices.
    fn pierced(vertices: &[u32]) -> TriMesh {
        let mut mesh = shapes::torus(40, 20, 2.0, 0.7);
        mesh.faces.retain(|face| !face.iter().any(|v| vertices.contains(&v.0)));
        mesh
    }

    #[test]
    fn holes_are_closed_and_faces_stay_oriented() {
        let mesh = pierced(&[3, 100, 500]);
        let filled = fill_holes(&mesh, &mesh.topology(), 3.0);
        let report = validate(&filled.mesh);
        assert_eq!((report.n_boundary_loops, report.flipped_faces), (0, 0), "{report:?}");
        assert_eq!(filled.mesh.positions[..mesh.n_vertices()], mesh.positions);
        assert_eq!(filled.mesh.faces[..mesh.n_faces()], mesh.faces);
        assert_eq!((filled.remap.origins().len(), filled.mesh.n_vertices()), (3, mesh.n_vertices() + 3));
        let whole = shapes::torus(40, 20, 2.0, 0.7).area();
        assert!((filled.mesh.area() / whole - 1.0).abs() < 0.002 && mesh.area() < 0.99 * whole);
    }

    #[test]
    fn large_holes_and_touching_ones_stay() {
        let sheet = shapes::grid(5, 5, 1.0);
        assert!(fill_holes(&sheet, &sheet.topology(), 15.9).remap.is_identity());
        assert_eq!(fill_holes(&sheet, &sheet.topology(), 16.1).remap.origins().len(), 1);
        let mut touching = shapes::grid(6, 6, 1.0);
        touching.faces.retain(|face| {
            let corner = face.iter().map(|v| v.0).min().unwrap();
            ![7, 14].contains(&corner)
        });
        assert!(fill_holes(&touching, &touching.topology(), 6.0).remap.is_identity());
        let torus = shapes::torus(8, 8, 2.0, 0.7);
        assert!(fill_holes(&torus, &torus.topology(), 100.0).remap.is_identity());
    }

    #[test]
    fn subdivision_and_flipped_faces_do_not_change_the_middle() {
        let mesh = pierced(&[77]);
        let expected = fill_holes(&mesh, &mesh.topology(), 3.0);
        let fine = shapes::subdivide(&mesh);
        assert!(fine.n_vertices() > 3 * mesh.n_vertices());
        let mut turned = mesh.clone();
        turned.faces.iter_mut().step_by(5).for_each(|face| face.swap(0, 2));
        for other in [fine, turned] {
            let found = fill_holes(&other, &other.topology(), 3.0);
            assert_eq!(found.remap.origins().len(), 1);
            let gap = found.mesh.positions.last().unwrap() - expected.mesh.positions.last().unwrap();
            assert!(gap.norm() < 1e-12);
        }
    }
}
