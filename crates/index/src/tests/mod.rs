//! Laws of an index: nothing lost, nothing wrong, no dependence on its history.

mod damage;
mod durability;
mod equality;

use std::fs::File;
use std::io::Seek;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::{ContentHash, Entry, ExportFormat, Facts, Index, IndexWriter, Shape, verify};

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

    /// Adds shapes to an index and removes others.
    pub(crate) fn change(&self, path: &Path, added: &[usize], removed: &[String]) {
        let mut writer = IndexWriter::open(path).unwrap();
        writer.put(&added.iter().copied().map(shape).collect::<Vec<_>>()).unwrap();
        writer.remove(removed).unwrap();
        writer.finish().unwrap();
    }

    /// A finished index of shapes 0 to `n`.
    pub(crate) fn index(&self, name: &str, n: usize) -> PathBuf {
        let path = self.path(name);
        self.fill(&path, &(0..n).map(shape).collect::<Vec<_>>());
        path
    }

    /// Makes a finished index of these shapes.
    pub(crate) fn fill(&self, path: &Path, shapes: &[Shape]) {
        let mut writer = IndexWriter::build(path, OPTIONS).unwrap();
        writer.put(shapes).unwrap();
        writer.finish().unwrap();
    }
}

/// A shape all of whose properties depend on its number.
pub(crate) fn shape(i: usize) -> Shape {
    let x = i as f32;
    let facts = Facts { vertices: i as u64, area: 0.1 * i as f64, ..Facts::default() };
    Shape {
        entry: Entry {
            id: format!("class{}/{i:04}", i % 3),
            label: format!("class{}", i % 3),
            path: format!("meshes/{i}.off"),
            content: ContentHash::of(&[i.to_le_bytes()]),
            facts,
        },
        fused: vec![x, (x * 0.7).sin(), 0.1],
        signatures: [("moments", vec![x; 4]), ("spectrum", vec![0.5 * x; 3])]
            .map(|(name, values)| (name.to_owned(), values))
            .into(),
        disc_areas: vec![0.25 * x; 5],
        components: vec![vec![x, 1.0, 2.0]; i % 3],
        form: (0..40).map(|j| [x, j as f32, 0.1 + x * j as f32, 1.0]).collect(),
    }
}

pub(super) fn id(i: usize) -> String {
    shape(i).entry.id
}

pub(super) fn export(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    Index::open(path).unwrap().export(&mut bytes).unwrap();
    bytes
}

pub(crate) fn exported(index: &Index, format: ExportFormat) -> File {
    let mut file = tempfile::tempfile().unwrap();
    index.export_as(format, &mut file).unwrap();
    file.rewind().unwrap();
    file
}

pub(super) fn faults(path: &Path) -> Vec<String> {
    verify(path).unwrap().faults
}

#[test]
fn shapes_round_trip() {
    let folder = Folder::new();
    let index = Index::open(&folder.index("a", 20)).unwrap();
    assert_eq!((index.len(), index.options.as_str(), index.is_finished), (20, OPTIONS, true));
    for i in 0..20 {
        assert_eq!(index.entry(&id(i)).unwrap(), shape(i).entry);
        assert_eq!(index.shape(&id(i)).unwrap(), shape(i));
        assert_eq!(index.vector(&id(i), "signature_moments").unwrap().unwrap(), [i as f32; 4]);
    }
    assert_eq!(index.vector(&id(1), "none").unwrap(), None);
    assert_eq!(index.components().unwrap().len(), 6 + 2 * 6 + 1);
    assert_eq!(index.classes().unwrap()["class1"], 7);
    let entries = index.entries().unwrap();
    assert!(entries.is_sorted_by_key(|entry| &entry.id) && entries.len() == 20);
    assert!(index.contains("class0/0000").unwrap() && !index.contains("class1/0000").unwrap());
    let first = |content| entries.iter().find(|entry| entry.content == content).cloned();
    for Entry { content, .. } in &entries {
        assert_eq!(index.entry_with(content).unwrap(), first(*content));
    }
    assert_eq!(index.entry_with(&ContentHash::of(&["no file of the index"])).unwrap(), None);
}

#[test]
fn a_search_finds_the_nearest() {
    let folder = Folder::new();
    let index = Index::open(&folder.index("a", 50)).unwrap();
    let found = index.nearest(&shape(7).fused, 5).unwrap();
    assert!(
        found.len() == 5 && found[0] == (id(7), 0.0) && found.is_sorted_by(|a, b| a.1 <= b.1),
        "{found:?}"
    );
    assert_eq!(index.nearest(&shape(3).fused, 999).unwrap().len(), 50);
    assert!(index.nearest(&[1.0], 5).unwrap_err().to_string().contains("the query"));
    assert!(index.nearest(&[1.0, f32::NAN, 0.0], 5).is_err());
    let path = folder.index("empty", 0);
    let empty = Index::open(&path).unwrap();
    assert!(
        empty.is_empty() && faults(&path).is_empty() && empty.nearest(&[1.0, 2.0], 5).unwrap().is_empty()
    );
}

/// What the guide shows works with any program that reads SQLite.
#[test]
fn the_file_answers_questions_in_sql() {
    let folder = Folder::new();
    let path = folder.index("a", 20);
    let database = rusqlite::Connection::open(&path).unwrap();
    let sql = "select label, count(*), sum(vertices) from shapes group by label order by label";
    let mut statement = database.prepare(sql).unwrap();
    let rows = statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?))).unwrap();
    let rows: Vec<(String, u64, u64)> = rows.map(Result::unwrap).collect();
    assert_eq!(rows[1], ("class1".to_owned(), 7, (0..20).filter(|i| i % 3 == 1).sum()));
    let bytes: Vec<u8> =
        database.query_row("select vector from fused where id = ?", [id(7)], |row| row.get(0)).unwrap();
    assert_eq!(bytes[..4], 7.0f32.to_le_bytes());
}
