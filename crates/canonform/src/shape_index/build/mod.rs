//! Building the index of a folder.

mod fill;
mod missing;
mod report;

pub(super) use fill::fill;
pub use report::{BuildReport, Dropped, Failure, FailureReason};

use std::collections::HashSet;
use std::path::Path;
use std::time::Instant;

use base::Observer;
use collection::{LabelSource, ShapeFile};
use index::{Index, IndexError, IndexWriter};

use self::missing::Missing;
use super::agreement::finish;
use super::place::{Home, Root};
use super::source::{Listed, Listing, ShapeLimits, Shard, hash_all, name_below, share};
use crate::error::Error;
use crate::form::DescribeOptions;

/// What an index states whose classes came from a file.
const FILE: &str = "file";

/// The note of an index on where its classes come from.
const LABELS: &str = "labels";

/// How the index of a folder is built.
#[derive(Debug, Clone, Copy)]
pub struct BuildOptions<'a> {
    /// How shapes are described.
    pub describe: &'a DescribeOptions,
    /// Where classes come from. Default: the names of folders and files decide, as for a [`Dataset`](collection::Dataset).
    pub labels: Option<&'a LabelSource>,
    /// The part of the folder to index. Default: all of it.
    pub shard: Option<Shard>,
    /// The shapes to index, by name: part of them, as [`indexed_shapes`] names them. Default: all of them.
    pub only: Option<&'a HashSet<String>>,
    /// Whether shapes of the index that did not come from the folder are removed. Default: no.
    pub prune: bool,
    /// What describing each shape may use. Default: no limits.
    pub limits: ShapeLimits,
}

impl<'a> BuildOptions<'a> {
    /// The defaults.
    pub fn new(describe: &'a DescribeOptions) -> Self {
        Self { describe, labels: None, shard: None, only: None, prune: false, limits: ShapeLimits::default() }
    }
}

/// Makes `path` the index of the meshes in `folder`: describes new and changed meshes, removes shapes of the folder whose
/// files are gone, and keeps the rest: also those whose files or folders cannot be read now. Shapes that were added from
/// elsewhere stay, unless the options say otherwise. Files of the same bytes are described once.
///
/// Every described shape is on disk before `observer` counts it, and the next run resumes an interrupted one; until then
/// the index says that it is [not finished](Index::is_finished).
/// Meshes that cannot be described are reported and left out; if there are no others, no index is written, except for a
/// shard.
///
/// ```
/// use canonform::{DescribeOptions, mesh};
/// use canonform::library::{BuildOptions, build_index};
///
/// let folder = tempfile::tempdir()?;
/// mesh::io::write(&folder.path().join("ball1.off"), &mesh::shapes::icosphere(2))?;
/// mesh::io::write(&folder.path().join("ring1.off"), &mesh::shapes::torus(24, 12, 2.0, 0.7))?;
/// let index = folder.path().join("shapes.canonform");
/// let describe = DescribeOptions::default();
/// let report = build_index(folder.path(), &index, &BuildOptions::new(&describe), &())?;
/// assert_eq!((report.n_shapes, report.failed.len()), (2, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::Collection`], [`Error::Index`], and those of [invalid options](DescribeOptions::validate).
pub fn build_index(
    folder: &Path,
    path: &Path,
    options: &BuildOptions<'_>,
    observer: &dyn Observer,
) -> Result<BuildReport, Error> {
    let start = Instant::now();
    let home = Home::new(path)?;
    let root = Root::new(folder, &home)?;
    let (existing, listing) = index_and_listing(&root, path, options)?;
    let mut report = BuildReport::new(&listing);
    let mut hashed = hash_all(listing.shapes, observer);
    let mut missing = Missing::new(&root, options.prune, &listing.skipped);
    if let Some(index) = &existing {
        name_below(&root, &mut hashed, (path, &index.entries()?))?;
    }
    if let Some(index) = existing
        && report.is_current(&index, &hashed, &missing)?
    {
        report.seconds = start.elapsed().as_secs_f64();
        return Ok(report);
    }
    let text = options.describe.text();
    let mut writer = IndexWriter::build(path, &text)?;
    if let Some(source) = options.labels {
        writer.set_note(LABELS, Some(source.word().as_deref().unwrap_or(FILE)))?;
    }
    report.resumed = writer.is_resumed;
    report.replaced_damaged = writer.replaced_damaged;
    let unread = hashed.iter().filter(|(_, hash)| hash.is_err());
    missing.unread = unread.map(|(listed, _)| listed.file.name.clone()).collect();
    let kept = fill(&mut writer, hashed, options.describe, options.limits, &mut report, observer)?;
    let mut gone = Vec::new();
    for entry in writer.entries()? {
        if !kept.contains(&entry.id) && !missing.stays(&entry, &mut report) {
            gone.push(entry.id);
        }
    }
    writer.remove(&gone)?;
    let nothing_new =
        report.described + report.renamed + gone.len() == 0 && !report.resumed && !report.replaced_damaged;
    report.n_shapes = writer.n_shapes();
    // A shard without shapes is complete, and `merge_indexes` takes it.
    let is_useless = options.shard.is_none() && report.n_shapes == 0 && !report.failed.is_empty();
    if nothing_new && !writer.is_new || is_useless {
        drop(writer);
    } else {
        finish(writer, options.describe, observer)?;
    }
    report.seconds = start.elapsed().as_secs_f64();
    Ok(report)
}

