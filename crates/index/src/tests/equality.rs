//! The export depends on the shapes only.

use std::io::Read;

use super::{Folder, OPTIONS, export, exported, faults, id, shape};
use crate::{Entry, ExportFormat, Index, IndexError, IndexWriter, Shape};

#[test]
fn order_batches_and_history_do_not_matter() {
    let folder = Folder::new();
    let whole = export(&folder.index("whole", 30));
    let path = folder.path("other");
    let mut writer = IndexWriter::build(&path, OPTIONS).unwrap();
    for i in (0..30).rev().chain([5, 5, 40, 41]) {
        writer.put(&[shape(i)]).unwrap();
        writer.commit().unwrap();
    }
    writer.finish().unwrap();
    assert_ne!(export(&path), whole);
    folder.change(&path, &[], &[id(41), id(40)]);
    assert_eq!(export(&path), whole);
    let both = [path, folder.path("whole")].map(|path| Index::open(&path).unwrap());
    let nearest = both.each_ref().map(|index| index.nearest(&shape(3).fused, 30).unwrap());
    assert_eq!(nearest[0], nearest[1]);
    for format in ExportFormat::ALL {
        let [ours, other] = both.each_ref().map(|index| {
            let mut bytes = Vec::new();
            exported(index, format).read_to_end(&mut bytes).unwrap();
            bytes
        });
        assert!(!ours.is_empty() && ours == other, "{format:?}");
    }
    // Each line is a JSON object; the first describes the index.
    let lines: Vec<serde_json::Value> =
        str::from_utf8(&whole).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((&lines[0]["shapes"], &lines[0]["options"]), (&30.into(), &OPTIONS.into()));
    assert_eq!((lines.len(), serde_json::from_value::<Shape>(lines[1].clone()).unwrap()), (31, shape(0)));
}

#[test]
fn entries_change_without_vectors() {
    let folder = Folder::new();
    let path = folder.index("a", 4);
    let mut writer = IndexWriter::open(&path).unwrap();
    let mut entry = writer.entry(&id(2)).unwrap().unwrap();
    entry.label = "dog".to_owned();
    writer.set_entries(std::slice::from_ref(&entry)).unwrap();
    writer.finish().unwrap();
    let index = Index::open(&path).unwrap();
    assert_eq!(index.entry(&id(2)).unwrap().label, "dog");
    assert_eq!(index.shape(&id(2)).unwrap().form, shape(2).form);
    assert_eq!(faults(&path), Vec::<String>::new());
}

#[test]
fn what_is_refused_changes_nothing() {
    let folder = Folder::new();
    let path = folder.index("a", 4);
    let whole = export(&path);
    let error = |result: Result<(), IndexError>, parts: &[&str]| {
        let error = result.unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    };
    let mut writer = IndexWriter::open(&path).unwrap();
    error(writer.remove(&[id(1), "cat9".to_owned()]), &["`cat9`"]);
    error(writer.set_entries(&[Entry { id: "cat9".to_owned(), ..Entry::default() }]), &["`cat9`"]);
    for (fused, what) in
        [(vec![], "not finite"), (vec![1.0, f32::NAN, 1.0], "not finite"), (vec![1.0; 4], "4")]
    {
        error(writer.put(&[Shape { fused, ..shape(5) }]), &[&id(5), what]);
    }
    drop(writer);
    error(IndexWriter::build(&path, "n=50").map(drop), &["other options", "n=50", OPTIONS]);
    error(IndexWriter::open(&folder.path("none")).map(drop), &["none", "check that the path exists"]);
    // A new index goes with a writer that has not committed.
    IndexWriter::build(&folder.path("b"), OPTIONS).unwrap().put(&[shape(1)]).unwrap();
    assert_eq!((export(&path), folder.names()), (whole, vec!["a".to_owned()]));
}
