//! Every solver ends early when its budget is exceeded, and never with a result.

use std::time::Duration;

use base::{Budget, Exceeded};
use mesh::shapes;
use surface::VertexId;

use super::all_triangles;
use crate::{DistanceSolver, Exact, FirstSample, GeodesicError, Method, Sampling};

/// Cancels a budget after a delay, while `work` runs.
fn cancelled<T>(budget: &Budget, delay: Duration, work: impl FnOnce() -> T) -> T {
    std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(delay);
            budget.cancel();
        });
        work()
    })
}

#[test]
fn a_cancelled_solver_ends_without_a_result() {
    let surface = shapes::torus(200, 80, 2.0, 0.7).intrinsic();
    for method in Method::all() {
        let expected = method.prepare(&surface, &()).unwrap().distances(VertexId(3)).unwrap();
        for delay in [0, 3, 30] {
            let budget = Budget::unlimited();
            let solver = method.prepare(&surface, &budget).unwrap();
            // Far more work than fits into the delay.
            let sources: Vec<_> = (0..4000).map(VertexId::from).collect();
            let result =
                cancelled(&budget, Duration::from_millis(delay), || solver.distance_columns(&sources));
            assert_eq!(result.unwrap_err(), Exceeded::Cancelled, "{}", method.name());
            let mut out = vec![0.0; surface.n_vertices()];
            assert_eq!(solver.distances_into(VertexId(3), &mut out), Err(Exceeded::Cancelled));
            let again = method.prepare(&surface, &budget).map(|_| ());
            assert_eq!(again, Err(GeodesicError::Exceeded(Exceeded::Cancelled)), "{}", method.name());
        }
        let solver = method.prepare(&surface, &Budget::unlimited()).unwrap();
        assert_eq!(solver.distances(VertexId(3)).unwrap(), expected, "{}", method.name());
    }
}

#[test]
fn samplers_end_with_the_solver_and_continue_with_another() {
    let surface = shapes::torus(120, 50, 2.0, 0.7).intrinsic();
    for sampling in Sampling::ALL {
        let budget = Budget::unlimited();
        let solver = Method::default().prepare(&surface, &budget).unwrap();
        let mut sampler = sampling.start(solver.as_ref(), FirstSample::default(), 5).unwrap();
        let result = cancelled(&budget, Duration::from_millis(20), || sampler.extend_to(6000));
        assert_eq!(result, Err(GeodesicError::Exceeded(Exceeded::Cancelled)), "{sampling:?}");
        // What was complete before is still right.
        let taken = sampler.distances(1).unwrap();
        let source = VertexId::from(taken.landmarks()[0]);
        assert_eq!(
            taken.column(0).unwrap(),
            Method::default().prepare(&surface, &()).unwrap().distances(source).unwrap()
        );
    }
}

#[test]
fn the_exact_solver_keeps_to_its_memory_where_every_edge_has_many_faces() {
    for bytes in [1 << 20, 16 << 20] {
        let budget = Budget::unlimited().with_memory(bytes);
        let solver = Exact::new(&all_triangles(24), &budget);
        match solver.distances(VertexId(0)) {
            Err(Exceeded::Memory { limit, .. }) => assert!(limit <= bytes),
            other => panic!("{other:?}"),
        }
    }
    // Few points need little.
    let few = all_triangles(8);
    let small = Exact::new(&few, &Budget::unlimited().with_memory(256 << 20));
    assert_eq!(small.distances(VertexId(0)), Exact::new(&few, &()).distances(VertexId(0)));
}

#[test]
fn columns_keep_to_the_memory_of_the_budget() {
    let surface = shapes::grid(20, 20, 1.0).intrinsic();
    for method in Method::all() {
        let solver = method.prepare(&surface, &Budget::unlimited().with_memory(1 << 20)).unwrap();
        let sources: Vec<_> = (0..400).map(VertexId::from).collect();
        let needed = 400 * 400 * size_of::<f64>();
        let refused = Exceeded::Memory { needed, limit: 1 << 20 };
        assert_eq!(solver.distance_columns(&sources).unwrap_err(), refused, "{}", method.name());
    }
}
