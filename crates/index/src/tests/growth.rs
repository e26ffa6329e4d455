//! Changes cost what is changed, and lead where a new start leads.

use std::fs;
use std::path::Path;

use super::{Folder, OPTIONS, export, shape};
use crate::{ContentHash, Index, IndexWriter, Job, Shape, ShapeEntry, ShapeVectors, verify, work_path};

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
    assert_eq!(index.classes().unwrap(), fresh.classes().unwrap());
    assert!(index.threshold().is_some() && index.threshold() == fresh.threshold());
    for query in [point(5000), point(800)] {
        let found = [&index, &fresh].map(|index| index.nearest(&query.vectors.fused, 10).unwrap());
        assert_eq!(found[0], found[1]);
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
        let found = Index::open(&path).unwrap().nearest(&shape(3).vectors.fused, 4).unwrap();
        found.into_iter().map(|near| near.id).collect::<Vec<_>>()
    };
    let expected = ["copy00", "copy01", "copy02", "copy03"];
    assert_eq!(copies(&mut (0..12), "a"), expected);
    assert_eq!(copies(&mut (0..12).rev(), "b"), expected);
}
