//! The export depends on the shapes only.

use super::{Folder, OPTIONS, export, shape};
use crate::{Index, IndexError, IndexWriter, Job, verify};

#[test]
fn order_batches_and_history_do_not_matter() {
    let folder = Folder::new();
    let whole = export(&folder.index("whole", 30));
    let path = folder.path("other");
    let mut writer = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
    for i in (0..30).rev().chain([5, 5, 40, 41]) {
        writer.put(&[shape(i)]).unwrap();
    }
    writer.finish(&()).unwrap();
    assert_ne!(export(&path), whole);
    let mut writer = IndexWriter::open(&path, Job::Remove, None).unwrap();
    writer.remove(&[shape(41).id, shape(40).id]).unwrap();
    writer.finish(&()).unwrap();
    assert_eq!(export(&path), whole);
    // Each line is a JSON object; the first describes the index.
    let lines: Vec<serde_json::Value> = whole
        .split(|b| *b == b'\n')
        .filter(|l| !l.is_empty())
        .map(|l| serde_json::from_slice(l).unwrap())
        .collect();
    assert_eq!(lines.len(), 31);
    assert_eq!((&lines[0]["shapes"], &lines[0]["options"]), (&30.into(), &OPTIONS.into()));
    assert_eq!(lines[1]["id"], "class0/0000");
    assert_eq!(lines[1]["facts"]["area"], 0.0);
}

#[test]
fn entries_change_without_vectors() {
    let folder = Folder::new();
    let path = folder.index("a", 4);
    let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    let mut entry = writer.entry(&shape(2).id).unwrap().unwrap();
    entry.label = "dog".to_owned();
    writer.set_entries(&[(shape(2).id, entry.clone())]).unwrap();
    assert!(matches!(writer.set_entries(&[("no".to_owned(), entry)]), Err(IndexError::NoSuchShape { .. })));
    writer.finish(&()).unwrap();
    let index = Index::open(&path).unwrap();
    assert_eq!(index.entry(&shape(2).id).unwrap().label, "dog");
    assert_eq!(index.vectors(&shape(2).id).unwrap(), shape(2).vectors);
    assert_eq!(verify(&path).unwrap().faults, Vec::<String>::new());
}

#[test]
fn removing_a_missing_shape_removes_nothing() {
    let folder = Folder::new();
    let path = folder.index("a", 4);
    let mut writer = IndexWriter::open(&path, Job::Remove, None).unwrap();
    let error = writer.remove(&[shape(1).id, "cat9".to_owned()]).unwrap_err();
    assert!(error.to_string().contains("`cat9`"), "{error}");
    assert_eq!(writer.n_shapes().unwrap(), 4);
    writer.discard().unwrap();
    assert_eq!(folder.names(), ["a"]);
}
