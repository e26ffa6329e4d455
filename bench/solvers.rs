//! Time per source of every solver and of farthest point sampling, over sizes: `make bench`.
//!
//! `bench/peers.py` compares them with other programs.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use geodesics::{FirstSample, HeatOptions, Method, Sampling};
use mesh::shapes;
use surface::{IntrinsicMesh, VertexId};

/// A torus of about `n_vertices` vertices, with triangles of many shapes.
fn torus(n_vertices: usize) -> IntrinsicMesh {
    let around = ((n_vertices / 3) as f64).sqrt().round() as usize;
    shapes::torus(n_vertices / around, around, 3.0, 1.0).intrinsic()
}

/// Another source for each run, as samples are: a processor learns the branches of a front that is repeated.
fn sources(surface: &IntrinsicMesh) -> impl Iterator<Item = VertexId> {
    let n = surface.n_vertices();
    (0..).map(move |run: usize| VertexId::from(run * 7919 % n))
}

fn solvers(criterion: &mut Criterion) {
    let methods = [
        (Method::default(), 1_000_000),
        (Method::Dijkstra, 1_000_000),
        (Method::Heat(HeatOptions::default()), 64_000),
        (Method::Exact, 64_000),
    ];
    for (method, largest) in methods {
        let mut group = criterion.benchmark_group(method.name());
        group.sample_size(10);
        for size in [4_000, 16_000, 64_000, 256_000, 1_000_000] {
            if size > largest {
                continue;
            }
            let surface = torus(size);
            let Ok(solver) = method.prepare(&surface, &()) else { continue };
            let (mut out, mut sources) = (vec![0.0; surface.n_vertices()], sources(&surface));
            group.bench_function(BenchmarkId::new("source", size), |bencher| {
                bencher
                    .iter(|| sources.by_ref().take(1).try_for_each(|v| solver.distances_into(v, &mut out)));
            });
        }
    }
}

/// Ten samples with their distances, compared with one full map, on one thread and on two.
fn sampling(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sampling");
    group.sample_size(10);
    let surface = torus(28_000);
    let Ok(solver) = Method::default().prepare(&surface, &()) else { return };
    let (mut out, mut sources) = (vec![0.0; surface.n_vertices()], sources(&surface));
    group.bench_function("one full map", |bencher| {
        bencher.iter(|| sources.by_ref().take(1).try_for_each(|v| solver.distances_into(v, &mut out)));
    });
    for threads in [1, 2] {
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else { continue };
        for (name, first) in [
            ("given first sample", FirstSample::Vertex(VertexId(0))),
            ("farthest first", FirstSample::Farthest),
        ] {
            group.bench_function(BenchmarkId::new(format!("ten samples, {name}"), threads), |bencher| {
                let sampled = || Sampling::Farthest.start(solver.as_ref(), first, 0)?.into_distances(10);
                pool.install(|| bencher.iter(sampled));
            });
        }
    }
}

criterion_group!(benches, solvers, sampling);
criterion_main!(benches);
