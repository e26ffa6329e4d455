//! Work stays on the threads that the caller provides.

use std::process::Command;

use canonform::DescribeOptions;
use canonform::library::{BuildOptions, build_index};
use canonform::mesh::{io, shapes};
use canonform::search::{SearchOptions, ShapeSearch};
use rayon::ThreadPoolBuilder;

/// Set in the process that runs nothing but the test below.
const ALONE: &str = "CANONFORM_TEST_ALONE";

/// Runs in a process of its own: the global pool starts with its first use, and then cannot be built any more.
#[test]
fn an_index_is_built_and_searched_on_the_pool_of_the_caller() {
    if std::env::var_os(ALONE).is_none() {
        let name = "threads::an_index_is_built_and_searched_on_the_pool_of_the_caller";
        let mut program = Command::new(std::env::current_exe().unwrap());
        let run = program.args(["--exact", name]).env(ALONE, "1").output().unwrap();
        let text =
            [run.stdout, run.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
        assert!(run.status.success() && text.contains("1 passed"), "{text}");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let index = folder.path().join("shapes.canonform");
    let describe = DescribeOptions::default();
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let nearest = pool.install(|| {
        let ring = shapes::torus(24, 12, 2.0, 0.7);
        io::write(&folder.path().join("ball1.off"), &shapes::icosphere(2)).unwrap();
        io::write(&folder.path().join("ring1.off"), &ring).unwrap();
        let report = build_index(folder.path(), &index, &BuildOptions::new(&describe), &()).unwrap();
        assert_eq!(report.described, 2, "{report:?}");
        let (search, options) = (ShapeSearch::open(&index).unwrap(), SearchOptions::default());
        let query = search.query(&ring, ("a ring", None), &options, &()).unwrap();
        search.search(&query, &options, &()).unwrap().results[0].id.clone()
    });
    assert_eq!(nearest, "ring1");
    assert!(ThreadPoolBuilder::new().build_global().is_ok(), "some work ran on the global pool");
}
