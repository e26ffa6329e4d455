//! Files that were changed together with their checksums: an error, or an answer, but never a panic.

use std::fs;
use std::path::{Path, PathBuf};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::{Folder, shape};
use crate::format::{BLOCK, HEAD, seal, sealed_whole};
use crate::{Index, IndexError, IndexWriter, Job, SearchMode, Searcher, Shape, verify, work_path};

/// The bytes of an index that is sealed whole, without head, checksums and footer.
fn database(path: &Path) -> Vec<u8> {
    let (end, padding) = sealed_whole(&mut fs::File::open(path).unwrap(), path).unwrap().unwrap();
    fs::read(path).unwrap()[HEAD as usize + padding as usize * BLOCK..end as usize].to_vec()
}

/// Writes a file that holds this database, with the right checksums.
fn forge(path: &Path, database: &[u8]) {
    fs::write(path, [&[0; HEAD as usize], database].concat()).unwrap();
    let mut file = fs::OpenOptions::new().read(true).write(true).open(path).unwrap();
    seal(&mut file, 0).unwrap();
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
        index.nearest(&shape(2).vectors.fused, 4, SearchMode::Auto).map(drop),
        match index.nearest_on_graph(&shape(2).vectors.fused, 4, SearchMode::Auto) {
            // A forged property may say that there is none.
            Ok(_) | Err(IndexError::NoGraph(_)) => Ok(()),
            Err(error) => Err(error),
        },
        Searcher::load(&index)
            .and_then(|searcher| searcher.nearest(&shape(2).vectors.fused, 4, SearchMode::Exact))
            .map(drop),
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
    writer.finish().map(drop)
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
    let whole = database(&folder.index("a", 400));
    let n_pages = whole.len() / BLOCK;
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut below = |n: usize| (random.next_u64() % n as u64) as usize;
    let path: PathBuf = folder.path("forged");
    let (mut refused, mut panics) = (0, 0);
    for turn in 0..600 {
        let mut bytes = whole.clone();
        for _ in 0..1 + below(3) {
            // The first bytes of a page say where everything else is. Every tenth time, the first page.
            let page = if turn % 10 == 0 { 0 } else { below(n_pages) };
            let inside = if below(2) == 0 { below(64) } else { below(BLOCK) };
            bytes[page * BLOCK + inside] = match below(4) {
                0 => 0,
                1 => 255,
                _ => below(256) as u8,
            };
        }
        forge(&path, &bytes);
        let result = read(&path);
        assert!(is_clean(&result), "turn {turn}: {result:?}");
        if let Err(error) = &result {
            refused += 1;
            panics += usize::from(error.to_string().contains("contradicts itself"));
        }
        // Verification finds whatever keeps the rest from working.
        if let Ok(found) = verify(&path, || ()) {
            assert!(result.is_ok() || !found.faults.is_empty(), "turn {turn}");
        }
        if turn % 4 == 0 {
            let result = change(&path);
            assert!(is_clean(&result), "turn {turn}: {result:?}");
            let _ = fs::remove_file(work_path(&path));
        }
    }
    assert!(refused > 100 && panics > 20, "{refused} of 600 files are refused, {panics} by a panic");
}

#[test]
fn a_forged_count_reserves_no_memory() {
    use crate::format::write_header;
    let folder = Folder::new();
    for (dim, n, n_cells) in [
        (usize::MAX - 3, 20, 1),
        (3, usize::MAX, 1),
        (0, 20, 1),
        (3, 20, 0),
        (3, 20, usize::MAX),
        (3, 20, 20),
    ] {
        let path = folder.path("a");
        let mut writer = IndexWriter::open(&path, Job::Build, Some(super::OPTIONS)).unwrap();
        writer.put(&(0..20).map(shape).collect::<Vec<_>>()).unwrap();
        writer.refresh(&()).unwrap();
        write_header(&writer.store(), dim, n, n_cells).unwrap();
        writer.finish().unwrap();
        assert!(matches!(read(&path), Err(IndexError::Damaged { .. })), "{dim} {n} {n_cells}");
        fs::remove_file(path).unwrap();
    }
}
