//! Building the index of a folder.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Instant;

use index::{Index, IndexError, IndexWriter, Job, Shape, ShapeEntry, work_path};
use rayon::prelude::*;
use serde::Serialize;

use super::record::{DROPPED, path_text, same_source, shape};
use super::source::{Hashed, Shard, hash_all, name_apart, share};
use crate::error::{Error, Remedy};
use crate::form::{DescribeOptions, describe};
use crate::input::{LabelFile, ShapeFile, Surface, list_shapes};
use crate::observer::Observer;

/// Most shapes written to disk in one transaction.
const BATCH: usize = 64;

/// Most described shapes that wait to be written.
const WAITING: usize = 64;

/// How the index of a folder is built.
#[derive(Debug, Clone, Copy)]
pub struct BuildOptions<'a> {
    /// How shapes are described.
    pub describe: &'a DescribeOptions,
    /// Classes by name. Default: from the names of folders and files.
    pub labels: Option<&'a LabelFile>,
    /// The part of the folder to index. Default: all of it.
    pub shard: Option<Shard>,
}

/// A mesh that could not be described.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failure {
    /// Name of the shape.
    pub id: String,
    /// Path of the mesh.
    pub path: PathBuf,
    /// The error.
    pub error: String,
    /// What would help against it.
    #[serde(skip)]
    pub remedy: Option<Remedy>,
}

/// A shape that is indexed without a part of its surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dropped {
    /// Name of the shape.
    pub id: String,
    /// Path of the mesh.
    pub path: PathBuf,
    /// The share of the surface that the repair dropped, above 0.
    pub dropped_area_share: f64,
}

/// The outcome of building or extending an index.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct BuildReport {
    /// Shapes in the index now.
    pub n_shapes: usize,
    /// Shapes that were described.
    pub described: usize,
    /// Shapes with unchanged content, from the index or from an interrupted run.
    pub unchanged: usize,
    /// Shapes whose path or class changed.
    pub renamed: usize,
    /// Shapes removed because their files are gone or cannot be read any more.
    pub removed: usize,
    /// Whether an interrupted run was resumed.
    pub resumed: bool,
    /// Meshes that could not be described, in order.
    pub failed: Vec<Failure>,
    /// Shapes among the inputs whose repair dropped a part of the surface, new and unchanged ones, by name.
    pub dropped: Vec<Dropped>,
    /// Wall-clock seconds.
    pub seconds: f64,
}

impl BuildReport {
    fn fail(&mut self, file: &ShapeFile, fault: &Error) {
        let (id, path) = (file.name.clone(), file.path.clone());
        self.failed.push(Failure { id, path, error: fault.to_string(), remedy: fault.remedy() });
    }

    /// Lists the shapes in the index whose repair dropped a part of the surface.
    pub(super) fn list_dropped<'a>(
        &mut self,
        ids: impl Iterator<Item = &'a String>,
        entry: impl Fn(&str) -> Result<Option<ShapeEntry>, IndexError>,
    ) -> Result<(), IndexError> {
        for id in ids {
            let Some(entry) = entry(id)? else { continue };
            if let Some(dropped_area_share) = entry.fact(DROPPED).filter(|share| *share > 0.0) {
                self.dropped.push(Dropped { id: id.clone(), path: entry.path.into(), dropped_area_share });
            }
        }
        self.dropped.sort_by(|a, b| a.id.cmp(&b.id));
        Ok(())
    }
}

/// Makes `path` the index of the meshes in `folder`: describes new and changed meshes, removes shapes whose files
/// are gone, and keeps the rest.
///
/// Every described shape is on disk before `observer` counts it, and the next run resumes an interrupted one.
/// Meshes that cannot be described are reported and left out; if there are no others, no index is written.
///
/// ```
/// use canonform::{BuildOptions, DescribeOptions, build_index, mesh};
///
/// let folder = tempfile::tempdir()?;
/// mesh::io::write(&folder.path().join("ball1.off"), &mesh::shapes::icosphere(2))?;
/// mesh::io::write(&folder.path().join("ring1.off"), &mesh::shapes::torus(24, 12, 2.0, 0.7))?;
/// let index = folder.path().join("shapes.canonform");
/// let describe = DescribeOptions::default();
/// let options = BuildOptions { describe: &describe, labels: None, shard: None };
/// let report = build_index(folder.path(), &index, &options, &())?;
/// assert_eq!((report.n_shapes, report.failed.len()), (2, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::NoShapes`], [`Error::Index`], and those of [invalid options](DescribeOptions::validate).
pub fn build_index(
    folder: &Path,
    path: &Path,
    options: &BuildOptions<'_>,
    observer: &dyn Observer,
) -> Result<BuildReport, Error> {
    let start = Instant::now();
    options.describe.validate()?;
    let mut files = list_shapes(folder, options.labels)?;
    name_apart(&mut files);
    let files = share(files, options.shard);
    let text = options.describe.text();
    // Refuse other options before any mesh is read.
    if path.exists() {
        Index::open(path)?.expect_options(&text)?;
    }
    let hashed = hash_all(files, observer);
    let mut report = BuildReport::default();
    if !work_path(path).exists() && path.exists() && is_current(&Index::open(path)?, &hashed)? {
        let index = Index::open(path)?;
        report.list_dropped(hashed.iter().map(|(file, _)| &file.name), |id| index.entry(id).map(Some))?;
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

/// Whether an index already holds exactly these files.
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

/// Puts new and changed files into the index. Returns the names of all files that are in it afterwards.
pub(super) fn fill(
    writer: &mut IndexWriter,
    files: Vec<Hashed>,
    options: &DescribeOptions,
    report: &mut BuildReport,
    observer: &dyn Observer,
) -> Result<HashSet<String>, Error> {
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
            // Sending fails only if the writer has failed; the error stops the loop.
            let _ =
                wanted.par_iter().enumerate().try_for_each_with(send, |send, (place, (file, content))| {
                    let described = Surface::read(&file.path, &options.form.repair)
                        .and_then(|surface| describe(&surface, options))
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
    report.list_dropped(kept.iter(), |id| writer.entry(id))?;
    Ok(kept)
}

/// Shapes that were described, and meshes that failed.
#[derive(Default)]
struct Described {
    stored: Vec<String>,
    failed: Vec<(usize, Error)>,
}

/// Writes shapes as they arrive, all that are waiting in one transaction.
fn store(
    writer: &mut IndexWriter,
    receive: Receiver<(usize, Result<Shape, Error>)>,
    observer: &dyn Observer,
) -> Result<Described, Error> {
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