/// The report of a [`build_index`] that would have nothing to do; `None` if it would change the index, or make one.
///
/// # Errors
/// As for [`build_index`].
pub fn unchanged_index(
    folder: &Path,
    path: &Path,
    options: &BuildOptions<'_>,
    observer: &dyn Observer,
) -> Result<Option<BuildReport>, Error> {
    let (home, start) = (Home::new(path)?, Instant::now());
    let root = Root::new(folder, &home)?;
    let (Some(index), listing) = index_and_listing(&root, path, options)? else { return Ok(None) };
    // Without reading a mesh.
    let known: HashSet<[String; 2]> =
        index.entries()?.into_iter().map(|entry| [entry.path, entry.label]).collect();
    let is_known = |listed: &Listed| known.contains(&[listed.stored.clone(), listed.file.label.clone()]);
    if !listing.shapes.iter().all(is_known) {
        return Ok(None);
    }
    let mut report = BuildReport::new(&listing);
    let mut hashed = hash_all(listing.shapes, observer);
    let missing = Missing::new(&root, options.prune, &listing.skipped);
    name_below(&root, &mut hashed, (path, &index.entries()?))?;
    let is_current = report.is_current(&index, &hashed, &missing)?;
    report.seconds = start.elapsed().as_secs_f64();
    Ok(is_current.then_some(report))
}

/// The index at a path, unless it cannot be read or a run was interrupted, and the meshes that it should hold.
fn index_and_listing(
    root: &Root<'_>,
    path: &Path,
    options: &BuildOptions<'_>,
) -> Result<(Option<Index>, Listing), Error> {
    options.describe.validate()?;
    // Refuse other options before any mesh is read.
    let existing = match Index::open(path) {
        Ok(index) => index.expect_options(&options.describe.text()).map(|()| Some(index))?,
        // The writer takes care of an index that cannot be read.
        Err(IndexError::Damaged { .. } | IndexError::PastVersion { .. }) => None,
        Err(IndexError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => None,
        Err(fault) => return Err(fault.into()),
    };
    let given = match (&existing, options.labels) {
        (Some(index), None) => index.note(LABELS)?,
        _ => None,
    };
    let given = given.as_deref();
    let stated = given
        .map(|given| LabelSource::read(if given == FILE { "none" } else { given }.as_ref()))
        .transpose()?;
    let mut listing = Listing::from_folder(root, options.labels.or(stated.as_ref()))?;
    if let (Some(index), None) = (&existing, options.labels) {
        listing.keep_labels(&index.entries()?, given == Some(FILE));
    }
    listing.shapes = share(listing.shapes, options.shard);
    if let Some(only) = options.only {
        listing.shapes.retain(|listed| only.contains(&listed.file.name));
    }
    Ok((existing.filter(|index| index.is_finished), listing))
}

/// The shapes that [`build_index`] finds in a folder, with the names and classes that they get, without reading any mesh.
///
/// # Errors
/// [`Error::Collection`], [`Error::File`].
pub fn indexed_shapes(
    folder: &Path,
    path: &Path,
    labels: Option<&LabelSource>,
) -> Result<Vec<ShapeFile>, Error> {
    let home = Home::new(path)?;
    let listing = Listing::from_folder(&Root::new(folder, &home)?, labels)?;
    Ok(listing.shapes.into_iter().map(|listed| listed.file).collect())
}
