//! Laws of an index: nothing lost, nothing wrong, no dependence on its history.

mod damage;
mod durability;
mod equality;
mod forged;
mod graph;
mod growth;

use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::{ContentHash, Index, IndexWriter, Job, Shape, ShapeEntry, ShapeVectors, verify};

pub(crate) const OPTIONS: &str = "n=100";

/// A temporary folder for one test.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Adds shapes to a finished index and removes others.
    pub(crate) fn change(&self, path: &Path, added: &[usize], removed: &[String]) {
        let mut writer = IndexWriter::open(path, Job::Add, None).unwrap();
        writer.put(&added.iter().copied().map(shape).collect::<Vec<_>>()).unwrap();
        writer.remove(removed).unwrap();
        writer.finish(&()).unwrap();
    }

    /// A finished index of shapes 0 to `n`.
    pub(crate) fn index(&self, name: &str, n: usize) -> PathBuf {
        let path = self.path(name);
        self.fill(&path, &(0..n).map(shape).collect::<Vec<_>>());
        path
    }

    /// Makes a finished index of these shapes.
    pub(crate) fn fill(&self, path: &Path, shapes: &[Shape]) {
        let mut writer = IndexWriter::open(path, Job::Build, Some(OPTIONS)).unwrap();
        writer.put(shapes).unwrap();
        writer.finish(&()).unwrap();
    }
}

/// A shape all of whose properties depend on its number.
pub(crate) fn shape(i: usize) -> Shape {
    let x = i as f32;
    Shape {
        id: format!("class{}/{i:04}", i % 3),
        entry: ShapeEntry {
            label: format!("class{}", i % 3),
            path: format!("meshes/{i}.off"),
            content: ContentHash::of(&[i.to_le_bytes()]),
            facts: vec![("area".to_owned(), 0.1 * i as f64), ("vertices".to_owned(), i as f64)],
        },
        vectors: ShapeVectors {
            fused: vec![x, (x * 0.7).sin(), 0.1],
            signatures: vec![("moments".to_owned(), vec![x; 4]), ("spectrum".to_owned(), vec![0.5 * x; 3])],
            disc_areas: vec![0.25 * x; 5],
            components: vec![vec![x, 1.0, 2.0]; i % 3],
            form: (0..40).map(|j| [x, j as f32, 0.1 + x * j as f32, 1.0]).collect(),
        },
    }
}

pub(super) fn export(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    Index::open(path).unwrap().export(&mut bytes).unwrap();
    bytes
}

#[test]
fn shapes_round_trip() {
    let folder = Folder::new();
    let index = Index::open(&folder.index("a", 20)).unwrap();
    assert_eq!((index.len(), index.options()), (20, OPTIONS));
    for i in 0..20 {
        let Shape { id, entry, vectors } = shape(i);
        assert_eq!(index.entry(&id).unwrap(), entry);
        assert_eq!(index.vectors(&id).unwrap(), vectors);
        assert_eq!(entry.fact("vertices"), Some(i as f64));
    }
    let ids: Vec<String> = index.entries().unwrap().into_iter().map(|(id, _)| id).collect();
    assert!(ids.is_sorted() && ids.len() == 20);
    assert!(index.contains("class0/0000").unwrap() && !index.contains("class1/0000").unwrap());
}

#[test]
fn a_search_finds_the_nearest() {
    let folder = Folder::new();
    let index = Index::open(&folder.index("a", 50)).unwrap();
    for query in [shape(7).vectors.fused, vec![3.2, 0.0, 0.0]] {
        let found = index.nearest(&query, 5).unwrap();
        let mut expected: Vec<(f64, String)> = (0..50)
            .map(|i| {
                let gaps =
                    shape(i).vectors.fused.into_iter().zip(&query).map(|(x, y)| f64::from(x - y).powi(2));
                (gaps.sum::<f64>().sqrt(), shape(i).id)
            })
            .collect();
        expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(found.len(), 5);
        for (found, (distance, id)) in found.iter().zip(&expected) {
            assert!(found.id == *id && (found.distance - distance).abs() < 1e-6);
        }
    }
    assert_eq!(index.nearest(&shape(3).vectors.fused, 999).unwrap().len(), 50);
    assert!(index.nearest(&[1.0], 5).unwrap_err().to_string().contains("the query"));
    assert!(index.nearest(&[1.0, f32::NAN, 0.0], 5).is_err());
}

#[test]
fn an_empty_index_finds_nothing() {
    let folder = Folder::new();
    let path = folder.index("empty", 0);
    let index = Index::open(&path).unwrap();
    assert!(index.is_empty() && verify(&path).unwrap().faults.is_empty());
    assert!(index.nearest(&[1.0, 2.0], 5).unwrap().is_empty());
}
