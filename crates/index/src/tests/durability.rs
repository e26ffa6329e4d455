//! Readers, writers and interruptions.

use std::fs;

use super::{Folder, OPTIONS, export, shape};
use crate::{Index, IndexError, IndexWriter, Job, work_path};

#[test]
fn readers_see_the_old_index_until_the_new_one_is_finished() {
    let folder = Folder::new();
    let path = folder.index("a", 5);
    let early = Index::open(&path).unwrap();
    let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    writer.put(&[shape(5)]).unwrap();
    let meanwhile = Index::open(&path).unwrap();
    let index = writer.finish().unwrap();
    assert_eq!((early.len(), meanwhile.len(), index.len()), (5, 5, 6));
    // Earlier readers still see the old state.
    assert!(early.entry(&shape(5).id).is_err());
    assert_eq!(early.vectors(&shape(4).id).unwrap(), shape(4).vectors);
    assert_eq!(Index::open(&path).unwrap().vectors(&shape(5).id).unwrap(), shape(5).vectors);
}

#[test]
fn an_index_has_one_writer_at_a_time() {
    let folder = Folder::new();
    let path = folder.index("a", 5);
    let before = fs::read(&path).unwrap();
    let first = IndexWriter::open(&path, Job::Add, None).unwrap();
    let error = IndexWriter::open(&path, Job::Add, None).unwrap_err();
    assert!(
        matches!(&error, IndexError::Busy(_)) && error.to_string().contains("another program"),
        "{error}"
    );
    assert_eq!(fs::read(&path).unwrap(), before);
    drop(first);
    assert!(IndexWriter::open(&path, Job::Add, None).unwrap().is_resumed());
}

#[test]
fn other_jobs_and_other_options_are_not_mixed() {
    let folder = Folder::new();
    let path = folder.path("a");
    let mut writer = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
    writer.put(&[shape(0)]).unwrap();
    drop(writer);
    let error = IndexWriter::open(&path, Job::Build, Some("n=50")).unwrap_err().to_string();
    assert!(error.contains("a.work") && error.contains("n=50") && error.contains(OPTIONS), "{error}");
    let error = IndexWriter::open(&path, Job::Add, Some(OPTIONS)).unwrap_err().to_string();
    assert!(error.contains("`build`") && error.contains("a.work") && error.contains("delete"), "{error}");
    IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap().finish().unwrap();
    let error = IndexWriter::open(&path, Job::Build, Some("n=50")).unwrap_err().to_string();
    assert!(error.contains("other options") && error.contains("n=50"), "{error}");
    let error = IndexWriter::open(&folder.path("none"), Job::Add, None).unwrap_err().to_string();
    assert!(error.contains("none") && error.contains("check the path"), "{error}");
    assert_eq!(folder.names(), ["a"]);
}

#[test]
fn an_interrupted_removal_starts_over() {
    let folder = Folder::new();
    let path = folder.index("a", 5);
    let mut writer = IndexWriter::open(&path, Job::Remove, None).unwrap();
    writer.remove(&[shape(1).id]).unwrap();
    drop(writer);
    let writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    assert_eq!((writer.is_resumed(), writer.len().unwrap()), (false, 5));
}

/// As a copy looks before the job of its writer is recorded.
#[test]
fn a_writer_interrupted_before_it_began_blocks_nobody() {
    let folder = Folder::new();
    let path = folder.index("a", 5);
    for (job, n_shapes) in [(Job::Add, 5), (Job::Remove, 5), (Job::Build, 5), (Job::Merge, 0)] {
        fs::copy(&path, work_path(&path)).unwrap();
        let writer = IndexWriter::open(&path, job, Some(OPTIONS)).unwrap();
        assert_eq!(writer.len().unwrap(), n_shapes, "{job:?}");
        drop(writer);
        fs::remove_file(work_path(&path)).unwrap();
    }
}

#[test]
fn additions_start_over_if_the_index_changed() {
    let folder = Folder::new();
    let path = folder.index("a", 5);
    let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    writer.put(&[shape(9)]).unwrap();
    drop(writer);
    fs::rename(folder.index("b", 7), &path).unwrap();
    let writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    assert_eq!((writer.is_resumed(), writer.len().unwrap()), (false, 7));
}

#[test]
fn a_writer_survives_an_interruption_at_any_byte() {
    let folder = Folder::new();
    let path = folder.index("a", 30);
    let whole = export(&path);
    let finished = fs::read(&path).unwrap();
    let work = work_path(&path);
    // During the copy, when the first block is still missing.
    for length in [0, 100, 4096, finished.len() / 2] {
        let mut cut = finished[..length].to_vec();
        let head = cut.len().min(4096);
        cut[..head].fill(0);
        fs::write(&work, cut).unwrap();
        let writer = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
        assert_eq!((writer.is_resumed(), writer.len().unwrap()), (false, 30));
        writer.discard().unwrap();
    }
    // While checksums and footer are written, and just before the file is renamed.
    let mut writer = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
    writer.put(&[shape(30)]).unwrap();
    drop(writer);
    IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap().finish().unwrap();
    let sealed = fs::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    let database = sealed.len() - sealed.len() % 4096;
    for length in (database..sealed.len()).step_by(7).chain([sealed.len() - 1, sealed.len()]) {
        fs::write(&work, &sealed[..length]).unwrap();
        let resumed = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
        assert_eq!((resumed.is_resumed(), resumed.len().unwrap()), (true, 31), "{length}");
    }
    IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap().finish().unwrap();
    fs::rename(&path, &work).unwrap();
    let resumed = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
    assert_eq!((resumed.is_resumed(), resumed.len().unwrap()), (true, 31));
    let mut index = resumed;
    index.remove(&[shape(30).id]).unwrap();
    index.finish().unwrap();
    assert_eq!(export(&path), whole);
}

#[test]
fn an_unwritable_folder_is_reported() {
    let folder = Folder::new();
    let before = fs::read(folder.index("a", 3)).unwrap();
    let path = folder.path("nowhere/a");
    let error = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap_err().to_string();
    assert!(error.contains("nowhere") && error.contains("cannot write"), "{error}");
    // A folder has the name of the work file.
    fs::create_dir(folder.path("a.work")).unwrap();
    let error = IndexWriter::open(&folder.path("a"), Job::Add, None).unwrap_err().to_string();
    assert!(error.contains("cannot write") && error.contains("a.work"), "{error}");
    assert_eq!(fs::read(folder.path("a")).unwrap(), before);
}

#[test]
fn vectors_that_cannot_be_compared_are_rejected() {
    let folder = Folder::new();
    let path = folder.path("a");
    let mut writer = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
    writer.put(&[shape(0)]).unwrap();
    let with = |fused: Vec<f32>| {
        let mut shape = shape(1);
        shape.vectors.fused = fused;
        [shape]
    };
    assert!(matches!(writer.put(&with(vec![])), Err(IndexError::BadVector(_))));
    assert!(matches!(writer.put(&with(vec![1.0, f32::NAN, 1.0])), Err(IndexError::BadVector(_))));
    let error = writer.put(&with(vec![1.0; 4])).unwrap_err();
    assert!(matches!(error, IndexError::OtherLength { found: 4, expected: 3, .. }));
    let mut large = shape(1);
    large.vectors.form = vec![[0.0; 4]; 5 << 20];
    assert!(matches!(writer.put(&[large]), Err(IndexError::Codec { .. })));
    assert_eq!(writer.len().unwrap(), 1);
    assert_eq!(writer.finish().unwrap().len(), 1);
}
