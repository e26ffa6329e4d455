//! Faces that all turn the same way, outwards if there is an outside.

use nalgebra::Vector3;
use surface::{DisjointSets, EdgeId, Topology, VertexId};

use crate::orientation::{has_same_direction, orient_consistently};
use crate::tri_mesh::TriMesh;

/// A surface encloses a volume if it is at least this share of the volume of a ball of the same area. A safety limit: a flat
/// sheet encloses none.
const MIN_VOLUME: f64 = 0.02;

/// Edges in a row whose two faces turn in opposite ways, relative to the square root of the number of all edges with two faces,
/// that defects of scans may have. A convention: the row across a band of evenly spread vertices is longer, unless the band is
/// more than a hundred times as long as it is wide.
const TOLERATED: f64 = 0.05;

/// The signed volume of a mesh over that of a ball of the same area.
fn volume(mesh: &TriMesh) -> f64 {
    let sum: Vector3<f64> = mesh.positions.iter().map(|p| p.coords).sum();
    let center = sum / mesh.n_vertices().max(1) as f64;
    mesh.moved(|p| p - center).signed_volume() / (mesh.area().powf(1.5) / (6.0 * std::f64::consts::PI.sqrt()))
}

/// The mesh with its faces turned alike.
fn turned_alike(mesh: &TriMesh) -> (TriMesh, f64) {
    let mut mesh = mesh.clone();
    orient_consistently(&mut mesh);
    let volume = volume(&mesh);
    if volume < -MIN_VOLUME {
        mesh.faces.iter_mut().for_each(|face| face.swap(1, 2));
    }
    (mesh, volume)
}

/// The mesh with its normals outwards; `None` if it does not enclose a volume.
pub fn outward(mesh: &TriMesh) -> Option<TriMesh> {
    let (mesh, volume) = turned_alike(mesh);
    (volume.abs() >= MIN_VOLUME).then_some(mesh)
}

/// The faces, turned alike: outwards if the mesh encloses a volume, else as most of them are. `None` if the surface cannot
/// be oriented, such as a Moebius strip.
pub fn oriented_faces(mesh: &TriMesh) -> Option<Vec<[VertexId; 3]>> {
    let (mesh, _) = turned_alike(mesh);
    let topology = Topology::new(mesh.n_vertices(), mesh.faces);
    // Twisted edges, by an end, and the vertices that they join.
    let (mut twisted, mut rows) = (Vec::new(), DisjointSets::new(topology.n_vertices()));
    let mut n_inner = 0;
    for (e, [a, b]) in topology.edges().iter().enumerate() {
        let &[one, other] = topology.edge_corners(EdgeId::from(e)) else { continue };
        n_inner += 1;
        if has_same_direction(&topology, one, other) {
            rows.union(a.0, b.0);
            twisted.push(a.0);
        }
    }
    let mut lengths = vec![0; topology.n_vertices()];
    twisted.into_iter().for_each(|v| lengths[rows.find(v) as usize] += 1);
    let longest = lengths.into_iter().max().unwrap_or(0);
    (f64::from(longest) <= TOLERATED * f64::from(n_inner).sqrt()).then(|| topology.into_faces())
}
