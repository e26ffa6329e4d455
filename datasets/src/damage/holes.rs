//! Holes.

use mesh::TriMesh;
use surface::{NearestFirst, Rows, components_of_faces};

use super::cut_off::with_faces;
use crate::stream::Stream;

/// Number of discs.
const DISCS: usize = 3;

/// Most places that are drawn for a disc.
const DRAWS: usize = 20;

/// Cuts discs with the given share of the area in total out of a mesh.
pub(super) fn holes(mesh: &TriMesh, share: f64, stream: &mut Stream) -> TriMesh {
    let each = share * mesh.area() / DISCS as f64;
    let mut left = mesh.clone();
    for _ in 0..DISCS {
        let parts = components_of_faces(left.n_vertices(), &left.faces).count;
        for draw in 1..=DRAWS {
            if left.faces.is_empty() {
                return left;
            }
            let first = stream.below(left.n_faces());
            let cut = without_disc(&left, first, each);
            if draw == DRAWS || components_of_faces(cut.n_vertices(), &cut.faces).count == parts {
                left = cut;
                break;
            }
        }
    }
    left.without_unused_vertices()
}

/// The mesh without the faces around `first`, nearest in space first, until they cover `area`. They are connected by
/// vertices.
fn without_disc(mesh: &TriMesh, first: usize, area: f64) -> TriMesh {
    let corners = mesh.faces.iter().flatten().enumerate();
    let faces_at = Rows::collect(mesh.n_vertices(), corners.map(|(corner, v)| (v.index(), corner / 3)));
    let center = |f: usize| mesh.triangle(f).iter().map(|p| p.coords).sum::<nalgebra::Vector3<f64>>() / 3.0;
    let middle = center(first);
    let mut reached = vec![false; mesh.n_faces()];
    let mut is_cut = vec![false; mesh.n_faces()];
    let mut queue = NearestFirst::default();
    queue.push(0.0, first);
    reached[first] = true;
    let mut covered = 0.0;
    while covered < area
        && let Some((_, f)) = queue.pop()
    {
        is_cut[f] = true;
        covered += 0.5 * mesh.area_vector(f).norm();
        for &near in mesh.faces[f].iter().flat_map(|v| faces_at.row(v.index())) {
            if !std::mem::replace(&mut reached[near], true) {
                queue.push((center(near) - middle).norm_squared(), near);
            }
        }
    }
    with_faces(mesh, |f| !is_cut[f])
}
