//! Changed bytes never become a result.

use std::fs;
use std::path::Path;

use base::SplitMix;
use rusqlite::Connection;

use super::{Folder, OPTIONS, export, faults, id, shape};
use crate::database::checksum;
use crate::{Index, IndexError, IndexWriter, Shape, damaged_path, verify};

/// All shapes, and what a search finds.
type Everything = (Vec<Shape>, Vec<(String, f64)>);

/// Reads everything that an index holds.
fn read_all(path: &Path) -> Result<Everything, IndexError> {
    let index = Index::open(path)?;
    let mut shapes = Vec::new();
    index.each(|shape| {
        shapes.push(shape);
        Ok::<(), IndexError>(())
    })?;
    Ok((shapes, index.nearest(&shape(2).fused, 4)?))
}

/// Whether a defect is noticed. What is read is the truth, and errors are those of defects.
fn is_noticed(path: &Path, truth: &Everything, what: &str) -> bool {
    let is_named = |error: &IndexError| {
        use IndexError as E;
        matches!(
            error,
            E::Damaged { .. }
                | E::Foreign(_)
                | E::FutureVersion { .. }
                | E::PastVersion { .. }
                | E::Io { .. }
        )
    };
    let read = read_all(path);
    match &read {
        Ok(found) => assert!(found == truth, "{what}"),
        Err(error) => assert!(is_named(error), "{what}: {error}"),
    }
    match verify(path) {
        Ok(found) => {
            assert!(!found.faults.is_empty() || read.is_ok(), "{what}");
            !found.faults.is_empty()
        }
        Err(error) => {
            assert!(is_named(&error), "{what}: {error}");
            true
        }
    }
}

/// Changes an index by SQL, behind its back.
fn forge(path: &Path, sql: &str) {
    let database = Connection::open(path).unwrap();
    database.execute_batch(&format!("PRAGMA writable_schema = 1; {sql}")).unwrap();
}

#[test]
#[ignore = "slow: make test-all"]
fn a_changed_byte_is_detected_and_never_returned() {
    let folder = Folder::new();
    let path = folder.index("a", 100);
    folder.change(&path, &[100], &[id(7)]);
    let bytes = fs::read(&path).unwrap();
    let truth = read_all(&path).unwrap();
    assert_eq!(faults(&path), Vec::<String>::new());
    // The head completely, and many other bytes; some of them are not used.
    let mut random = SplitMix(3);
    let others: Vec<usize> = (0..1500).map(|_| (random.bits() % bytes.len() as u64) as usize).collect();
    let copy = folder.path("b");
    let mut detected = 0;
    for at in (0..160).chain(others) {
        let mut changed = bytes.clone();
        changed[at] ^= 1 << (at % 8);
        fs::write(&copy, &changed).unwrap();
        detected += usize::from(is_noticed(&copy, &truth, &format!("byte {at}")));
    }
    assert!(detected * 4 > 1660, "{detected}");
}

#[test]
fn truncated_files_are_damaged() {
    let folder = Folder::new();
    let path = folder.index("a", 60);
    let (bytes, truth) = (fs::read(&path).unwrap(), read_all(&path).unwrap());
    let copy = folder.path("b");
    for length in [bytes.len() - 1, bytes.len() / 2, 16_384, 4096, 101] {
        fs::write(&copy, &bytes[..length]).unwrap();
        assert!(is_noticed(&copy, &truth, &length.to_string()) && read_all(&copy).is_err(), "{length}");
    }
}

#[test]
fn other_files_are_never_overwritten() {
    let folder = Folder::new();
    Connection::open(folder.path("photos"))
        .unwrap()
        .execute_batch("create table shapes(id); create table meta(x)")
        .unwrap();
    let photos = fs::read(folder.path("photos")).unwrap();
    for (name, content) in
        [("notes.txt", &b"dear diary"[..]), ("empty", b""), ("long", &[b'x'; 9000]), ("photos", &photos)]
    {
        let path = folder.path(name);
        fs::write(&path, content).unwrap();
        for error in [
            Index::open(&path).unwrap_err(),
            verify(&path).unwrap_err(),
            IndexWriter::build(&path, OPTIONS).unwrap_err(),
        ] {
            assert!(matches!(error, IndexError::Foreign(_)) && error.to_string().contains(name), "{error}");
        }
        assert_eq!(fs::read(&path).unwrap(), content);
    }
    let error = Index::open(&folder.path(".")).unwrap_err();
    assert!(matches!(error, IndexError::Io { .. }), "{error}");
    assert_eq!(folder.names(), ["empty", "long", "notes.txt", "photos"]);
}

