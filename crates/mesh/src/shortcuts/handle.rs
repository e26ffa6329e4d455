//! Narrow handles.

use std::collections::HashSet;

use base::{Budget, Exceeded};
use surface::{CornerId, DisjointSets, Frontier, SurfaceLoop, Topology, VertexId, short_loops};

use super::shortcut::{Shortcut, ShortcutKind};
use crate::remap::Remapped;
use crate::tri_mesh::TriMesh;

/// Least area within the girth of a handle on either side of its narrowest loop, relative to the square of the girth. A tube
/// has 1; where two flat surfaces meet in a small contact, each side has 1 + π.
///
/// Chosen on creatures of seeds 1 to 3 with 1,000 to 3,400 vertices: of the handles that they have by design, the widest has
/// 1.27 on its narrower side.
const FLARE: f64 = 1.4;

/// Cuts the narrowest handle that is at most `girth` around and joins sides that are otherwise at least `detour` apart.
pub(super) fn cut(
    mesh: &TriMesh,
    topology: &Topology,
    [girth, detour]: [f64; 2],
    budget: &Budget,
) -> Result<Option<(Remapped, Shortcut)>, Exceeded> {
    let length = |[a, b]: &[VertexId; 2]| (mesh.positions[a.index()] - mesh.positions[b.index()]).norm();
    let lengths: Vec<f64> = topology.edges().iter().map(length).collect();
    let loops = short_loops(topology, &lengths, girth, budget)?;
    Ok(loops.iter().find_map(|around| opened(mesh, topology, around, detour)))
}

/// The surface cut along a loop, if the loop goes around a shortcut.
fn opened(
    mesh: &TriMesh,
    topology: &Topology,
    around: &SurfaceLoop,
    least: f64,
) -> Option<(Remapped, Shortcut)> {
    let (cut, sides) = cut_along(mesh, topology, &around.vertices)?;
    let areas = cut.mesh.vertex_areas();
    let (graph, mut front) = (cut.mesh.edge_graph(), Frontier::default());
    let mut flare = |side: &Vec<VertexId>| {
        let near = graph.within(&mut front, side, around.length, |_| false);
        near.iter().map(|(v, _)| areas[v.index()]).sum::<f64>() / (around.length * around.length)
    };
    let widens = sides.iter().all(|side| flare(side) >= FLARE);
    let detour = graph.between(&mut front, &sides[0], &sides[1], f64::INFINITY);
    let shortcut =
        Shortcut { kind: ShortcutKind::Handle, vertex: around.vertices[0], girth: around.length, detour };
    (widens && detour >= least && detour.is_finite()).then_some((cut, shortcut))
}

/// The mesh with two copies of every vertex of a loop, one for each side, and the loop on both sides; `None` if the loop has
/// one side only or touches the boundary.
fn cut_along(
    mesh: &TriMesh,
    topology: &Topology,
    around: &[VertexId],
) -> Option<(Remapped, [Vec<VertexId>; 2])> {
    let sides: HashSet<[VertexId; 2]> = (0..around.len())
        .map(|i| {
            let (a, b) = (around[i], around[(i + 1) % around.len()]);
            [a.min(b), a.max(b)]
        })
        .collect();
    // Corners at the loop, numbered.
    let mut corners: Vec<CornerId> =
        around.iter().flat_map(|v| topology.vertex_corners(*v)).copied().collect();
    corners.sort_unstable();
    let number = |corner: CornerId| corners.binary_search(&corner).ok().map(|i| i as u32);
    let mut sets = DisjointSets::new(corners.len());
    for &corner in &corners {
        let v = topology.corner_vertex(corner);
        // The side opposite one of the two others runs from `corner` to the third corner.
        for (side, third) in [(corner.next(), corner.prev()), (corner.prev(), corner.next())] {
            let w = topology.corner_vertex(third);
            if sides.contains(&[v.min(w), v.max(w)]) {
                // Both ends of an edge of the loop are on the same side within a face.
                sets.union(number(corner)?, number(third)?);
            } else {
                let across = topology.opposite(side)?;
                let same = [across.next(), across.prev()];
                let same = same.into_iter().find(|c| topology.corner_vertex(*c) == v)?;
                sets.union(number(corner)?, number(same)?);
            }
        }
    }
    let roots: Vec<u32> = (0..corners.len() as u32).map(|i| sets.find(i)).collect();
    let other = *roots.iter().find(|root| **root != roots[0])?;
    if roots.iter().any(|root| *root != roots[0] && *root != other) {
        return None;
    }
    let n = mesh.n_vertices();
    let mut cut = mesh.clone();
    for (&corner, _) in corners.iter().zip(&roots).filter(|(_, root)| **root == other) {
        let v = topology.corner_vertex(corner);
        let place = around.iter().position(|x| *x == v)?;
        cut.faces[corner.face().index()][corner.slot()] = VertexId::from(n + place);
    }
    cut.positions.extend(around.iter().map(|v| mesh.positions[v.index()]));
    let copies = (0..around.len()).map(|i| VertexId::from(n + i)).collect();
    Some((Remapped::extended(cut, around.to_vec()), [around.to_vec(), copies]))
}
