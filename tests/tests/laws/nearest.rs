//! What a search finds depends on the shapes alone: not on how many results are wanted, nor on what counts as mechanical.

use std::path::Path;

use canonform::DescribeOptions;
use canonform::library::{BuildOptions, build_index};
use canonform::search::{Answer, Hit, SearchOptions, SearchRank, ShapeSearch};
use datasets::{CreatureOptions, Damage, creatures};
use descriptors::ShapePair;
use mesh::TriMesh;
use rayon::prelude::*;

fn indexed(folder: &Path, shapes: &[(String, TriMesh)]) -> ShapeSearch {
    let write = |(name, mesh): &(String, TriMesh)| mesh_io::write(&folder.join(format!("{name}.off")), mesh);
    shapes.iter().try_for_each(write).unwrap();
    let path = folder.join("all.canonform");
    build_index(folder, &path, &BuildOptions::new(&DescribeOptions::default()), &()).unwrap();
    ShapeSearch::open(&path).unwrap()
}

fn found(search: &ShapeSearch, id: &str, k: usize, rank_by: SearchRank) -> Answer {
    let options = SearchOptions { k, rank_by, ..SearchOptions::default() };
    search.search(&search.query_of(id, &options, &()).unwrap(), &options, &()).unwrap()
}

#[test]
#[ignore = "slow: make test-all"]
fn the_results_for_a_number_of_results_are_the_first_of_those_for_a_larger_one() {
    let options = CreatureOptions { n_families: 28, n_poses: 2, n_vertices: 1000, ..Default::default() };
    let shapes: Vec<(String, TriMesh)> = creatures(&options)
        .unwrap()
        .into_par_iter()
        .map(|shape| (shape.name, Damage::Decimate(0.25).apply(&shape.mesh, 1)))
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let search = indexed(folder.path(), &shapes);
    let n = shapes.len();
    let prepared: Vec<_> = shapes.iter().map(|(id, _)| search.prepared(id).unwrap()).collect();
    for query in [0, 9, 21, 34, 55] {
        let id = &shapes[query].0;
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
        // The order is that of all distances.
        let mut expected: Vec<(f64, &str)> = (0..n)
            .into_par_iter()
            .map(|i| {
                let pair = ShapePair::new([&prepared[query], &prepared[i]]);
                (pair.distance().combined, shapes[i].0.as_str())
            })
            .collect();
        expected.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(b.1)));
        let all = found(&search, id, n, SearchRank::Plain);
        let key = |hit: &Hit| (hit.distance, hit.id.clone());
        let expected: Vec<(f64, String)> = expected.into_iter().map(|(d, id)| (d, id.to_owned())).collect();
        assert_eq!(all.results.iter().map(key).collect::<Vec<_>>(), expected, "{id}");
    }
}
