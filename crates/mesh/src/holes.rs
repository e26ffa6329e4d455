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
