//! Comparison with other programs on real meshes.

use mesh::TriMesh;
use surface::{SurfacePoint, VertexId};

use super::assert_close;
use crate::{DistanceSolver, Exact, Method, PathTracer, Source};

/// Requires paths to be as long as exact distances.
fn assert_paths(mesh: &TriMesh, source: VertexId, exact: &[f64]) {
    let (surface, sources) = (mesh.intrinsic(), [Source::vertex(source)]);
    let tracer = PathTracer::new(&surface, &sources, exact, &());
    for (v, distance) in exact.iter().enumerate().step_by(23).filter(|(_, d)| **d > 0.0) {
        let target = SurfacePoint::Vertex(VertexId::from(v));
        assert_close(tracer.path_to(target).unwrap().length, *distance, 1e-11);
    }
}

#[test]
fn errors_on_real_meshes_are_no_larger_than_those_of_other_programs() {
    let Some(data) = testkit::data("") else { return };
    let pose = Some([0.004, 0.1]);
    // Mean and largest relative error: of fast marching, without the one-ring of the source; of the heat method of potpourri3d 1.4
    // on the same sources. And whether paths are compared.
    for (name, marching, heat, has_paths) in [
        ("tosca-lowres/cat0.vert", pose, Some([0.0214, 0.460]), true),
        ("tosca-lowres/cat1.vert", pose, Some([0.0202, 0.387]), false),
        ("tosca-lowres/centaur1.vert", pose, None, true),
        ("tosca-lowres/centaur2.vert", None, None, false),
        ("tosca-lowres/horse0.vert", pose, Some([0.0193, 0.596]), false),
        ("tosca-lowres/wolf0.vert", pose, Some([0.0186, 0.285]), false),
        ("tosca-lowres/wolf1.vert", None, Some([0.0189, 0.414]), false),
        ("single/spot.obj", Some([0.005, f64::INFINITY]), Some([0.0212, 0.405]), true),
        ("single/rocker-arm.obj", None, Some([0.0176, 0.378]), true),
        ("single/armadillo.obj", Some([0.0025, f64::INFINITY]), Some([0.0091, 0.368]), false),
    ] {
        // Without repairs, as for the references by the algorithm of Mitchell, Mount and Papadimitriou.
        let path = data.join(name);
        let mesh = mesh_io::read(&path).unwrap();
        let file = |what| data.join(format!("exact/{}-{what}.npy", path.file_stem().unwrap().display()));
        let sources = testkit::array(&file("sources")).1.into_iter().map(VertexId);
        let (_, distances) = testkit::array::<f64>(&file("distances"));
        let rows = sources.zip(distances.chunks_exact(mesh.n_vertices()));

        let surface = mesh.intrinsic();
        let solver = Exact::new(&surface, &());
        for (source, expected) in rows.clone() {
            for (found, expected) in solver.distances(source).unwrap().iter().zip(expected) {
                assert_close(*found, *expected, 1e-12);
            }
        }
        let methods = [(Method::default(), marching), (Method::Heat(Default::default()), heat)];
        for (i, (method, limits)) in methods.into_iter().enumerate() {
            let Some([most, largest]) = limits else { continue };
            let solver = method.prepare(&surface, &()).unwrap();
            let (mut sum, mut count, mut worst) = (0.0, 0, 0.0f64);
            for (source, exact) in rows.clone() {
                let found = solver.distances(source).unwrap();
                for v in (0..found.len()).filter(|v| exact[*v] > 0.0 && exact[*v].is_finite()) {
                    let error = (found[v] - exact[v]).abs() / exact[v];
                    let is_near = surface.topology().edge_between(source, VertexId::from(v)).is_some();
                    worst = if i == 0 && is_near { worst } else { worst.max(error) };
                    (sum, count) = (sum + error, count + 1);
                }
            }
            let mean = sum / f64::from(count);
            assert!(mean <= most && worst <= largest, "{name}, {}: {mean} {worst}", method.name());
        }
        rows.take(1).filter(|_| has_paths).for_each(|(source, exact)| assert_paths(&mesh, source, exact));
    }
}
