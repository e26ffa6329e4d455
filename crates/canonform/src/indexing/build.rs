//! Making the index of a folder.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Instant;

use index::{Index, IndexError, IndexWriter, Job, Shape, ShapeEntry, work_path};
use rayon::prelude::*;
use serde::Serialize;

use super::record::{options_text, path_text, same_source, shape};
use super::source::{Hashed, Shard, hash_all, name_apart, share};
use crate::{
    DescribeOptions, LabelFile, Observer, PipelineError, ShapeFile, Surface, describe_surface, list_shapes,
};

/// Shapes put on the disk together at most, when several are waiting.
const BATCH: usize = 64;

/// Described shapes that may wait for the disk.
const WAITING: usize = 64;

/// How the index of a folder is made.
#[derive(Debug, Clone, Copy)]
pub struct BuildOptions<'a> {
    /// How shapes are described.
    pub describe: &'a DescribeOptions,
    /// Classes by name; without, they follow from names.
    pub labels: Option<&'a LabelFile>,
    /// The share of the folder that is indexed. Default: all of it.
    pub shard: Option<Shard>,
}

/// A mesh that is not in the index, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failure {
    /// Its name.
    pub id: String,
    /// Where it is.
    pub path: PathBuf,
    /// What is wrong.
    pub error: String,
}

/// What became of the meshes.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct BuildReport {
    /// Shapes of the index now.
    pub n_shapes: usize,
    /// Shapes that were described.
    pub described: usize,
    /// Shapes that were there already, of the same content: in the index, or from before an interruption.
    pub unchanged: usize,
    /// Shapes whose file or class is named otherwise now.
    pub renamed: usize,
    /// Shapes that were taken out: their files are gone, or cannot be read any more.
    pub removed: usize,
    /// Whether an interrupted run was taken up.
    pub resumed: bool,
    /// Meshes that could not be described, in order.
    pub failed: Vec<Failure>,
    /// Wall-clock seconds.
    pub seconds: f64,
}

impl BuildReport {
    fn fail(&mut self, file: &ShapeFile, fault: &PipelineError) {
        let (id, path) = (file.name.clone(), file.path.clone());
        self.failed.push(Failure { id, path, error: fault.to_string() });
    }
}

/// Makes `path` the index of the meshes in `folder`: describes what is new or has changed, takes out what is
/// gone, and leaves the rest as it is.
///
/// Every described shape is on the disk before `observer` hears of it. A run that is interrupted is taken up
/// by the next one. Meshes that cannot be described are reported and stay out; when there is nothing but
/// those, no index is written.
///
/// # Errors
/// [`PipelineError::NoShapes`], [`PipelineError::Index`] and others that concern the whole run.
pub fn build_index(
    folder: &Path,
    path: &Path,
    options: &BuildOptions<'_>,
    observer: &dyn Observer,
) -> Result<BuildReport, PipelineError> {
    let start = Instant::now();
    options.describe.validate()?;
    let mut files = list_shapes(folder, options.labels)?;
    name_apart(&mut files);
    let files = share(files, options.shard);
    let text = options_text(options.describe);
    // What cannot work is refused before anything is read.
    if path.exists() {
        Index::open(path)?.expect_options(&text)?;
    }
    let hashed = hash_all(files, observer);
    let mut report = BuildReport::default();
    if !work_path(path).exists() && path.exists() && is_current(&Index::open(path)?, &hashed)? {
        (report.n_shapes, report.unchanged) = (hashed.len(), hashed.len());
        report.seconds = start.elapsed().as_secs_f64();
        return Ok(report);
    }
    let mut writer = IndexWriter::open(path, Job::Build, Some(&text))?;
    report.resumed = writer.is_resumed();
    let kept = fill(&mut writer, hashed, options.describe, &mut report, observer)?;
    let gone: Vec<String> = writer.ids()?.into_iter().filter(|id| !kept.contains(id)).collect();
    report.removed = gone.len();
    writer.remove(&gone)?;
    let nothing_new = report.described + report.renamed + report.removed == 0 && !report.resumed;
    if nothing_new && path.exists() || writer.is_empty()? && !report.failed.is_empty() {
        report.n_shapes = writer.len()?;
        writer.discard()?;
    } else {
        observer.begin("finishing", 1);
        report.n_shapes = writer.finish()?.len();
        observer.step();
    }
    report.seconds = start.elapsed().as_secs_f64();
    Ok(report)
}

