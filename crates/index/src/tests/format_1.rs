//! Files of format 1 are read and searched; changing one writes it anew.

use std::fs;
use std::path::Path;

use super::{Folder, OPTIONS, export, shape};
use crate::format::{BLOCK, HEAD, make_format_1};
use crate::{Index, IndexError, IndexWriter, Job, SearchMode, Searcher, verify, work_path};

/// Writes the index of shapes 0 to `n` in format 1.
fn write(path: &Path, n: usize) {
    let mut writer = IndexWriter::open(path, Job::Build, Some(OPTIONS)).unwrap();
    writer.put(&(0..n).map(shape).collect::<Vec<_>>()).unwrap();
    make_format_1(&writer.store()).unwrap();
    drop(writer);
    let database = fs::read(work_path(path)).unwrap().split_off(HEAD as usize);
    fs::remove_file(work_path(path)).unwrap();
    let size = (database.len() as u64).to_le_bytes();
    let with_sum = |bytes: Vec<u8>| [&bytes[..], &crc32fast::hash(&bytes).to_le_bytes()].concat();
    let sums: Vec<u8> =
        database.chunks(BLOCK).flat_map(|block| crc32fast::hash(block).to_le_bytes()).collect();
    let mut footer = [&size[..], &crc32fast::hash(&sums).to_le_bytes()].concat();
    footer.extend([4096u32, 1].map(u32::to_le_bytes).concat());
    footer.extend(crc32fast::hash(&[&footer[..], b"canonform index\n"].concat()).to_le_bytes());
    footer.extend(b"canonform index\n");
    let mark = with_sum([&b"canonform ->"[..], &size].concat());
    fs::write(path, [database, mark, sums, footer].concat()).unwrap();
}

#[test]
fn format_1_is_read_searched_and_written_anew() {
    let folder = Folder::new();
    let path = folder.path("a");
    write(&path, 60);
    let (old, new) = (Index::open(&path).unwrap(), Index::open(&folder.index("b", 60)).unwrap());
    assert_eq!(export(&path), export(&folder.path("b")));
    assert_eq!(old.classes().unwrap(), new.classes().unwrap());
    let query = shape(70).vectors.fused;
    let found = new.nearest(&query, 5, SearchMode::Auto).unwrap();
    assert_eq!(old.nearest(&query, 5, SearchMode::Auto).unwrap(), found);
    assert_eq!(Searcher::load(&old).unwrap().nearest(&query, 5, SearchMode::Exact).unwrap(), found);
    assert_eq!(verify(&path, || ()).unwrap().faults, Vec::<String>::new());
    folder.change(&path, &[60], &[shape(0).id]);
    folder.change(&folder.path("b"), &[60], &[shape(0).id]);
    let (old, new) = (Index::open(&path).unwrap(), Index::open(&folder.path("b")).unwrap());
    assert_eq!(export(&path), export(&folder.path("b")));
    let found = new.nearest(&query, 5, SearchMode::Auto).unwrap();
    assert_eq!(
        (old.nearest(&query, 5, SearchMode::Auto).unwrap(), old.classes().unwrap()),
        (found, new.classes().unwrap())
    );
    assert_eq!(verify(&path, || ()).unwrap().faults, Vec::<String>::new());
}

#[test]
fn damage_of_format_1_is_detected() {
    let folder = Folder::new();
    let path = folder.path("a");
    write(&path, 6);
    let whole = fs::read(&path).unwrap();
    for at in (0..whole.len()).step_by(997).chain(whole.len() - 200..whole.len()) {
        let mut bytes = whole.clone();
        bytes[at] ^= 4;
        fs::write(&path, &bytes).unwrap();
        match verify(&path, || ()) {
            Ok(found) => assert!(!found.faults.is_empty(), "byte {at}"),
            Err(IndexError::Damaged { .. } | IndexError::Foreign(_)) => {}
            Err(error) => panic!("byte {at}: {error}"),
        }
    }
    fs::write(&path, &whole[..whole.len() - 1]).unwrap();
    assert!(matches!(Index::open(&path), Err(IndexError::Damaged { .. })));
}
