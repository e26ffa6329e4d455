//! Readers, writers and interruptions.

use std::fs;
use std::path::Path;

use super::{Folder, OPTIONS, export, shape};
use crate::format::sealed_whole;
use crate::{Index, IndexError, IndexWriter, Job, Shape, verify, work_path};

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

/// The work file of an interrupted job.
fn interrupted(path: &Path, job: Job, shapes: &[Shape]) -> Vec<u8> {
    let mut writer = IndexWriter::open(path, job, Some(OPTIONS)).unwrap();
    writer.put(shapes).unwrap();
    drop(writer);
    let bytes = fs::read(work_path(path)).unwrap();
    fs::remove_file(work_path(path)).unwrap();
    bytes
}

#[test]
fn a_build_survives_an_interruption_at_any_byte() {
    let folder = Folder::new();
    let path = folder.path("a");
    let shapes: Vec<Shape> = (0..31).map(shape).collect();
    let begun = interrupted(&path, Job::Build, &shapes);
    let work = work_path(&path);
    // Before the head is written.
    for length in [0, 51] {
        fs::write(&work, &begun[..length]).unwrap();
        let writer = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
        assert_eq!((writer.is_resumed(), writer.len().unwrap()), (false, 0));
        writer.discard().unwrap();
    }
    // While checksums and footer are written, and just before the file is renamed.
    let sealed = fs::read(folder.index("b", 31)).unwrap();
    let (end, _) = sealed_whole(&mut fs::File::open(folder.path("b")).unwrap(), &path).unwrap().unwrap();
    let end = end as usize;
    let mut head = begun[..4096].to_vec();
    head[32..40].copy_from_slice(&(end as u64).to_le_bytes());
    let sum = crc32fast::hash(&head[..48]);
    head[48..52].copy_from_slice(&sum.to_le_bytes());
    for length in (end..sealed.len()).step_by(7).chain([sealed.len() - 1, sealed.len()]) {
        fs::write(&work, [&head, &sealed[4096..length]].concat()).unwrap();
        let resumed = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
        assert_eq!((resumed.is_resumed(), resumed.len().unwrap()), (true, 31), "{length}");
    }
    fs::write(&work, &sealed).unwrap();
    let mut resumed = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
    assert_eq!((resumed.is_resumed(), resumed.len().unwrap()), (true, 31));
    resumed.remove(&[shape(30).id]).unwrap();
    resumed.finish().unwrap();
    assert_eq!(export(&path), export(&folder.index("c", 30)));
    assert_eq!(verify(&path, || ()).unwrap().faults, Vec::<String>::new());
}

#[test]
fn an_addition_survives_an_interruption_at_any_byte() {
    let folder = Folder::new();
    let path = folder.index("a", 400);
    let before = fs::read(&path).unwrap();
    let added = [shape(400), shape(401)];
    let work = interrupted(&path, Job::Add, &added);
    fs::write(work_path(&path), &work).unwrap();
    let writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    assert_eq!((writer.is_resumed(), writer.len().unwrap()), (true, 402));
    writer.finish().unwrap();
    let after = fs::read(&path).unwrap();
    assert_eq!(folder.names(), ["a"]);
    assert!(after[4096..].starts_with(&before[4096..]), "nothing is overwritten");
    let whole = export(&path);
    assert_eq!(whole, export(&folder.index("b", 402)));
    // While the segment is appended: the old index, and the work goes on.
    let steps = (before.len()..=after.len()).step_by(20_000).chain([after.len()]);
    for length in steps {
        fs::write(&path, [&before[..4096], &after[4096..length]].concat()).unwrap();
        fs::write(work_path(&path), &work).unwrap();
        assert_eq!(Index::open(&path).unwrap().len(), 400);
        assert_eq!(verify(&path, || ()).unwrap().faults, Vec::<String>::new());
        let writer = IndexWriter::open(&path, Job::Add, None).unwrap();
        assert_eq!((writer.is_resumed(), writer.len().unwrap()), (true, 402));
        writer.finish().unwrap();
        assert_eq!(export(&path), whole);
    }
    // After it counts, but before the work file is removed.
    fs::write(&path, &after).unwrap();
    fs::write(work_path(&path), &work).unwrap();
    let writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    assert_eq!((writer.is_resumed(), writer.len().unwrap()), (false, 402));
}

#[test]
fn changes_after_an_interrupted_end_are_not_lost() {
    let folder = Folder::new();
    let path = folder.index("a", 60);
    let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    writer.put(&[shape(60), shape(61)]).unwrap();
    writer.refresh(&()).unwrap();
    drop(writer);
    let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    assert!(writer.is_resumed());
    writer.remove(&[shape(60).id, shape(0).id]).unwrap();
    writer.finish().unwrap();
    assert_eq!(verify(&path, || ()).unwrap().faults, Vec::<String>::new());
    assert_eq!(Index::open(&path).unwrap().len(), 60);
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
