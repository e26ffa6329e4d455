//! Vertices that several parts of a surface share.

use std::collections::{BTreeMap, BTreeSet};

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
    let split = with_copies(mesh, &faces, &origins, &separate);
    // And where its parts meet nearby; a vertex that was pulled out of its surface is not far for that reason.
    let mut far: Vec<bool> = detours(&split, n, detour).map(f64::is_infinite).collect();
    if far.iter().filter(|far| **far).count() > MOST {
        far.fill(false);
    }
    let cut = with_copies(mesh, &split.mesh.faces, split.remap.origins(), &far);
    let shortcut = |(&vertex, detour)| Shortcut { kind: ShortcutKind::Pinch, vertex, girth: 0.0, detour };
    let shortcuts = cut.remap.origins().iter().zip(detours(&cut, n, f64::INFINITY)).map(shortcut).collect();
    CutSurface { cut, shortcuts }
}

/// How far every copy, after the first `n` vertices, is from its origin along edges; infinite beyond the radius.
fn detours(split: &Remapped, n: usize, radius: f64) -> impl Iterator<Item = f64> {
    let (graph, mut front) = (split.mesh.edge_graph(), Frontier::default());
    let copies = (n..).map(VertexId::from).zip(split.remap.origins());
    copies.map(move |(copy, origin)| graph.between(&mut front, &[copy], &[*origin], radius))
}

/// The mesh with those copies of vertices that are `kept`; in `faces`, copies follow the vertices of the mesh. Vertices of the cut that
/// stick out of the surface move back into it.
fn with_copies(mesh: &TriMesh, faces: &[[VertexId; 3]], origins: &[VertexId], kept: &[bool]) -> Remapped {
    let n = mesh.n_vertices();
    let mut left = Vec::new();
    let number = |(&origin, &kept): (&VertexId, &bool)| {
        left.extend(kept.then_some(origin));
        if kept { VertexId::from(n + left.len() - 1) } else { origin }
    };
    let number: Vec<VertexId> = origins.iter().zip(kept).map(number).collect();
    let renumbered = |v: VertexId| if v.index() < n { v } else { number[v.index() - n] };
    let copies = left.iter().map(|origin| mesh.positions[origin.index()]);
    let positions = mesh.positions.iter().copied().chain(copies).collect();
    let faces = faces.iter().map(|face| face.map(renumbered)).collect();
    let mut split = TriMesh { positions, faces };
    let topology = split.topology();
    let cut: BTreeSet<VertexId> =
        left.iter().copied().chain((n..split.n_vertices()).map(VertexId::from)).collect();
    let moved: Vec<(VertexId, Point3<f64>)> =
        cut.into_iter().filter_map(|v| Some((v, flattened(&split, &topology, v, PULLED)?))).collect();
    moved.into_iter().for_each(|(v, position)| split.positions[v.index()] = position);
    Remapped::extended(split, left)
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
    let mut sheets: BTreeMap<u32, Vec<CornerId>> = BTreeMap::new();
    for (i, fan) in (0..).zip(ring.fans()) {
        sheets.entry(sets.find(i)).or_default().extend(fan.corners.iter().map(|corner| corner.corner));
    }
    sheets.into_values().collect()
}

/// Whether an edge has four faces, two in each direction.
fn is_weld(topology: &Topology, edge: EdgeId) -> bool {
    let corners = topology.edge_corners(edge);
    let forward = |c: &&CornerId| topology.corner_vertex(c.next()) == topology.edges()[edge.index()][0];
    corners.len() == 4 && corners.iter().filter(forward).count() == 2
}
