//! Readers, writers, interruptions and failing disks.

use std::fs;
use std::path::Path;

use super::{Folder, OPTIONS, export, faults, id, shape};
use crate::database::with_suffix;
use crate::{Index, IndexError, IndexWriter};

#[test]
fn readers_keep_the_state_that_they_opened() {
    let folder = Folder::new();
    let path = folder.index("a", 5);
    let early = Index::open(&path).unwrap();
    let mut writer = IndexWriter::open(&path).unwrap();
    writer.put(&[shape(5)]).unwrap();
    writer.remove(&[id(0)]).unwrap();
    let meanwhile = Index::open(&path).unwrap();
    writer.commit().unwrap();
    let committed = Index::open(&path).unwrap();
    assert!(!committed.is_finished && committed.change > meanwhile.change);
    let index = writer.finish().unwrap();
    assert_eq!([&early, &meanwhile, &committed, &index].map(Index::len), [5; 4]);
    for old in [&early, &meanwhile] {
        assert!(old.entry(&id(5)).is_err() && old.shape(&id(0)).unwrap() == shape(0));
        assert_eq!(old.nearest(&shape(0).fused, 1).unwrap()[0].0, id(0));
    }
    for new in [&committed, &index] {
        assert!(new.entry(&id(0)).is_err() && new.shape(&id(5)).unwrap() == shape(5));
    }
    assert!(index.is_finished && faults(&path).is_empty());
    drop((early, meanwhile, committed, index));
    assert_eq!(folder.names(), ["a"], "one file is left");
}

#[test]
fn an_index_has_one_writer_at_a_time() {
    let folder = Folder::new();
    let path = folder.index("a", 5);
    let mut first = IndexWriter::open(&path).unwrap();
    let refused = || {
        let error = IndexWriter::open(&path).unwrap_err();
        assert!(
            matches!(&error, IndexError::Busy(_)) && error.to_string().contains("another program"),
            "{error}"
        );
    };
    refused();
    first.put(&[shape(5)]).unwrap();
    first.commit().unwrap();
    refused();
    drop(first);
    let again = IndexWriter::open(&path).unwrap();
    assert!(again.is_resumed && again.n_shapes() == 6);
}

#[test]
fn a_log_of_another_file_is_noticed_and_changes_nothing() {
    let folder = Folder::new();
    let path = folder.index("a", 20);
    let backup = fs::read(&path).unwrap();
    folder.change(&path, &[20], &[]);
    let reader = Index::open(&path).unwrap();
    folder.change(&path, &[21, 22], &[]);
    let whole = fs::read(&path).unwrap();
    // While a program has the old file open, a backup, another index and something else take its place.
    let other = fs::read(folder.index("b", 3)).unwrap();
    for bytes in [&backup, &other] {
        fs::remove_file(&path).unwrap();
        fs::write(&path, bytes).unwrap();
        for error in [Index::open(&path).unwrap_err(), IndexWriter::open(&path).unwrap_err()] {
            assert!(
                matches!(error, IndexError::OtherLog(_)) && error.to_string().contains("a-wal"),
                "{error}"
            );
        }
        assert!(fs::read(&path).unwrap() == *bytes);
    }
    fs::write(&path, b"not an index").unwrap();
    assert!(matches!(Index::open(&path), Err(IndexError::Foreign(_))));
    assert_eq!(fs::read(&path).unwrap(), b"not an index");
    fs::write(&path, whole).unwrap();
    assert_eq!(Index::open(&path).unwrap().len(), 23);
    assert_eq!(reader.len(), 21);
}

