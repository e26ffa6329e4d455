//! Comparison with exact distances on real meshes.

use super::vertex;
use crate::tests::{Reference, assert_close, reference};
use crate::{DistanceSolver, FastMarching, PathTracer, Source};

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
