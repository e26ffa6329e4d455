//! Changes cost what is changed, and lead where a new start leads.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use super::graph::nodes;
use super::{Folder, OPTIONS, export, shape};
use crate::tables::Node;
use crate::{
    ContentHash, Found, Index, IndexWriter, Job, SearchMode, Searcher, Shape, ShapeEntry, ShapeVectors,
    verify, work_path,
};

/// A small shape of 24 numbers in one of many clusters.
fn point(i: usize) -> Shape {
    let hash = |j: usize| {
        let bits = ContentHash::of(&[j.to_le_bytes()]).start();
        (bits >> 40) as f32 / (1 << 24) as f32
    };
    let cluster = i % 997;
    Shape {
        id: format!("p{i:06}"),
        entry: ShapeEntry {
            label: format!("c{}", cluster % 50),
            path: String::new(),
            content: ContentHash::of(&[i.to_le_bytes()]),
            facts: Vec::new(),
        },
        vectors: ShapeVectors {
            fused: (0..24).map(|d| hash(24 * cluster + d) + 0.1 * hash(1_000_000 + 24 * i + d)).collect(),
            ..ShapeVectors::default()
        },
    }
}

fn built(path: &Path, numbers: impl Iterator<Item = usize>) -> Index {
    let mut writer = IndexWriter::open(path, Job::Build, Some(OPTIONS)).unwrap();
    let shapes: Vec<Shape> = numbers.map(point).collect();
    shapes.chunks(10_000).for_each(|shapes| writer.put(shapes).unwrap());
    writer.finish(&()).unwrap()
}

fn added(path: &Path, numbers: impl Iterator<Item = usize>) -> Index {
    let mut writer = IndexWriter::open(path, Job::Add, None).unwrap();
    writer.put(&numbers.map(point).collect::<Vec<_>>()).unwrap();
    writer.finish(&()).unwrap()
}

fn removed(path: &Path, numbers: impl Iterator<Item = usize>) -> Index {
    let mut writer = IndexWriter::open(path, Job::Remove, None).unwrap();
    writer.remove(&numbers.map(|i| point(i).id).collect::<Vec<_>>()).unwrap();
    writer.finish(&()).unwrap()
}

fn search(index: &Index, query: &Shape, mode: SearchMode) -> Found {
    let found = index.nearest(&query.vectors.fused, 10, mode).unwrap();
    assert_eq!(found, Searcher::load(index).unwrap().nearest(&query.vectors.fused, 10, mode).unwrap());
    found
}

#[test]
fn an_addition_writes_as_much_to_a_large_index_as_to_a_small_one() {
    let folder = Folder::new();
    let mut written = Vec::new();
    for n in [4000, 32_000] {
        let path = folder.path(&n.to_string());
        built(&path, 0..n);
        let size = || fs::metadata(&path).unwrap().len();
        let mut of_size = Vec::new();
        for i in 0..3 {
            let before = size();
            let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
            writer.put(&[point(n + i)]).unwrap();
            let work = fs::metadata(work_path(&path)).unwrap().len();
            writer.finish(&()).unwrap();
            assert!(size() > before, "it is appended");
            of_size.push(work + size() - before);
        }
        let before = size();
        assert_eq!(removed(&path, 0..1).len(), n + 2);
        assert!(size() > before, "it is appended");
        of_size.push(size() - before);
        written.push(of_size.into_iter().max().unwrap());
        assert_eq!(verify(&path).unwrap().faults, Vec::<String>::new());
    }
    println!("{written:?} bytes");
    assert!(written[1] * 10 < written[0] * 13 && written[1] < 1 << 20, "{written:?} bytes");
}

#[test]
fn many_small_changes_lead_where_one_build_leads() {
    let folder = Folder::new();
    let path = folder.path("a");
    built(&path, 0..700);
    let mut sizes = vec![fs::metadata(&path).unwrap().len()];
    for step in 0..30 {
        added(&path, 700 + 20 * step..720 + 20 * step);
        removed(&path, 10 * step..10 * step + 10);
        sizes.push(fs::metadata(&path).unwrap().len());
    }
    assert!(sizes.windows(2).any(|pair| pair[1] < pair[0]), "it is written anew now and then: {sizes:?}");
    let index = Index::open(&path).unwrap();
    let fresh = built(&folder.path("b"), 300..1300);
    assert_eq!(export(&path), export(&folder.path("b")));
    assert_eq!(nodes(&index), nodes(&fresh));
    assert_eq!(index.classes().unwrap(), fresh.classes().unwrap());
    for query in [point(5000), point(800)] {
        for mode in [SearchMode::Auto, SearchMode::Exact] {
            assert_eq!(search(&index, &query, mode), search(&fresh, &query, mode));
        }
    }
    assert_eq!(verify(&path).unwrap().faults, Vec::<String>::new());
}

