//! What a search finds depends on the shapes alone: not on how many results are wanted, nor on what counts as mechanical.

use std::path::Path;

use canonform::DescribeOptions;
use canonform::library::{BuildOptions, build_index};
use canonform::search::{Answer, Hit, SearchOptions, SearchRank, ShapeSearch, merge_answers, n_results};
use datasets::{CreatureOptions, Damage, PartMesh, creatures, mechanical_parts};
use descriptors::{ShapeMetric, ShapePair};
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
            // Beyond the neighbours of a shape, the graph is looked at as far as results are wanted.
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
        // Other processes find the same.
        let query = search.query_of(id, &SearchOptions::default(), &()).unwrap();
        for k in [1, 7] {
            let options = SearchOptions { k: n_results(k), ..SearchOptions::default() };
            let answer = search.search_among(&query, None, &options, &()).unwrap();
            let merged = merge_answers(&query, vec![answer], search.index().threshold(), k);
            assert_eq!((&merged.results[..], &merged.predicted), (&all.results[..k], &all.predicted));
        }
    }
}

#[test]
fn a_rigid_signature_makes_no_shape_farther_from_one_without() {
    let parts = mechanical_parts(0, 16);
    let mut shapes = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        let mesh = mesh::refine(
            &part.mesh(&PartMesh::default()),
            part.mesh(&PartMesh::default()).root_of_area() / 12.0,
            20_000,
        )
        .mesh;
        shapes.push((format!("part{i:02}"), mesh.clone()));
        shapes.push((format!("noisy{i:02}"), Damage::Noise(0.0005).apply(&mesh, 7)));
    }
    let folder = tempfile::tempdir().unwrap();
    let search = indexed(folder.path(), &shapes);
    let has_rigid = |id: &str| !search.prepared(id).unwrap().rigid().is_empty();
    let flipped: Vec<usize> = (0..parts.len())
        .filter(|i| has_rigid(&format!("part{i:02}")) && !has_rigid(&format!("noisy{i:02}")))
        .collect();
    // How many depends on what counts as mechanical; the law is about every one.
    assert!(!flipped.is_empty());
    for i in flipped {
        let [part, noisy] = ["part", "noisy"].map(|kind| search.prepared(&format!("{kind}{i:02}")).unwrap());
        assert_eq!(part.robust(&noisy), ShapeMetric::robust(part.fused(), noisy.fused()), "part {i}");
    }
}

/// A closed vessel of revolution about the z axis, of profiles as households have them: `class` is its form, `number` its proportions.
fn vessel(class: usize, number: usize) -> TriMesh {
    let share = |step: usize| ((number * step + 3) % 11) as f64 / 10.0;
    let (wide, tall) = (0.8 + 0.6 * share(3), 1.0 + share(7));
    // Radii from the foot to the rim, and heights.
    let outside: Vec<[f64; 2]> = (0..=14)
        .map(|i| f64::from(i) / 14.0)
        .map(|t| match class {
            0 => [wide * (0.35 + 0.65 * t.sqrt()), 0.7 * tall * t],
            1 => [wide * (0.5 + 0.3 * share(5) * (6.0 * t).sin()), 2.0 * tall * t],
            2 => [wide * if t < 0.6 { 0.6 } else { 0.6 - 0.9 * (t - 0.6) }, 2.4 * tall * t],
            _ => [wide * (0.6 + 1.2 * t), 0.2 * tall * t],
        })
        .collect();
    let inside = outside.iter().rev().map(|[r, z]| [0.85 * r, 0.05 + 0.95 * z]);
    let profile: Vec<[f64; 2]> = outside.iter().copied().chain(inside).collect();
    let mut mesh = mesh::shapes::cylinder(24, profile.len(), 1.0, 1.0);
    for (ring, [r, z]) in mesh.positions.chunks_mut(24).zip(&profile) {
        ring.iter_mut().for_each(|p| (p.x, p.y, p.z) = (r * p.x, r * p.y, *z));
    }
    mesh
}

#[test]
#[ignore = "slow: make test-all"]
fn classes_of_a_household_are_as_wide_as_they_are() {
    let name = |i: usize| format!("{}{}", ["bowl", "vase", "bottle", "plate"][i / 10], i % 10);
    let shapes: Vec<_> = (0..40).map(|i| (name(i), vessel(i / 10, i % 10))).collect();
    let folder = tempfile::tempdir().unwrap();
    let search = indexed(folder.path(), &shapes);
    let hits = shapes.iter().flat_map(|(id, _)| {
        found(&search, id, 40, SearchRank::Plain).results.into_iter().skip(1).map(move |hit| (id, hit))
    });
    let of_class = |(id, hit): &(&String, Hit)| id.starts_with(&hit.label);
    let (mut pairs, mut denied, mut denied_elsewhere) = (0, 0, 0);
    for (_, hit) in hits.filter(of_class) {
        let elsewhere = 1.0 - ShapeMetric::SAME_CLASS.probability(hit.distance);
        pairs += 1;
        denied += usize::from(1.0 - hit.relation.evidence.same_class >= 0.9);
        denied_elsewhere += usize::from(elsewhere >= 0.9);
    }
    println!(
        "{denied} of {pairs} pairs of one class are of two at 90 %, {denied_elsewhere} by the boundary of creatures"
    );
    assert!(pairs == 360 && (denied as f64) < 0.05 * f64::from(pairs));
}
