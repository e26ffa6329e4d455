//! What an index states of the hits of a search is true of as many as it says.

use canonform::index::{Entry, IndexWriter, Shape};
use canonform::library::{EvaluateOptions, evaluate_index};
use canonform::search::{Query, SearchOptions, ShapeSearch};
use canonform::{DescribeOptions, describe};
use datasets::{CreatureOptions, Damage, creature_body};
use index::ContentHash;
use rayon::prelude::*;

use crate::support::surface;

/// Plans of creatures; two families of each, four bodies of each family, two poses of each body.
const PLANS: usize = 14;

/// Classes of an index.
const CLASSES: usize = 10;

/// A creature of a plan and a family, at one of two resolutions. The boundaries of the metric are fitted to other families.
fn creature(number: usize) -> (usize, usize, Shape) {
    let (family, body, pose) = (number / 8, number % 8 / 2, number % 2);
    let plan = 2 * (family % PLANS);
    let options = CreatureOptions { seed: 11, n_vertices: 1000, ..Default::default() };
    let followed = plan + 28 * (family / PLANS);
    let mesh = creature_body(followed, body, 1 + 2 * body + pose, &options, &()).unwrap().mesh;
    let mesh = if (number * 7 / 3).is_multiple_of(2) { Damage::Decimate(0.35).apply(&mesh, 0) } else { mesh };
    let mut shape = describe(&surface(&mesh), &DescribeOptions::default(), &()).unwrap();
    shape.entry.id = format!("creature{number}");
    shape.entry.content = ContentHash::of(&[&shape.entry.id]);
    (plan, family, shape)
}

/// What an index of some shapes of each class states of the ten hits of others: the probability of one class, and whether they are.
fn stated(classes: &[Vec<&Shape>], n_indexed: usize) -> Vec<(f64, bool)> {
    let folder = tempfile::tempdir().unwrap();
    let (path, describe) = (folder.path().join("all.canonform"), DescribeOptions::default());
    let labelled = |(class, shapes): (usize, &Vec<&Shape>)| -> Vec<Shape> {
        let of = |shape: &&Shape| Shape {
            entry: Entry { label: format!("class{class}"), ..shape.entry.clone() },
            ..(*shape).clone()
        };
        shapes.iter().map(of).collect()
    };
    let (mut indexed, mut queries) = (Vec::new(), Vec::new());
    for mut shapes in classes.iter().enumerate().map(labelled) {
        queries.extend(shapes.split_off(n_indexed));
        indexed.extend(shapes);
    }
    let mut writer = IndexWriter::build(&path, &describe.text()).unwrap();
    writer.put(&indexed).unwrap();
    writer.finish().unwrap();
    let classes = evaluate_index(&path, &EvaluateOptions::default(), &()).unwrap().agreement;
    assert!(classes.is_some());
    let (search, options) =
        (ShapeSearch::open(&path).unwrap(), SearchOptions { classes, ..Default::default() });
    let hits = |query: Shape| {
        let label = query.entry.label.clone();
        let answer = search.search(&Query::new(query, &describe), &options, &()).unwrap();
        let hit =
            answer.results.into_iter().map(|hit| (hit.relation.evidence.same_class, hit.label == label));
        hit.collect::<Vec<_>>()
    };
    queries.into_iter().flat_map(hits).collect()
}

#[test]
#[ignore = "slow: make test-all"]
fn a_stated_probability_of_one_class_is_true_of_so_many_hits() {
    let creatures: Vec<_> = (0..2 * PLANS * 8).into_par_iter().map(creature).collect();
    let by = |class: fn(&(usize, usize, Shape)) -> usize| {
        let mut classes: Vec<Vec<&Shape>> = vec![Vec::new(); 2 * PLANS];
        creatures.iter().for_each(|one| classes[class(one)].push(&one.2));
        classes.retain(|class| !class.is_empty());
        classes
    };
    for (what, classes, n_indexed) in [("families", by(|one| one.1), 5), ("plans", by(|one| one.0), 8)] {
        let mut all = Vec::new();
        for world in 0..8 {
            // Other classes, and other members of each.
            let members = |class: usize| -> Vec<&Shape> {
                let members = &classes[(class + 3 * world) % classes.len()];
                (0..members.len()).map(|i| members[(5 * i + 3 * world) % members.len()]).collect()
            };
            all.extend(stated(&(0..CLASSES).map(members).collect::<Vec<_>>(), n_indexed));
        }
        let mut apart = 0.0;
        for bin in 0..10 {
            let inside: Vec<_> = all.iter().filter(|(p, _)| ((10.0 * p) as usize).min(9) == bin).collect();
            let n = inside.len() as f64;
            let [said, truth] = [
                inside.iter().map(|(p, _)| p).sum::<f64>() / n,
                inside.iter().filter(|(_, is_one)| *is_one).count() as f64 / n,
            ];
            println!("{what} .{bin}: {n} hits, stated {said:.3}, true {truth:.3}");
            if n > 0.0 {
                apart += (said - truth).abs() * n / all.len() as f64;
            }
        }
        println!("{what}: {apart:.3} apart in the mean");
        // Odds of pairs of one class and two, equally frequent, are .11 and .06 apart.
        assert!(apart < 0.045, "{what}: {apart}");
    }
}
