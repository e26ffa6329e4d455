//! The export depends on the shapes only.

use std::io::Read;

use super::{Folder, OPTIONS, export, exported, faults, id, shape};
use crate::{ExportFormat, Index, IndexError, IndexWriter, Shape};

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
    writer.finish(&()).unwrap();
    assert_ne!(export(&path), whole);
    folder.change(&path, &[], &[id(41), id(40)]);
    assert_eq!(export(&path), whole);
    let both = [path, folder.path("whole")].map(|path| Index::open(&path).unwrap());
    assert_eq!(both[0].threshold, both[1].threshold);
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
fn equal_vectors_are_found_by_name_whatever_came_first() {
    let folder = Folder::new();
    let copies = |order: &mut dyn Iterator<Item = usize>, name| {
        let path = folder.path(name);
        folder.fill(&path, &[shape(50)]);
        for i in order {
            let mut copy = shape(3);
            copy.entry.id = format!("copy{i:02}");
            let mut writer = IndexWriter::open(&path).unwrap();
            writer.put(&[copy]).unwrap();
            writer.finish(&()).unwrap();
        }
        let found = Index::open(&path).unwrap().nearest(&shape(3).fused, 4).unwrap();
        found.into_iter().map(|(id, _)| id).collect::<Vec<_>>()
    };
    let expected = ["copy00", "copy01", "copy02", "copy03"];
    assert_eq!(copies(&mut (0..12), "a"), expected);
    assert_eq!(copies(&mut (0..12).rev(), "b"), expected);
}

#[test]
fn entries_change_without_vectors() {
    let folder = Folder::new();
    let path = folder.index("a", 4);
    let mut writer = IndexWriter::open(&path).unwrap();
    let mut entry = writer.entry(&id(2)).unwrap().unwrap();
    entry.label = "dog".to_owned();
    writer.set_entries(std::slice::from_ref(&entry)).unwrap();
    entry.id = "no".to_owned();
    assert!(matches!(writer.set_entries(&[entry]), Err(IndexError::NoSuchShape { .. })));
    writer.finish(&()).unwrap();
    let index = Index::open(&path).unwrap();
    assert_eq!(index.entry(&id(2)).unwrap().label, "dog");
    assert_eq!(index.shape(&id(2)).unwrap().form, shape(2).form);
    assert_eq!(faults(&path), Vec::<String>::new());
}

#[test]
fn removing_a_missing_shape_removes_nothing() {
    let folder = Folder::new();
    let path = folder.index("a", 4);
    let mut writer = IndexWriter::open(&path).unwrap();
    let error = writer.remove(&[id(1), "cat9".to_owned()]).unwrap_err();
    assert!(error.to_string().contains("`cat9`"), "{error}");
    drop(writer);
    assert_eq!(Index::open(&path).unwrap().len(), 4);
    assert_eq!(folder.names(), ["a"]);
}
