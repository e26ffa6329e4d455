//! Files that were changed together with their checksums: an error, or an answer, but never a panic.

use std::fs;
use std::path::{Path, PathBuf};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::{Folder, shape};
use crate::store::{Changes, write_forged};
use crate::tables::{ABOUT, About, ENTRIES};
use crate::{Index, IndexError, IndexWriter, Job, Shape, verify, work_path};

/// Bytes before the first segment.
const HEAD: usize = 4096;

/// The places of the list of blocks and of the footer in an index of one segment.
fn parts(bytes: &[u8]) -> (usize, usize) {
    let number = |at: usize| u64::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize;
    let footer = number(28) - 40;
    (footer - number(footer + 16), footer)
}

/// Computes all checksums again, as far as the list of blocks can be followed.
fn seal(bytes: &mut [u8], (list, footer): (usize, usize)) {
    let number = |bytes: &[u8], at: usize| u32::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize;
    let put = |bytes: &mut [u8], at: usize, range: std::ops::Range<usize>| {
        let sum = crc32fast::hash(&bytes[range]);
        bytes[at..at + 4].copy_from_slice(&sum.to_le_bytes());
    };
    let (mut at, mut block) = (list, HEAD);
    while at + 12 <= footer {
        let end = block + number(bytes, at);
        if end > list {
            break;
        }
        put(bytes, at + 4, block..end);
        (at, block) = (at + 12 + number(bytes, at + 8), end);
    }
    put(bytes, footer + 24, list..footer);
    put(bytes, footer + 32, footer..footer + 32);
    for slot in [0, HEAD / 2] {
        bytes.copy_within(footer + 32..footer + 36, slot + 36);
        put(bytes, slot + 44, slot..slot + 44);
    }
}

/// Reads everything in every way.
fn read(path: &Path) -> Result<(), IndexError> {
    let index = Index::open(path)?;
    let everything = [
        index.entries().map(drop),
        index.each(|shape: Shape| {
            index.entry(&shape.id)?;
            index.vectors(&shape.id).map(drop)
        }),
        index.contains("class1/0004").map(drop),
        index.nearest(&shape(2).vectors.fused, 4).map(drop),
        index.nearest_on_graph(&shape(2).vectors.fused, 4).map(drop),
        match index.export(&mut std::io::sink()) {
            Err(crate::ExportError::Index(error)) => Err(error),
            _ => Ok(()),
        },
    ];
    everything.into_iter().collect()
}

/// Adds a shape and removes one.
fn change(path: &Path) -> Result<(), IndexError> {
    let mut writer = IndexWriter::open(path, Job::Add, None)?;
    writer.put(&[shape(1000)])?;
    writer.remove(&[shape(3).id])?;
    writer.entries()?;
    writer.finish(&()).map(drop)
}

/// What a forged file may end with.
fn is_clean(result: &Result<(), IndexError>) -> bool {
    use IndexError as E;
    match result {
        // A forged name, length or option is an ordinary one.
        Ok(()) | Err(E::Damaged { .. } | E::NoSuchShape { .. } | E::OtherLength { .. }) => true,
        Err(E::Foreign(_) | E::Io { .. } | E::Codec { .. }) => true,
        Err(_) => false,
    }
}

#[test]
fn a_forged_file_is_an_error_or_an_index() {
    let folder = Folder::new();
    let whole = fs::read(folder.index("a", 400)).unwrap();
    let places = parts(&whole);
    let (list, footer) = places;
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut below = |n: usize| (random.next_u64() % n as u64) as usize;
    let path: PathBuf = folder.path("forged");
    let mut refused = 0;
    for turn in 0..300 {
        let mut bytes = whole.clone();
        for _ in 0..1 + below(3) {
            // Every tenth time, where blocks and segments are.
            let at = match turn % 10 {
                0 => list + below(footer + 24 - list),
                _ => HEAD + below(list - HEAD),
            };
            bytes[at] = match below(4) {
                0 => 0,
                1 => 255,
                _ => below(256) as u8,
            };
        }
        seal(&mut bytes, places);
        fs::write(&path, &bytes).unwrap();
        let result = read(&path);
        assert!(is_clean(&result), "turn {turn}: {result:?}");
        refused += usize::from(result.is_err());
        // Verification finds whatever keeps the rest from working.
        if let Ok(found) = verify(&path) {
            assert!(result.is_ok() || !found.faults.is_empty(), "turn {turn}: {result:?}");
        }
        if turn % 4 == 0 {
            let result = change(&path);
            assert!(is_clean(&result), "turn {turn}: {result:?}");
            let _ = fs::remove_file(work_path(&path));
        }
    }
    assert!(refused > 50, "{refused} of 300 files are refused");
}

#[test]
fn a_forged_count_reserves_no_memory() {
    let folder = Folder::new();
    let index = Index::open(&folder.index("a", 20)).unwrap();
    let about = ABOUT.get(index.view(), "").unwrap().unwrap();
    let records: Vec<_> = index.view().records(&[]).map(Result::unwrap).collect();
    for (dim, n) in [(usize::MAX - 3, 20), (3, usize::MAX), (3, 19), (3, 0)] {
        let mut forged = Changes::from_iter(records.clone());
        ABOUT.put(&mut forged, "", Some(&About { dim, n, ..about.clone() })).unwrap();
        let path = folder.path("b");
        write_forged(&path, forged.into_iter().collect());
        assert!(matches!(read(&path), Err(IndexError::Damaged { .. })), "{dim} {n}");
    }
}

#[test]
fn rows_out_of_order_are_damage() {
    let folder = Folder::new();
    let index = Index::open(&folder.index("a", 20)).unwrap();
    let mut records: Vec<_> = index.view().records(&[]).map(Result::unwrap).collect();
    let places: Vec<usize> = (0..records.len()).filter(|i| records[*i].0[0] == ENTRIES.key("")[0]).collect();
    for (a, b) in [(places[3], places[4]), (places[0], places[19])] {
        records.swap(a, b);
        let path = folder.path("b");
        write_forged(&path, records.clone());
        assert!(matches!(read(&path), Err(IndexError::Damaged { .. })));
        records.swap(a, b);
    }
    records.insert(places[7], records[places[7]].clone());
    write_forged(&folder.path("b"), records);
    assert!(matches!(read(&folder.path("b")), Err(IndexError::Damaged { .. })));
}
