//! Faces that all turn the same way, outwards if there is an outside.

use nalgebra::Vector3;
use surface::{EdgeId, Topology, VertexId};

use crate::orientation::{has_same_direction, orient_consistently};
use crate::tri_mesh::TriMesh;

/// A surface encloses a volume if it is at least this share of the volume of a ball of the same area. A safety limit: a flat
/// sheet encloses none.
const MIN_VOLUME: f64 = 0.02;

/// Share of edges whose two faces may turn in opposite ways, as non-manifold edges of scans make them. A
/// tolerance.
const TOLERATED: f64 = 0.01;

/// The signed volume of a mesh over that of a ball of the same area.
fn volume(mesh: &TriMesh) -> f64 {
    let sum: Vector3<f64> = mesh.positions.iter().map(|p| p.coords).sum();
    let center = sum / mesh.n_vertices().max(1) as f64;
    let positions = mesh.positions.iter().map(|p| p - center).collect();
    let volume = TriMesh { positions, faces: mesh.faces.clone() }.signed_volume();
    volume / (mesh.area().powf(1.5) / (6.0 * std::f64::consts::PI.sqrt()))
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
    let all = (0..topology.n_edges()).map(|e| topology.edge_corners(EdgeId::from(e)));
    let inner = all.filter_map(|corners| <[_; 2]>::try_from(corners).ok());
    let (n_twisted, n_inner) = inner.fold((0.0, 0.0), |(twisted, n), [a, b]| {
        (twisted + f64::from(has_same_direction(&topology, a, b)), n + 1.0)
    });
    (n_twisted <= TOLERATED * n_inner).then(|| topology.faces().to_vec())
}
