//! Comparison with exact distances on real meshes.

use mesh::{RepairOptions, repair};
use rayon::prelude::*;
use surface::VertexId;

use super::vertex;
use crate::tests::{Reference, assert_close, reference};
use crate::{Dijkstra, DistanceSolver, Exact, FastMarching, PathTracer, Source};

#[test]
fn lengths_of_paths_equal_exact_distances() {
    let Some(data) = testkit::data("") else { return };
    for mesh in
        ["tosca-lowres/cat0.vert", "tosca-lowres/centaur1.vert", "single/spot.obj", "single/rocker-arm.obj"]
    {
        let Reference { mesh, rows } = reference(&data, mesh);
        let surface = mesh.intrinsic();
        let marching = FastMarching::new(&surface, Default::default(), &());
        for (source, exact) in rows.iter().take(1) {
            let sources = [Source::vertex(*source)];
            let tracer = PathTracer::new(&surface, &sources, exact, &());
            let marched = marching.distances(*source).unwrap();
            let rough = PathTracer::new(&surface, &sources, &marched, &());
            let (mut excess, mut count) = (0.0, 0);
            for (v, distance) in exact.iter().enumerate().step_by(23).filter(|(_, d)| **d > 0.0) {
                assert_close(tracer.path_to(vertex(v)).unwrap().length, *distance, 1e-11);
                let length = rough.path_to(vertex(v)).unwrap().length;
                assert!(length >= distance * (1.0 - 1e-11));
                excess += length / distance - 1.0;
                count += 1;
            }
            // Several times closer than the distances that led there.
            assert!(excess / f64::from(count) < 1e-3, "{excess}");
        }
    }
}

#[test]
fn exact_distances_on_every_tosca_mesh_are_symmetric_and_those_of_their_paths() {
    let Some(data) = testkit::data("") else { return };
    let mut paths: Vec<_> =
        std::fs::read_dir(data.join("tosca-lowres")).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "vert"));
    let done = paths.par_iter().filter(|path| {
        // One of them is damaged.
        let Ok(read) = mesh_io::read(path) else { return false };
        let mesh = repair(&read, &RepairOptions::default(), &()).unwrap().intrinsic;
        let n = mesh.n_vertices();
        let [source, other] = [n / 3, n / 2].map(VertexId::from);
        let solver = Exact::new(&mesh, &());
        let [exact, back] = [source, other].map(|v| solver.distances(v).unwrap());
        assert_close(exact[other.index()], back[source.index()], 1e-10);
        for (ends, length) in mesh.topology().edges().iter().zip(mesh.edge_lengths()) {
            let [a, b] = ends.map(|v| exact[v.index()]);
            assert!((a - b).abs() <= length + 1e-9 * a, "{}", path.display());
        }
        let along_edges = Dijkstra::new(&mesh, &()).distances(source).unwrap();
        let sources = [Source::vertex(source)];
        let tracer = PathTracer::new(&mesh, &sources, &exact, &());
        for v in (0..n).step_by(97) {
            assert_close(tracer.path_to(vertex(v)).unwrap().length, exact[v], 1e-10);
        }
        let is_bounded = |(d, bound): (&f64, &f64)| d.is_finite() && *d <= bound * (1.0 + 1e-14);
        assert!(exact.iter().zip(&along_edges).all(is_bounded), "{}", path.display());
        true
    });
    assert_eq!(done.count(), 147);
}