#[test]
fn what_cannot_be_read_is_reported_kept_and_built_again() {
    let folder = Folder::new();
    let path = folder.index("a", 200);
    let (whole, intact) = (export(&path), fs::read(&path).unwrap());
    forge(&path, "PRAGMA user_version = 7");
    for error in [Index::open(&path).unwrap_err(), IndexWriter::build(&path, OPTIONS).unwrap_err()] {
        assert!(matches!(error, IndexError::FutureVersion { found: 7, .. }), "{error}");
        assert!(error.to_string().contains("format 7") && error.to_string().contains("newer"), "{error}");
    }
    // Formats that were no databases begin with their name.
    let old = [&b"canonform index\n\x04\0\0\0"[..], &[7; 5000]].concat();
    let damaged = [&intact[..16_384], &[0xFF; 16], &intact[16_400..]].concat();
    for (bytes, is_old) in [(old, true), (damaged, false)] {
        fs::write(&path, &bytes).unwrap();
        let error = IndexWriter::open(&path).unwrap_err();
        match is_old {
            true => assert!(matches!(error, IndexError::PastVersion { found: 4, .. }), "{error}"),
            false => assert!(matches!(error, IndexError::Damaged { .. }), "{error}"),
        }
        assert_eq!(fs::read(&path).unwrap(), bytes);
        let mut writer = IndexWriter::build(&path, OPTIONS).unwrap();
        assert!(writer.replaced_damaged && writer.n_shapes() == 0);
        writer.put(&(0..200).map(shape).collect::<Vec<_>>()).unwrap();
        writer.finish().unwrap();
        assert!(export(&path) == whole && fs::read(damaged_path(&path)).unwrap() == bytes);
        assert_eq!(folder.names(), ["a", "a.damaged"]);
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn forged_rows_are_named_and_nothing_else_happens() {
    let folder = Folder::new();
    let template = folder.index("a", 30);
    let truth = read_all(&template).unwrap();
    let path = folder.path("b");
    // A vector without a shape, with a checksum of its own.
    let vector = checksum(&["zebra", "fused"], &[0; 12]);
    let vector = format!("INSERT INTO fused VALUES ('zebra', zeroblob(12), {vector})");
    for sql in [
        &vector,
        "UPDATE shapes SET label = 'dog' WHERE id = 'class1/0004'",
        "UPDATE shapes SET vertices = -1",
        "UPDATE shapes SET area = 1e300 WHERE id = 'class1/0004'",
        "UPDATE fused SET vector = zeroblob(12) WHERE id = 'class1/0004'",
        "UPDATE fused SET vector = zeroblob(13)",
        "UPDATE fused SET vector = zeroblob(60000000)",
        "UPDATE vectors SET vector = zeroblob(16) WHERE name = 'form'",
        "UPDATE vectors SET name = 'forms' WHERE name = 'form'",
        "UPDATE components SET place = place + 10",
        "DELETE FROM fused WHERE id = 'class1/0004'",
        "DELETE FROM shapes WHERE id = 'class1/0004'",
        "DELETE FROM meta",
        "UPDATE meta SET value = '99999999999999999999' WHERE name = 'shapes'",
        "DROP TABLE fused",
        "DROP TABLE shapes; CREATE VIEW shapes AS SELECT * FROM fused",
        "DROP TABLE components; CREATE VIRTUAL TABLE components USING fts5(id, place, vector, checksum)",
        "CREATE TRIGGER t AFTER INSERT ON shapes BEGIN DELETE FROM fused; END",
    ] {
        fs::copy(&template, &path).unwrap();
        forge(&path, sql);
        assert!(is_noticed(&path, &truth, sql) || sql.contains("TRIGGER"), "{sql}");
        if let Err(error) = read_all(&path) {
            assert!(matches!(error, IndexError::Damaged { .. }), "{sql}: {error}");
        }
        // A writer reports it or works, and never panics.
        let changed = IndexWriter::open(&path).and_then(|mut writer| {
            writer.put(&[shape(1000)])?;
            writer.finish().map(drop)
        });
        if let Err(error) = changed {
            let is_named = matches!(error, IndexError::Damaged { .. } | IndexError::OtherLength { .. });
            assert!(is_named, "{sql}: {error}");
        }
    }
}
