//! Changed bytes never become a result.

use std::fs;
use std::path::Path;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::{Folder, OPTIONS, export, shape};
use crate::{Index, IndexError, IndexWriter, Job, NearShape, Shape, damaged_path, verify};

/// Reads everything that an index holds.
fn read_all(path: &Path) -> Result<(Vec<Shape>, Vec<NearShape>), IndexError> {
    let index = Index::open(path)?;
    let mut shapes = Vec::new();
    index.each(|shape| {
        shapes.push(shape);
        Ok::<(), IndexError>(())
    })?;
    Ok((shapes, index.nearest(&shape(2).vectors.fused, 4)?))
}

#[test]
fn a_changed_byte_is_detected_and_never_returned() {
    let folder = Folder::new();
    let path = folder.index("a", 400);
    let whole = fs::read(&path).unwrap();
    folder.change(&path, &[400], &[shape(7).id]);
    let bytes = fs::read(&path).unwrap();
    assert!(bytes[4096..].starts_with(&whole[4096..]), "it has two segments");
    let truth = read_all(&path).unwrap();
    assert_eq!(verify(&path).unwrap().faults, Vec::<String>::new());
    // The start and the end completely, and a thousand other bytes.
    let tail = bytes.len().saturating_sub(100)..bytes.len();
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let others = (0..1000).map(|_| (random.next_u64() % bytes.len() as u64) as usize);
    let positions = (0..512).chain(others.collect::<Vec<_>>()).chain(tail);
    let copy = folder.path("b");
    for at in positions {
        let mut changed = bytes.clone();
        changed[at] ^= 1 << (at % 8);
        fs::write(&copy, &changed).unwrap();
        match verify(&copy) {
            Ok(found) => assert!(!found.faults.is_empty(), "byte {at} of {}", bytes.len()),
            Err(IndexError::Damaged { .. } | IndexError::Foreign(_)) => {}
            Err(error) => panic!("byte {at}: {error}"),
        }
        match read_all(&copy) {
            Ok(found) => assert_eq!(found, truth, "byte {at}"),
            Err(IndexError::Damaged { path, .. } | IndexError::Foreign(path)) => assert_eq!(path, copy),
            Err(error) => panic!("byte {at}: {error}"),
        }
    }
}

#[test]
fn a_truncated_file_is_damaged_and_bytes_after_the_end_do_not_count() {
    let folder = Folder::new();
    let bytes = fs::read(folder.index("a", 6)).unwrap();
    let copy = folder.path("b");
    for length in [bytes.len() - 1, bytes.len() - 36, bytes.len() / 2, 4096, 50, 4] {
        fs::write(&copy, &bytes[..length]).unwrap();
        let error = Index::open(&copy).unwrap_err();
        assert!(matches!(error, IndexError::Damaged { .. }), "{length}: {error}");
    }
    // What a writer left that was interrupted does not count.
    fs::write(&copy, [bytes.as_slice(), b"\n"].concat()).unwrap();
    assert_eq!(read_all(&copy).unwrap(), read_all(&folder.path("a")).unwrap());
    assert_eq!(verify(&copy).unwrap().faults, Vec::<String>::new());
    // Bytes missing from the middle.
    fs::write(&copy, [&bytes[..4096], &bytes[8192..]].concat()).unwrap();
    assert!(matches!(Index::open(&copy), Err(IndexError::Damaged { .. })));
}

#[test]
fn other_files_are_never_overwritten() {
    let folder = Folder::new();
    for (name, content) in [("notes.txt", &b"dear diary"[..]), ("empty", b""), ("long", &[b'x'; 9000])] {
        let path = folder.path(name);
        fs::write(&path, content).unwrap();
        for error in [
            Index::open(&path).unwrap_err(),
            verify(&path).unwrap_err(),
            IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap_err(),
        ] {
            assert!(matches!(error, IndexError::Foreign(_)) && error.to_string().contains(name), "{error}");
        }
        assert_eq!(fs::read(&path).unwrap(), content);
    }
    let error = Index::open(&folder.path(".")).unwrap_err();
    assert!(matches!(error, IndexError::Foreign(_) | IndexError::Io { .. }));
    assert_eq!(folder.names(), ["empty", "long", "notes.txt"]);
}