#[cfg(unix)]
#[test]
fn an_index_with_another_name_or_without_a_right_to_write_is_written_anew() {
    let folder = Folder::new();
    let (path, link) = (folder.path("a"), folder.path("link"));
    built(&path, 0..2000);
    fs::hard_link(&path, &link).unwrap();
    assert_eq!(added(&path, 2000..2001).len(), 2001);
    assert_eq!(Index::open(&link).unwrap().len(), 2000);
    fs::set_permissions(&path, std::os::unix::fs::PermissionsExt::from_mode(0o444)).unwrap();
    assert_eq!(added(&path, 2001..2002).len(), 2002);
}

#[test]
fn equal_vectors_are_found_by_name_whatever_came_first() {
    let folder = Folder::new();
    let copies = |order: &mut dyn Iterator<Item = usize>, name| {
        let path = folder.path(name);
        let mut writer = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
        writer.put(&[shape(50)]).unwrap();
        writer.finish(&()).unwrap();
        for i in order {
            let copy = Shape { id: format!("copy{i:02}"), ..shape(3) };
            let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
            writer.put(&[copy]).unwrap();
            writer.finish(&()).unwrap();
        }
        let found =
            Index::open(&path).unwrap().nearest(&shape(3).vectors.fused, 4, SearchMode::Auto).unwrap();
        found.shapes.into_iter().map(|near| near.id).collect::<Vec<_>>()
    };
    let expected = ["copy00", "copy01", "copy02", "copy03"];
    assert_eq!(copies(&mut (0..12), "a"), expected);
    assert_eq!(copies(&mut (0..12).rev(), "b"), expected);
}

/// Beyond the limit of exact searches.
#[test]
fn cells_that_have_grown_find_as_much_as_new_ones() {
    let folder = Folder::new();
    let path = folder.path("a");
    let first = built(&path, 0..56_000);
    assert!(first.heads().unwrap().header.n_cells > 1);
    let before = fs::metadata(&path).unwrap().len();
    added(&path, 56_000..64_000);
    removed(&path, 0..3000);
    let index = removed(&path, (20_000..21_000).step_by(3));
    assert!(fs::metadata(&path).unwrap().len() > before, "they are appended");
    let header = &index.heads().unwrap().header;
    assert_eq!((header.n_trained, header.n), (56_000, 60_666));
    assert_eq!(verify(&path).unwrap().faults, Vec::<String>::new());
    let fresh =
        built(&folder.path("b"), (3000..64_000).filter(|i| !(20_000..21_000).step_by(3).any(|x| x == *i)));
    assert_eq!(export(&path), export(&folder.path("b")));
    // Lists that changes did not reach are rare.
    let [grown, new]: [HashMap<u64, Node>; 2] =
        [&index, &fresh].map(|index| nodes(index).into_iter().collect());
    let listed: usize = new.values().map(|node| node.links.0.len()).sum();
    let kept = |(key, node): (&u64, &Node)| {
        let old = &grown[key].links.0;
        node.links.0.iter().filter(|link| old.iter().any(|known| known.key == link.key)).count()
    };
    let kept: usize = new.iter().map(kept).sum();
    println!("{kept} of {listed} links");
    assert!(grown.len() == new.len() && kept * 100 >= listed * 98, "{kept} of {listed}");
    let mut searchers = [&index, &fresh].map(|index| (Searcher::load(index).unwrap(), 0));
    for i in 0..300 {
        let query = point(70_000 + i).vectors.fused;
        let exact = searchers.each_ref().map(|(s, _)| s.nearest(&query, 10, SearchMode::Exact).unwrap());
        assert_eq!(exact[0], exact[1]);
        for (searcher, n_found) in &mut searchers {
            let found = searcher.nearest(&query, 10, SearchMode::Auto).unwrap();
            assert!(found.recall >= 0.99);
            *n_found += found.shapes.iter().filter(|near| exact[0].shapes.contains(near)).count();
        }
    }
    let [grown, new] = searchers.map(|(_, n_found)| n_found);
    assert!(grown >= 2970 && new >= 2970, "{grown} and {new} of 3000");
}
