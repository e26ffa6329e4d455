//! Beside the distances of other implementations on real meshes, which are not part of the project:
//! `CANONFORM_DATA` says where they are, and without them these tests say so and pass.

use std::path::{Path, PathBuf};

use mesh::{IntrinsicMesh, RepairOptions, VertexId, io};
use rayon::prelude::*;

use super::super::Exact;
use super::assert_close;
use crate::{Dijkstra, DistanceSolver};

fn data() -> Option<PathBuf> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let path = std::env::var_os("CANONFORM_DATA").map_or_else(default, PathBuf::from);
    if !path.join("exact").is_dir() {
        println!("skipped: no exact distances in {}", path.display());
        return None;
    }
    Some(path)
}

/// The numbers of a one- or two-dimensional `.npy` file, `N` bytes each.
fn numbers<const N: usize, T>(path: &Path, read: fn([u8; N]) -> T) -> Vec<T> {
    let bytes = std::fs::read(path).unwrap();
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    bytes[header..].as_chunks().0.iter().map(|chunk| read(*chunk)).collect()
}

#[test]
fn distances_are_those_of_mitchell_mount_and_papadimitriou() {
    let Some(data) = data() else { return };
    for (name, mesh) in [
        ("cat0", "tosca-lowres/cat0.vert"),
        ("cat1", "tosca-lowres/cat1.vert"),
        ("centaur1", "tosca-lowres/centaur1.vert"),
        ("centaur2", "tosca-lowres/centaur2.vert"),
        ("horse0", "tosca-lowres/horse0.vert"),
        ("wolf0", "tosca-lowres/wolf0.vert"),
        ("wolf1", "tosca-lowres/wolf1.vert"),
        ("spot", "single/spot.obj"),
        ("rocker-arm", "single/rocker-arm.obj"),
        ("armadillo", "single/armadillo.obj"),
    ] {
        // As it was read: so were the references made.
        let solver = Exact::new(&IntrinsicMesh::from_mesh(&io::read(&data.join(mesh)).unwrap()));
        let sources = numbers(&data.join(format!("exact/{name}-sources.npy")), u32::from_le_bytes);
        let expected = numbers(&data.join(format!("exact/{name}-distances.npy")), f64::from_le_bytes);
        let n = solver.n_vertices();
        for (source, expected) in sources.iter().zip(expected.chunks_exact(n)) {
            for (found, expected) in solver.distances(VertexId(*source)).iter().zip(expected) {
                assert_close(*found, *expected, 1e-12);
            }
        }
    }
}

#[test]
fn every_tosca_mesh_has_symmetric_distances_below_those_along_edges() {
    let Some(data) = data() else { return };
    let folder = std::fs::read_dir(data.join("tosca-lowres")).unwrap();
    let mut paths: Vec<PathBuf> = folder.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "vert"));
    paths.sort();
    let done = paths.par_iter().filter(|path| {
        // One of them is damaged.
        let Ok(read) = io::read(path) else { return false };
        let mesh = mesh::repair(&read, &RepairOptions::default()).unwrap().intrinsic();
        let (solver, dijkstra) = (Exact::new(&mesh), Dijkstra::new(&mesh));
        let n = mesh.n_vertices();
        let (v, w) = (VertexId::from(n / 7), VertexId::from(n / 2));
        let (from_v, from_w) = (solver.distances(v), solver.distances(w));
        assert_close(from_v[w.index()], from_w[v.index()], 1e-10);
        for (found, along_edges) in from_v.iter().zip(dijkstra.distances(v)) {
            assert!(found.is_finite() && *found <= along_edges * (1.0 + 1e-14), "{}", path.display());
        }
        for (ends, length) in mesh.topology().edges().iter().zip(mesh.edge_lengths()) {
            let [a, b] = ends.map(|v| from_v[v.index()]);
            assert!((a - b).abs() <= length + 1e-9 * a, "{}", path.display());
        }
        true
    });
    assert_eq!(done.count(), 147);
}
