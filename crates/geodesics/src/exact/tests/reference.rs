//! Comparison with other implementations on real meshes.

use std::path::PathBuf;

use mesh::{RepairOptions, io};
use rayon::prelude::*;
use surface::VertexId;

use super::super::Exact;
use crate::testing::{Reference, assert_close, data, reference};
use crate::{Dijkstra, DistanceSolver};

#[test]
fn distances_equal_those_of_other_implementations() {
    let Some(data) = data() else { return };
    for mesh in [
        "tosca-lowres/cat0.vert",
        "tosca-lowres/cat1.vert",
        "tosca-lowres/centaur1.vert",
        "tosca-lowres/centaur2.vert",
        "tosca-lowres/horse0.vert",
        "tosca-lowres/wolf0.vert",
        "tosca-lowres/wolf1.vert",
        "single/spot.obj",
        "single/rocker-arm.obj",
        "single/armadillo.obj",
    ] {
        let Reference { mesh, rows } = reference(&data, mesh);
        let solver = Exact::new(&mesh.intrinsic());
        for (source, expected) in &rows {
            for (found, expected) in solver.distances(*source).unwrap().iter().zip(expected) {
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
        let (from_v, from_w) = (solver.distances(v).unwrap(), solver.distances(w).unwrap());
        assert_close(from_v[w.index()], from_w[v.index()], 1e-10);
        for (found, along_edges) in from_v.iter().zip(dijkstra.distances(v).unwrap()) {
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
