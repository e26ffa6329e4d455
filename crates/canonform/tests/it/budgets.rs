//! Every entry point ends early when its budget is exceeded, and never with a wrong result.

use std::time::Duration;

use canonform::embed::{EmbedMethod, FormOptions, Samples, SharedStress, StressOptions, embed};
use canonform::geodesics::Method;
use canonform::library::{BuildOptions, build_index};
use canonform::mesh::shapes;
use canonform::search::{SearchOptions, ShapeSearch};
use canonform::{Budget, DescribeOptions, Error, Exceeded, Remedy, Surface, describe};

/// Runs `work` with a budget that is cancelled after a delay, for some delays. The work must end with the expected result
/// or as cancelled.
fn assert_cancellable<T: PartialEq + std::fmt::Debug>(
    name: &str,
    work: impl Fn(&Budget) -> Result<T, Error> + Sync,
) {
    let expected = work(&Budget::unlimited()).unwrap();
    for delay in [0, 5, 60].map(Duration::from_millis) {
        let budget = Budget::unlimited();
        let result = std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(delay);
                budget.cancel();
            });
            work(&budget)
        });
        match result {
            Ok(found) => assert_eq!(found, expected, "{name}"),
            Err(Error::Exceeded(Exceeded::Cancelled)) => {}
            Err(other) => panic!("{name}: {other:?}"),
        }
    }
    let cancelled = Budget::unlimited();
    cancelled.cancel();
    assert!(matches!(work(&cancelled), Err(Error::Exceeded(Exceeded::Cancelled))), "{name}");
    let limit = Duration::ZERO;
    let late = work(&Budget::unlimited().with_time(limit)).unwrap_err();
    assert!(matches!(late, Error::Exceeded(Exceeded::Time { .. })), "{name}: {late:?}");
    assert_eq!(late.remedy(), Some(Remedy::RaiseTimeLimit));
}

fn torus(n: usize) -> Surface {
    Surface::new(&shapes::torus(2 * n, n, 2.0, 0.7), &Default::default(), &()).unwrap()
}

#[test]
fn every_embedding_is_cancellable() {
    let surface = torus(24);
    for method in EmbedMethod::all() {
        let name = method.name();
        let options = FormOptions { method, samples: Samples::Count(60), ..FormOptions::default() };
        assert_cancellable(name, |budget| Ok(embed(&surface, &options, budget)?.embedding.coords));
    }
}

#[test]
fn describing_searching_and_comparing_methods_are_cancellable() {
    let surface = torus(30);
    let options = DescribeOptions::default();
    assert_cancellable("describe", |budget| describe(&surface, &options, budget));

    let folder = tempfile::tempdir().unwrap();
    for n in 0..8u32 {
        let mesh = shapes::torus(20 + 2 * n as usize, 11, 2.0, 0.4 + 0.05 * f64::from(n));
        canonform::mesh::io::write(&folder.path().join(format!("ring{n}.off")), &mesh).unwrap();
    }
    let path = folder.path().join("rings.canonform");
    let build = BuildOptions::new(&options);
    build_index(folder.path(), &path, &build, &()).unwrap();
    let (search, query) = (ShapeSearch::open(&path).unwrap(), shapes::torus(23, 12, 2.0, 0.5));
    assert_cancellable("search", |budget| {
        let options = SearchOptions::default();
        let query = search.query(&query, ("a ring", None), &options, budget)?;
        let report = search.search(&query, &options, budget)?;
        Ok(report.results.into_iter().map(|hit| (hit.id, hit.distance.to_bits())).collect::<Vec<_>>())
    });

    let form = FormOptions::default();
    let embedded = embed(&surface, &form, &()).unwrap();
    assert_cancellable("shared stress", |budget| {
        SharedStress::new(&surface, Method::Exact, &StressOptions::default(), budget)?
            .measure(&embedded.embedding.coords)
    });
}

#[test]
fn distances_and_eigenpairs_keep_to_the_memory_of_the_budget() {
    let surface = torus(40);
    for method in EmbedMethod::all() {
        let options = FormOptions { method, samples: Samples::Count(200), ..FormOptions::default() };
        let small = Budget::unlimited().with_memory(1 << 20);
        let refused = embed(&surface, &options, &small).unwrap_err();
        assert!(matches!(refused, Error::Exceeded(Exceeded::Memory { .. })), "{refused:?}");
        assert_eq!(refused.remedy(), Some(Remedy::RaiseMemory));
    }
    let described = |bytes| {
        describe(&surface, &DescribeOptions::default(), &Budget::unlimited().with_memory(bytes)).is_ok()
    };
    assert_eq!([1 << 20, 100 << 20].map(described), [false, true]);
}

#[test]
fn arguments_beyond_the_surface_are_clamped_to_it() {
    let mesh = shapes::icosphere(2);
    let surface = Surface::new(&mesh, &Default::default(), &()).unwrap();
    let all = surface.mesh().n_vertices();
    let options = FormOptions { samples: Samples::Count(usize::MAX), ..FormOptions::default() };
    assert_eq!(embed(&surface, &options, &()).unwrap().report.n_samples, all);
    let eigenvectors = |eigenvectors| {
        let method = EmbedMethod::Spectral { eigenvectors, mu: f64::INFINITY };
        let options = FormOptions { method, samples: Samples::Count(100), ..FormOptions::default() };
        embed(&surface, &options, &()).unwrap().embedding.coords
    };
    assert_eq!(eigenvectors(usize::MAX), eigenvectors(all));
}
