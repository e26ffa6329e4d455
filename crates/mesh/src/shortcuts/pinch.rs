//! Vertices that several parts of a surface share.

use nalgebra::Point3;
use surface::{CornerId, DisjointSets, EdgeId, Frontier, OneRing, Topology, VertexId, components_of_faces};

use super::shortcut::{CutSurface, MOST, Shortcut, ShortcutKind};
use super::spike::flattened;
use crate::remap::Remapped;
use crate::tri_mesh::TriMesh;

/// Greatest height of a vertex of a cut that stays where it is, see [`flattened`]. Of the vertices of creatures
/// with 3,400 vertices, 99.99 % are below it.
const PULLED: f64 = 1.5;

/// Splits vertices that parts of the surface share which are otherwise at least `detour` apart and not in two pieces.
pub(super) fn cut(mesh: &TriMesh, topology: &Topology, detour: f64) -> CutSurface {
    let n = mesh.n_vertices();
    let mut faces = mesh.faces.clone();
    // For every new vertex, the old one.
    let mut origins: Vec<VertexId> = Vec::new();
    let mut ring = OneRing::default();
    for v in (0..n).map(VertexId::from) {
        for sheet in sheets(topology, &mut ring, v).into_iter().skip(1) {
            let copy = VertexId::from(n + origins.len());
            origins.push(v);
            sheet.into_iter().for_each(|corner| faces[corner.face().index()][corner.slot()] = copy);
        }
    }
    if origins.is_empty() {
        return CutSurface { cut: Remapped::extended(mesh.clone(), Vec::new()), shortcuts: Vec::new() };
    }
    // A vertex stays shared where it connects what is otherwise not connected.
    let pieces = components_of_faces(n + origins.len(), &faces);
    let mut connected = DisjointSets::new(pieces.count);
    let copies = origins.iter().enumerate().map(|(i, origin)| [*origin, VertexId::from(n + i)]);
    let separate: Vec<bool> = copies
        .map(|ends| match ends.map(|v| pieces.labels[v.index()]) {
            [Some(a), Some(b)] => !connected.union(a, b),
            _ => true,
        })
        .collect();
    let mut split = with_copies(mesh, &faces, &origins, &separate);
    // And where its parts meet nearby; a vertex that was pulled out of its surface is not far for that reason.
    restore_positions(&mut split, n);
    let (graph, mut front) = (split.mesh.edge_graph(), Frontier::default());
    let copy = |i: usize| VertexId::from(n + i);
    let is_far = |(i, origin): (usize, &VertexId)| {
        graph.between(&mut front, &[*origin], &[copy(i)], detour).is_infinite()
    };
    let mut far: Vec<bool> = split.remap.origins().iter().enumerate().map(is_far).collect();
    if far.iter().filter(|far| **far).count() > MOST {
        far.fill(false);
    }
    let mut cut = with_copies(mesh, &split.mesh.faces, split.remap.origins(), &far);
    restore_positions(&mut cut, n);
    let shortcuts = shortcuts(&cut, n);
    CutSurface { cut, shortcuts }
}

/// The mesh with those copies of vertices that are `kept`; in `faces`, copies follow the vertices of the mesh.
fn with_copies(mesh: &TriMesh, faces: &[[VertexId; 3]], origins: &[VertexId], kept: &[bool]) -> Remapped {
    let n = mesh.n_vertices();
    let mut left = Vec::new();
    let number: Vec<VertexId> = origins
        .iter()
        .zip(kept)
        .map(|(&origin, kept)| {
            if !kept {
                return origin;
            }
            left.push(origin);
            VertexId::from(n + left.len() - 1)
        })
        .collect();
    let renumbered = |v: VertexId| if v.index() < n { v } else { number[v.index() - n] };
    let copies = left.iter().map(|origin| mesh.positions[origin.index()]);
    let positions = mesh.positions.iter().copied().chain(copies).collect();
    let faces = faces.iter().map(|face| face.map(renumbered)).collect();
    Remapped::extended(TriMesh { positions, faces }, left)
}

/// The corners at a vertex, by the parts of the surface that have only this vertex, or welded edges, in common.
fn sheets(topology: &Topology, ring: &mut OneRing, v: VertexId) -> Vec<Vec<CornerId>> {
    ring.collect(topology, v);
    if ring.fans().nth(1).is_none() {
        return Vec::new();
    }
    // Fans with a common edge of three faces are one part. Two surfaces that were welded along an edge have four there.
    let mut sets = ring.joined(topology, |edge| is_weld(topology, edge));
    // Parts that end there at a boundary are the two sides of a crack.
    let is_cut = |corner: CornerId| topology.edge_corners(topology.opposite_edge(corner)).len() == 1;
    let mut crack: Option<u32> = None;
    for (i, fan) in (0..).zip(ring.fans()) {
        if !fan.is_closed && fan.ends().into_iter().any(is_cut) {
            sets.union(*crack.get_or_insert(i), i);
        }
    }
    let mut sheets: Vec<(u32, Vec<CornerId>)> = Vec::new();
    for (i, fan) in (0..).zip(ring.fans()) {
        let set = sets.find(i);
        let corners = fan.corners.iter().map(|corner| corner.corner);
        match sheets.iter_mut().find(|(known, _)| *known == set) {
            Some((_, sheet)) => sheet.extend(corners),
            None => sheets.push((set, corners.collect())),
        }
    }
    sheets.into_iter().map(|(_, sheet)| sheet).collect()
}

/// Whether an edge has four faces, two in each direction.
fn is_weld(topology: &Topology, edge: EdgeId) -> bool {
    let corners = topology.edge_corners(edge);
    let forward = |c: &&CornerId| topology.corner_vertex(c.next()) == topology.edges()[edge.index()][0];
    corners.len() == 4 && corners.iter().filter(forward).count() == 2
}

fn shortcuts(cut: &Remapped, n: usize) -> Vec<Shortcut> {
    let (graph, mut front) = (cut.mesh.edge_graph(), Frontier::default());
    let copies = cut.remap.origins().iter().enumerate().map(|(i, &vertex)| {
        let detour = graph.between(&mut front, &[VertexId::from(n + i)], &[vertex], f64::INFINITY);
        Shortcut { kind: ShortcutKind::Pinch, vertex, girth: 0.0, detour }
    });
    copies.collect()
}

/// Moves vertices of cuts back into their surfaces if they stick out.
fn restore_positions(split: &mut Remapped, n: usize) {
    let mut cut: Vec<VertexId> = (0..split.remap.origins().len()).map(|i| VertexId::from(n + i)).collect();
    cut.extend(split.remap.origins());
    cut.sort_unstable();
    cut.dedup();
    let topology = split.mesh.topology();
    let moved: Vec<(VertexId, Point3<f64>)> =
        cut.into_iter().filter_map(|v| Some((v, flattened(&split.mesh, &topology, v, PULLED)?))).collect();
    for (v, position) in moved {
        split.mesh.positions[v.index()] = position;
    }
}