#[test]
fn a_transaction_and_its_copy_into_the_file_may_be_cut_anywhere() {
    let folder = Folder::new();
    let path = folder.index("a", 20);
    let before = export(&path);
    // A reader keeps the log from being copied into the file.
    let reader = Index::open(&path).unwrap();
    folder.change(&path, &[20, 21], &[id(3)]);
    let after = export(&path);
    let [old, log] = [path.clone(), with_suffix(&path, "-wal")].map(|file| fs::read(file).unwrap());
    drop(reader);
    drop(Index::open(&path).unwrap());
    let new = fs::read(&path).unwrap();
    assert!(old != new && folder.names() == ["a"]);
    let copy = folder.path("b");
    let found = |file: &[u8], log: &[u8]| {
        fs::write(&copy, file).unwrap();
        fs::write(with_suffix(&copy, "-wal"), log).unwrap();
        export(&copy)
    };
    let mut seen = [0, 0];
    for length in (0..log.len()).step_by(293).chain(log.len().saturating_sub(40)..=log.len()) {
        let found = found(&old, &log[..length]);
        assert!(found == before || found == after, "{length} of {} bytes", log.len());
        seen[usize::from(found == after)] += 1;
        if length % 5 == 0 {
            assert_eq!(faults(&copy), Vec::<String>::new(), "{length}");
        }
    }
    assert!(seen[0] > 100 && seen[1] > 0, "{seen:?}");
    // Some of the pages are new, and the others still old.
    let page = |bytes: &[u8], i: usize| bytes.chunks(16_384).nth(i).unwrap_or_default().to_vec();
    let n_pages = new.len().div_ceil(16_384);
    for turn in 0..=n_pages {
        for is_new in [&|i: usize| i < turn, &|i: usize| i >= turn] as [&dyn Fn(usize) -> bool; 2] {
            let mixed: Vec<u8> =
                (0..n_pages).flat_map(|i| page(if is_new(i) { &new } else { &old }, i)).collect();
            assert!(found(&mixed, &log) == after, "{turn}");
        }
    }
}

#[test]
fn a_failing_disk_loses_nothing_that_was_committed() {
    // `SQLITE_FULL` in the middle of a transaction, wherever the limit lies.
    let folder = Folder::new();
    for pages in 12..40 {
        let path = folder.path(&pages.to_string());
        folder.fill(&path, &(0..5).map(shape).collect::<Vec<_>>());
        let before = export(&path);
        let mut writer = IndexWriter::open(&path).unwrap();
        writer.limit_pages(pages);
        let put = (5..60).try_for_each(|i| writer.put(&[shape(i)])).and_then(|()| writer.commit());
        drop(writer);
        match put {
            Ok(()) => assert_eq!(Index::open(&path).unwrap().len(), 60),
            Err(error) => {
                assert!(error.to_string().contains("free some space"), "{error}");
                assert!(export(&path) == before, "{pages}");
            }
        }
        assert_eq!(faults(&path), Vec::<String>::new());
    }
}

#[cfg(unix)]
#[test]
fn a_backup_by_a_hard_link_keeps_its_content() {
    let folder = Folder::new();
    let (path, link) = (folder.index("a", 20), folder.path("link"));
    fs::hard_link(&path, &link).unwrap();
    folder.change(&path, &[20], &[]);
    assert_eq!((Index::open(&path).unwrap().len(), Index::open(&link).unwrap().len()), (21, 20));
}

#[cfg(unix)]
#[test]
fn what_cannot_be_written_is_reported_and_can_be_read() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    let error = IndexWriter::build(&folder.path("nowhere/a"), OPTIONS).unwrap_err().to_string();
    assert!(error.contains("nowhere") && error.contains("cannot write"), "{error}");
    fs::create_dir(folder.path("sub")).unwrap();
    let path = folder.index("sub/a", 3);
    let set = |file: &Path, mode| fs::set_permissions(file, fs::Permissions::from_mode(mode)).unwrap();
    set(&path, 0o444);
    set(&folder.path("sub"), 0o555);
    let read = || {
        assert_eq!(Index::open(&path).unwrap().shape(&id(2)).unwrap(), shape(2));
        assert_eq!(faults(&path), Vec::<String>::new());
    };
    read();
    // The superuser may write everything.
    if let Err(error) = fs::write(folder.path("sub/try"), b"") {
        assert_eq!(error.kind(), std::io::ErrorKind::PermissionDenied);
        let error = IndexWriter::open(&path).unwrap_err().to_string();
        assert!(error.contains("cannot write"), "{error}");
    }
    set(&folder.path("sub"), 0o755);
    read();
}