/// States another format in the head of an index.
fn set_format(bytes: &mut [u8], format: u32) {
    for slot in [0, 2048] {
        bytes[slot + 16..slot + 20].copy_from_slice(&format.to_le_bytes());
        let sum = crc32fast::hash(&bytes[slot..slot + 44]);
        bytes[slot + 44..slot + 48].copy_from_slice(&sum.to_le_bytes());
    }
}

#[test]
fn another_format_is_reported_and_an_earlier_one_built_again() {
    let folder = Folder::new();
    let path = folder.index("a", 3);
    let (whole, current) = (export(&path), fs::read(&path).unwrap());
    let format = |format: u32| {
        let mut bytes = current.clone();
        set_format(&mut bytes, format);
        bytes
    };
    fs::write(&path, format(7)).unwrap();
    for error in
        [Index::open(&path).unwrap_err(), IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap_err()]
    {
        assert!(matches!(error, IndexError::FutureVersion { found: 7, .. }), "{error}");
        assert!(error.to_string().contains("format 7") && error.to_string().contains("newer"), "{error}");
    }
    assert_eq!(fs::read(&path).unwrap(), format(7));
    let format_1 = [b"redb", &[7; 5000][..], b"canonform index\n"].concat();
    for (found, bytes) in [(4, format(4)), (1, format_1)] {
        fs::write(&path, &bytes).unwrap();
        for error in [Index::open(&path).unwrap_err(), IndexWriter::open(&path, Job::Add, None).unwrap_err()]
        {
            let is_reported = matches!(error, IndexError::PastVersion { found: known, .. } if known == found);
            assert!(is_reported, "{error}");
        }
        built_again(&path, 3);
        assert_eq!(export(&path), whole);
        assert_eq!(fs::read(damaged_path(&path)).unwrap(), bytes);
    }
    // Any other database is not ours.
    fs::write(&path, [b"redb", &[7; 5000][..]].concat()).unwrap();
    assert!(matches!(Index::open(&path), Err(IndexError::Foreign(_))));
}

/// Replaces an index that cannot be read by one of `n` shapes; until that is finished, the first one stays.
fn built_again(path: &Path, n: usize) {
    let bytes = fs::read(path).unwrap();
    let mut writer = IndexWriter::open(path, Job::Build, Some(OPTIONS)).unwrap();
    assert!(writer.replaces_damaged() && writer.n_shapes().unwrap() == 0);
    writer.put(&(0..n).map(shape).collect::<Vec<_>>()).unwrap();
    assert_eq!(fs::read(path).unwrap(), bytes);
    writer.finish(&()).unwrap();
}

#[test]
fn a_damaged_index_cannot_be_extended_and_is_built_again_and_kept_under_another_name() {
    let folder = Folder::new();
    let path = folder.index("a", 200);
    let whole = export(&path);
    let mut bytes = fs::read(&path).unwrap();
    // In the first of the vectors, which every writer reads.
    let first = bytes.windows(5).rposition(|bytes| bytes == b"\x03clas").unwrap();
    bytes[first + 20] ^= 1;
    fs::write(&path, &bytes).unwrap();
    match IndexWriter::open(&path, Job::Add, None) {
        Err(IndexError::Damaged { .. }) => {}
        other => panic!("{other:?}"),
    }
    assert_eq!(fs::read(&path).unwrap(), bytes);
    built_again(&path, 200);
    assert_eq!(export(&path), whole);
    assert_eq!(fs::read(damaged_path(&path)).unwrap(), bytes);
    assert_eq!(folder.names(), ["a", "a.damaged"]);
    IndexWriter::open(&path, Job::Add, None).unwrap().discard().unwrap();
    assert_eq!(export(&path), whole);
}
