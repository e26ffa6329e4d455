//! Readers, writers and interruptions.

use std::fs;
use std::path::Path;

use super::{Folder, OPTIONS, export, shape};
use crate::{Index, IndexError, IndexWriter, Job, Shape, verify, work_path};

#[test]
fn readers_see_the_old_index_until_the_new_one_is_finished() {
    let folder = Folder::new();
    let path = folder.index("a", 5);
    let early = Index::open(&path).unwrap();
    let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    writer.put(&[shape(5)]).unwrap();
    let meanwhile = Index::open(&path).unwrap();
    let index = writer.finish(&()).unwrap();
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
    IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap().finish(&()).unwrap();
    let error = IndexWriter::open(&path, Job::Build, Some("n=50")).unwrap_err().to_string();
    assert!(error.contains("other options") && error.contains("n=50"), "{error}");
    let error = IndexWriter::open(&folder.path("none"), Job::Add, None).unwrap_err().to_string();
    assert!(error.contains("none") && error.contains("check that the path exists"), "{error}");
    assert_eq!(folder.names(), ["a"]);
}

#[test]
fn interrupted_removals_and_additions_to_an_index_that_changed_start_over() {
    let folder = Folder::new();
    let path = folder.index("a", 5);
    let mut writer = IndexWriter::open(&path, Job::Remove, None).unwrap();
    writer.remove(&[shape(1).id]).unwrap();
    drop(writer);
    let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    assert_eq!((writer.is_resumed(), writer.n_shapes().unwrap()), (false, 5));
    writer.put(&[shape(9)]).unwrap();
    drop(writer);
    fs::rename(folder.index("b", 7), &path).unwrap();
    let writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    assert_eq!((writer.is_resumed(), writer.n_shapes().unwrap()), (false, 7));
}

#[test]
fn a_writer_interrupted_before_it_began_blocks_nobody() {
    let folder = Folder::new();
    let path = folder.index("a", 5);
    let begun = interrupted(&path, Job::Add, &[]);
    for length in 0..begun.len() {
        for (job, n_shapes) in [(Job::Add, 5), (Job::Build, 5), (Job::Merge, 0)] {
            fs::write(work_path(&path), &begun[..length]).unwrap();
            let writer = IndexWriter::open(&path, job, Some(OPTIONS)).unwrap();
            // All of it but the frame of the put, which is empty.
            let is_begun = length >= begun.len() - 12 && job == Job::Add;
            assert_eq!(
                (writer.is_resumed(), writer.n_shapes().unwrap()),
                (is_begun, n_shapes),
                "{job:?} {length}"
            );
            if is_begun {
                break;
            }
        }
    }
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
    let work = work_path(&path);
    let mut ends = Vec::new();
    let mut writer = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
    for i in 0..31 {
        writer.put(&[shape(i)]).unwrap();
        ends.push(fs::metadata(&work).unwrap().len());
    }
    drop(writer);
    let log = fs::read(&work).unwrap();
    for length in (ends[0] as usize..=log.len()).step_by(37).chain([log.len()]) {
        fs::write(&work, &log[..length]).unwrap();
        let resumed = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
        let n_whole = ends.iter().filter(|end| **end <= length as u64).count();
        assert_eq!((resumed.is_resumed(), resumed.n_shapes().unwrap()), (true, n_whole), "{length}");
    }
    // What the last writer did not finish is gone, and the work goes on.
    fs::write(&work, &log[..log.len() - 1]).unwrap();
    let mut resumed = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
    resumed.put(&[shape(30), shape(31)]).unwrap();
    drop(resumed);
    assert_eq!(folder.names(), ["a.work"]);
    let mut resumed = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
    assert_eq!((resumed.n_shapes().unwrap(), resumed.entries().unwrap().len()), (32, 32));
    assert_eq!(resumed.entry(&shape(32).id).unwrap(), None);
    resumed.remove(&[shape(31).id]).unwrap();
    resumed.finish(&()).unwrap();
    assert_eq!(folder.names(), ["a"]);
    assert_eq!(export(&path), export(&folder.index("c", 31)));
    assert_eq!(verify(&path).unwrap().faults, Vec::<String>::new());
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
    assert_eq!((writer.is_resumed(), writer.n_shapes().unwrap()), (true, 402));
    writer.finish(&()).unwrap();
    let after = fs::read(&path).unwrap();
    assert_eq!(folder.names(), ["a"]);
    assert!(after[4096..].starts_with(&before[4096..]), "nothing is overwritten");
    let whole = export(&path);
    assert_eq!(whole, export(&folder.index("b", 402)));
    // While the segment is appended: the old index, and the work goes on.
    let steps = (before.len()..=after.len()).step_by(5000).chain([after.len()]);
    for length in steps {
        fs::write(&path, [&before[..4096], &after[4096..length]].concat()).unwrap();
        fs::write(work_path(&path), &work).unwrap();
        assert_eq!(Index::open(&path).unwrap().len(), 400);
        assert_eq!(verify(&path).unwrap().faults, Vec::<String>::new());
        let writer = IndexWriter::open(&path, Job::Add, None).unwrap();
        assert_eq!((writer.is_resumed(), writer.n_shapes().unwrap()), (true, 402));
        writer.finish(&()).unwrap();
        assert_eq!(export(&path), whole);
    }
    // After it counts, but before the work file is removed.
    fs::write(&path, &after).unwrap();
    fs::write(work_path(&path), &work).unwrap();
    let writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    assert_eq!((writer.is_resumed(), writer.n_shapes().unwrap()), (false, 402));
}

#[test]
fn changes_after_an_interrupted_end_are_not_lost() {
    let folder = Folder::new();
    let path = folder.index("a", 60);
    let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    writer.put(&[shape(60), shape(61)]).unwrap();
    drop(writer);
    let mut writer = IndexWriter::open(&path, Job::Add, None).unwrap();
    assert!(writer.is_resumed());
    writer.remove(&[shape(60).id, shape(0).id]).unwrap();
    writer.finish(&()).unwrap();
    assert_eq!(verify(&path).unwrap().faults, Vec::<String>::new());
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
    assert_eq!(writer.n_shapes().unwrap(), 1);
    assert_eq!(writer.finish(&()).unwrap().len(), 1);
}