/// Whether an index is what these files would make it.
fn is_current(index: &Index, files: &[Hashed]) -> Result<bool, IndexError> {
    if index.len() != files.len() {
        return Ok(false);
    }
    for (file, hash) in files {
        let Ok(hash) = hash else { return Ok(false) };
        if !index.contains(&file.name)? {
            return Ok(false);
        }
        let entry = index.entry(&file.name)?;
        if entry.content != *hash || !same_source(&entry, file) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Puts all files into the index that are not there as they are; the names of those that are there now.
pub(super) fn fill(
    writer: &mut IndexWriter,
    files: Vec<Hashed>,
    options: &DescribeOptions,
    report: &mut BuildReport,
    observer: &dyn Observer,
) -> Result<HashSet<String>, PipelineError> {
    let mut kept = HashSet::new();
    let mut renamed: Vec<(String, ShapeEntry)> = Vec::new();
    let mut wanted = Vec::new();
    for (file, hash) in files {
        let content = match hash {
            Ok(content) => content,
            Err(fault) => {
                report.fail(&file, &fault);
                continue;
            }
        };
        match writer.entry(&file.name)? {
            Some(entry) if entry.content == content => {
                kept.insert(file.name.clone());
                report.unchanged += 1;
                if !same_source(&entry, &file) {
                    let entry = ShapeEntry { label: file.label, path: path_text(&file.path), ..entry };
                    renamed.push((file.name, entry));
                }
            }
            _ => wanted.push((file, content)),
        }
    }
    report.renamed = renamed.len();
    if !renamed.is_empty() {
        writer.set_entries(&renamed)?;
    }
    observer.begin("describing", wanted.len());
    let (send, receive) = sync_channel(WAITING);
    let described = std::thread::scope(|scope| {
        scope.spawn(|| {
            // Nobody receives any more: the writer has failed, and there is no use in going on.
            let _ =
                wanted.par_iter().enumerate().try_for_each_with(send, |send, (place, (file, content))| {
                    let described = Surface::read(&file.path, &options.repair)
                        .and_then(|surface| describe_surface(&surface, options))
                        .map(|described| shape(file, *content, described));
                    send.send((place, described)).map_err(drop)
                });
        });
        store(writer, receive, observer)
    })?;
    report.described = described.stored.len();
    kept.extend(described.stored);
    let mut failed = described.failed;
    failed.sort_by_key(|(place, _)| *place);
    failed.iter().for_each(|(place, fault)| report.fail(&wanted[*place].0, fault));
    Ok(kept)
}

/// What came out of describing.
#[derive(Default)]
struct Described {
    stored: Vec<String>,
    failed: Vec<(usize, PipelineError)>,
}

/// Puts shapes on the disk as they come, all that are waiting at once.
fn store(
    writer: &mut IndexWriter,
    receive: Receiver<(usize, Result<Shape, PipelineError>)>,
    observer: &dyn Observer,
) -> Result<Described, PipelineError> {
    let mut described = Described::default();
    while let Ok(first) = receive.recv() {
        let mut shapes = Vec::new();
        let mut n_failed = 0;
        for (place, result) in std::iter::once(first).chain(receive.try_iter().take(BATCH - 1)) {
            match result {
                Ok(shape) => shapes.push(shape),
                Err(fault) => {
                    n_failed += 1;
                    described.failed.push((place, fault));
                }
            }
        }
        if !shapes.is_empty() {
            writer.put(&shapes)?;
        }
        (0..shapes.len() + n_failed).for_each(|_| observer.step());
        described.stored.extend(shapes.into_iter().map(|shape| shape.id));
    }
    Ok(described)
}
