//! Parts that are missing, and limbs that are longer.

use mesh::TriMesh;
use nalgebra::Vector3;
use surface::{EdgeGraph, VertexId, components_of_faces};

use crate::stream::Stream;

/// Cuts off the end of a random limb with the given share of the area: what is nearest along edges to its tip. Only the
/// largest piece stays.
pub(super) fn cut_off(mesh: &TriMesh, share: f64, stream: &mut Stream) -> TriMesh {
    let Some((_, lengths)) = limb(mesh, stream) else { return mesh.clone() };
    let from_tip = |f: usize| mesh.faces[f].iter().map(|v| lengths[v.index()]).fold(0.0, f64::max);
    let is_cut = first_faces(mesh, share * mesh.area(), from_tip);
    largest_piece(with_faces(mesh, |f| !is_cut[f]))
}

/// The share of the area of the end of a limb that grows.
const END: f64 = 0.06;

/// Makes the end of a random limb longer by a share, evenly from its base to its tip.
pub(super) fn lengthen(mesh: &TriMesh, by: f64, stream: &mut Stream) -> TriMesh {
    let Some((tip, lengths)) = limb(mesh, stream) else { return mesh.clone() };
    let from_tip = |f: usize| lengths[mesh.faces[f][0].index()];
    let is_end = first_faces(mesh, END * mesh.area(), from_tip);
    let reach = (0..mesh.n_faces()).filter(|f| is_end[*f]).map(from_tip).fold(0.0, f64::max);
    let is_base = |length: &f64| (0.85 * reach..=reach).contains(length);
    let base = || mesh.positions.iter().zip(&lengths).filter(|(_, length)| is_base(length));
    let center = base().map(|(p, _)| p.coords).sum::<Vector3<f64>>() / base().count() as f64;
    let growth = (mesh.positions[tip.index()].coords - center) * by;
    let mut longer = mesh.clone();
    for (p, length) in longer.positions.iter_mut().zip(&lengths) {
        *p += growth * (1.0 - length / reach).max(0.0);
    }
    longer
}

/// The tip of a random limb, and the lengths of paths from there.
fn limb(mesh: &TriMesh, stream: &mut Stream) -> Option<(VertexId, Vec<f64>)> {
    if mesh.faces.is_empty() {
        return None;
    }
    let edges = mesh.edge_graph();
    let first = mesh.faces[stream.below(mesh.n_faces())][0];
    let tip = tip(&edges, first);
    Some((tip, edges.from(tip)))
}

/// Whether each face is among the first by `place` that cover an area.
pub(super) fn first_faces(mesh: &TriMesh, area: f64, place: impl Fn(usize) -> f64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..mesh.n_faces()).collect();
    order.sort_by(|a, b| place(*a).total_cmp(&place(*b)));
    let mut is_first = vec![false; mesh.n_faces()];
    let mut covered = 0.0;
    for f in order {
        if covered >= area {
            break;
        }
        is_first[f] = true;
        covered += 0.5 * mesh.area_vector(f).norm();
    }
    is_first
}

/// The mesh with some of its faces only.
pub(super) fn with_faces(mesh: &TriMesh, is_kept: impl Fn(usize) -> bool) -> TriMesh {
    let faces = (0..mesh.n_faces()).filter(|f| is_kept(*f)).map(|f| mesh.faces[f]).collect();
    TriMesh { positions: mesh.positions.clone(), faces }
}

/// The component with the largest area.
pub(super) fn largest_piece(rest: TriMesh) -> TriMesh {
    let pieces = components_of_faces(rest.n_vertices(), &rest.faces);
    let mut areas = vec![0.0; pieces.count];
    for f in 0..rest.n_faces() {
        if let Some(piece) = pieces.of(rest.faces[f][0]) {
            areas[piece] += rest.area_vector(f).norm();
        }
    }
    let largest = (0..pieces.count).max_by(|a, b| areas[*a].total_cmp(&areas[*b]));
    let faces = rest.faces.iter().filter(|face| pieces.of(face[0]) == largest).copied().collect();
    TriMesh { positions: rest.positions, faces }.without_unused_vertices()
}

/// The end of the limb on which a vertex is: from there, the distance from the middle of the surface only falls.
fn tip(edges: &EdgeGraph, first: VertexId) -> VertexId {
    let (one, _) = farthest(&edges.from(first));
    let from_one = edges.from(VertexId::from(one));
    let (other, _) = farthest(&from_one);
    let from_other = edges.from(VertexId::from(other));
    // The middle of the longest path.
    let reach = |v: usize| from_one[v].max(from_other[v]);
    let middle =
        (0..from_one.len()).min_by(|a, b| reach(*a).total_cmp(&reach(*b))).map_or(first, VertexId::from);
    let height = edges.from(middle);
    let mut at = first;
    while let Some(next) =
        edges.ways(at).iter().map(|way| way.to).max_by(|a, b| height[a.index()].total_cmp(&height[b.index()]))
        && height[next.index()] > height[at.index()]
    {
        at = next;
    }
    at
}

/// The largest of the finite lengths with its vertex.
pub(super) fn farthest(lengths: &[f64]) -> (usize, f64) {
    let finite = lengths.iter().copied().enumerate().filter(|(_, length)| length.is_finite());
    finite.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
}
