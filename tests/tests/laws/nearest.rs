//! What a search finds does not depend on how many results are wanted.

use canonform::DescribeOptions;
use canonform::library::{BuildOptions, build_index};
use canonform::search::{Answer, SearchOptions, SearchRank, ShapeSearch};
use datasets::{CreatureOptions, Damage, LabeledShape, creatures};
use rayon::prelude::*;

fn found(search: &ShapeSearch, id: &str, k: usize, rank_by: SearchRank) -> Answer {
    let options = SearchOptions { k, rank_by, ..SearchOptions::default() };
    search.search(&search.query_of(id, &options, &()).unwrap(), &options, &()).unwrap()
}

#[test]
#[ignore = "slow: make test-all"]
fn the_results_for_a_number_of_results_are_the_first_of_those_for_a_larger_one() {
    let options = CreatureOptions { n_families: 28, n_poses: 2, n_vertices: 1000, ..Default::default() };
    let folder = tempfile::tempdir().unwrap();
    let write = |shape: LabeledShape| {
        let mesh = Damage::Decimate(0.25).apply(&shape.mesh, 1);
        mesh_io::write(&folder.path().join(format!("{}.off", shape.name)), &mesh).unwrap();
        shape.name
    };
    let names: Vec<String> = creatures(&options).unwrap().into_par_iter().map(write).collect();
    let (n, path) = (names.len(), folder.path().join("all.canonform"));
    build_index(folder.path(), &path, &BuildOptions::new(&DescribeOptions::default()), &()).unwrap();
    let search = ShapeSearch::open(&path).unwrap();
    for query in [0, 9, 21, 34, 55] {
        let id = &names[query];
        for rank_by in [SearchRank::Plain, SearchRank::Graph, SearchRank::Forms] {
            // Beyond the neighbors of a shape, the graph is looked at as far as results are wanted.
            let most = if rank_by == SearchRank::Graph { 24 } else { n };
            let all = found(&search, id, most, rank_by);
            assert_eq!((all.results.len(), all.measured, all.recall), (most, n, 1.0));
            for k in [1, 2, 3, 5, 8, 20, 41].into_iter().filter(|k| *k <= most) {
                let some = found(&search, id, k, rank_by);
                assert_eq!(some.results, all.results[..k], "{id}, {rank_by:?}, {k}");
                assert_eq!(some.predicted, all.predicted, "{id}, {rank_by:?}, {k}");
            }
        }
    }
}
