//! Parts that are missing.

use mesh::TriMesh;
use surface::components_of_faces;

use super::holes::compacted;
use super::paths::{Edges, farthest};
use crate::stream::Stream;

/// Cuts off the end of a limb with the given share of the area: what is nearest along edges to the vertex farthest from a random
/// one. Only the largest piece stays.
pub(super) fn cut_off(mesh: &TriMesh, share: f64, stream: &mut Stream) -> TriMesh {
    if mesh.faces.is_empty() {
        return mesh.clone();
    }
    let edges = Edges::of(mesh);
    let first = mesh.faces[stream.below(mesh.n_faces())][0].index();
    let (tip, _) = farthest(&edges.lengths(first));
    let lengths = edges.lengths(tip);
    let from_tip = |f: usize| mesh.faces[f].iter().map(|v| lengths[v.index()]).fold(0.0, f64::max);
    let mut order: Vec<usize> = (0..mesh.n_faces()).collect();
    order.sort_by(|a, b| from_tip(*a).total_cmp(&from_tip(*b)));
    let (mut covered, limit) = (0.0, share * mesh.area());
    let mut is_cut = vec![false; mesh.n_faces()];
    for f in order {
        if covered >= limit {
            break;
        }
        is_cut[f] = true;
        covered += 0.5 * mesh.area_vector(f).norm();
    }
    let left = |f: &usize| !is_cut[*f];
    let faces: Vec<_> = (0..mesh.n_faces()).filter(left).map(|f| mesh.faces[f]).collect();
    let pieces = components_of_faces(mesh.n_vertices(), &faces);
    let rest = TriMesh { positions: mesh.positions.clone(), faces };
    let mut areas = vec![0.0; pieces.count];
    for f in 0..rest.n_faces() {
        areas[pieces.of(rest.faces[f][0])] += rest.area_vector(f).norm();
    }
    let largest = (0..pieces.count).max_by(|a, b| areas[*a].total_cmp(&areas[*b]));
    let faces = rest.faces.iter().filter(|face| Some(pieces.of(face[0])) == largest).copied().collect();
    compacted(&TriMesh { positions: rest.positions, faces })
}
