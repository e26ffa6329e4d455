//! Building the index of a folder.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Instant;

use base::{Budget, ContentHash, Exceeded};
use index::{Entry, Index, IndexError, IndexWriter, Shape};
use mesh::{Fault, MeshError};
use serde::{Serialize, Serializer};

use super::agreement::finish;
use super::components::other_components;
use super::place::{Home, Root, mesh_path};
use super::record::same_source;
use super::source::{
    Hashed, Listed, Listing, ShapeLimits, Shard, full_extension, hash_all, name_below, share,
};
use crate::error::{Error, Remedy};
use crate::form::{DescribeOptions, describe};
use crate::side_by_side::side_by_side;
use base::Observer;
use collection::{
    LabelOrigin, LabelSource, ShapeFile, SkipKind, Skipped, UnusedLabel, count_skipped, n_classes,
};
use mesh::Surface;

/// What an index states whose classes came from a file.
const FILE: &str = "file";

/// The note of an index on where its classes come from.
const LABELS: &str = "labels";

/// Most shapes written to disk in one transaction.
const BATCH: usize = 64;

/// Most described shapes that wait to be written.
const WAITING: usize = 64;

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

/// A mesh that could not be described.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failure {
    /// Name of the shape.
    pub id: String,
    /// Path of the mesh.
    pub path: PathBuf,
    /// Why it failed.
    pub reason: FailureReason,
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

/// Why a mesh could not be described.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum FailureReason {
    /// The file cannot be read, or holds no mesh.
    Unreadable,
    /// The mesh has more vertices or faces than allowed.
    TooLarge,
    /// It took longer than allowed.
    Time,
    /// It needs more memory than allowed.
    Memory,
    /// The mesh has no description.
    Shape,
}

impl FailureReason {
    fn new(fault: &Error) -> Self {
        match fault {
            Error::Exceeded(Exceeded::Time { .. }) => Self::Time,
            Error::Exceeded(Exceeded::Memory { .. }) => Self::Memory,
            Error::Mesh(MeshError::File { fault: Fault::OverLimit { .. }, .. }) => Self::TooLarge,
            Error::Mesh(MeshError::Io(_) | MeshError::File { .. } | MeshError::UnknownFormat { .. })
            | Error::File(_) => Self::Unreadable,
            _ => Self::Shape,
        }
    }
}

/// The outcome of building or extending an index.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct BuildReport {
    /// Shapes in the index now.
    pub n_shapes: usize,
    /// Shapes that were described.
    pub described: usize,
    /// Those of them whose files have the bytes of another file, and so its description.
    pub copies: usize,
    /// Shapes with unchanged content, from the index or from an interrupted run.
    pub unchanged: usize,
    /// Shapes whose path or class changed.
    pub renamed: usize,
    /// Shapes removed because their files are gone from the folder or cannot be described any more.
    pub removed: usize,
    /// Shapes kept although their files cannot be read now: the file, its folder, or a link to it.
    pub unreadable: Vec<String>,
    /// Shapes kept although they did not come from the folder; [`prune`](BuildOptions::prune) removes them.
    pub elsewhere: usize,
    /// Shapes removed by [`prune`](BuildOptions::prune).
    pub pruned: usize,
    /// Shapes of this run without a class.
    pub unlabelled: usize,
    /// The class that nearly all shapes would have got from the letters that their names begin with. It says nothing, so
    /// they have none.
    pub single_class: Option<String>,
    /// What the classes were taken from; `None` for meshes that were added.
    pub labels_from: Option<LabelOrigin>,
    /// Classes of the shapes of this run.
    pub n_classes: usize,
    /// Lines of the label file that name none of the shapes.
    pub unused_labels: usize,
    /// These lines.
    pub unused_label_lines: Vec<UnusedLabel>,
    /// What was found beside meshes: the number of each kind.
    pub skipped: BTreeMap<String, usize>,
    /// What was skipped although its name is that of a mesh or a folder.
    #[serde(serialize_with = "as_text")]
    pub skipped_paths: Vec<Skipped>,
    /// Whether an index was replaced that is damaged or of a past version; `NAME.damaged` keeps it.
    pub replaced_damaged: bool,
    /// Whether an interrupted run was resumed.
    pub resumed: bool,
    /// Meshes that could not be described, in order.
    pub failed: Vec<Failure>,
    /// Shapes among the inputs whose repair dropped a part of the surface, new and unchanged ones, by name.
    pub dropped: Vec<Dropped>,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// JSON has no names that are not UTF-8.
fn as_text<S: Serializer>(skipped: &[Skipped], out: S) -> Result<S::Ok, S::Error> {
    out.collect_seq(skipped.iter().map(|it| it.path.to_string_lossy()))
}

impl BuildReport {
    /// The report on a listing before anything is described.
    pub(super) fn new(listing: &Listing) -> Self {
        let unexpected = listing.skipped.iter().filter(|skipped| !skipped.kind.is_expected());
        Self {
            unlabelled: listing.shapes.iter().filter(|listed| listed.file.label.is_empty()).count(),
            single_class: listing.single_class.clone(),
            labels_from: listing.labelled_by,
            n_classes: n_classes(listing.shapes.iter().map(|listed| &listed.file)),
            unused_labels: listing.unused_labels.len(),
            unused_label_lines: listing.unused_labels.clone(),
            skipped: count_skipped(&listing.skipped),
            skipped_paths: unexpected.cloned().collect(),
            ..Self::default()
        }
    }

    fn fail(&mut self, listed: &Listed, fault: &Error) {
        let (id, path) = (listed.file.name.clone(), listed.file.path.clone());
        let (reason, error) = (FailureReason::new(fault), fault.to_string());
        self.failed.push(Failure { id, path, reason, error, remedy: fault.remedy() });
    }

    /// Notes a shape of the index at `path` if its repair dropped a part of the surface.
    fn note_dropped(&mut self, path: &Path, entry: &Entry) {
        let dropped_area_share = entry.facts.dropped_area_share;
        if dropped_area_share > 0.0 {
            let path = mesh_path(path, &entry.path);
            self.dropped.push(Dropped { id: entry.id.clone(), path, dropped_area_share });
        }
    }

    /// Completes the report if an index holds just these files, and nothing that has to be removed. Returns whether it does.
    fn is_current(
        &mut self,
        index: &Index,
        files: &[Hashed],
        missing: &Missing<'_>,
    ) -> Result<bool, IndexError> {
        let entries = index.entries()?.into_iter().map(|entry| (entry.id.clone(), entry));
        let mut others: HashMap<String, Entry> = entries.collect();
        let mut found = Self::default();
        for (listed, hash) in files {
            match (others.remove(&listed.file.name), hash) {
                (Some(entry), Ok(hash)) if entry.content == *hash && same_source(&entry, listed) => {
                    found.note_dropped(&index.path, &entry);
                }
                _ => return Ok(false),
            }
        }
        for entry in others.into_values() {
            if !missing.stays(&entry, &mut found) {
                return Ok(false);
            }
        }
        let BuildReport { mut dropped, mut unreadable, elsewhere, .. } = found;
        dropped.sort_by(|a, b| a.id.cmp(&b.id));
        unreadable.sort();
        (self.n_shapes, self.unchanged) = (index.len(), files.len());
        (self.dropped, self.unreadable, self.elsewhere) = (dropped, unreadable, elsewhere);
        Ok(true)
    }
}

/// Decides what becomes of shapes of an index whose files were not found.
struct Missing<'a> {
    root: &'a Root<'a>,
    prune: bool,
    /// Paths, as the index states them, at and below which nothing can be read now.
    unreadable: Vec<String>,
    /// Names of files that were found and cannot be read.
    unread: HashSet<String>,
}

impl<'a> Missing<'a> {
    fn new(root: &'a Root<'a>, prune: bool, skipped: &[Skipped]) -> Self {
        let is_unreadable =
            |skipped: &&Skipped| matches!(skipped.kind, SkipKind::Unreadable | SkipKind::BrokenLink);
        let unreadable = skipped.iter().filter(is_unreadable).map(|skipped| root.text(&skipped.path));
        Self { root, prune, unreadable: unreadable.collect(), unread: HashSet::new() }
    }

    /// Whether a shape stays; counts what becomes of it. A file that cannot be read is not gone.
    fn stays(&self, entry: &Entry, report: &mut BuildReport) -> bool {
        let is_below = |place: &String| Path::new(&entry.path).starts_with(place);
        if self.unread.contains(&entry.id) || self.unreadable.iter().any(is_below) {
            report.unreadable.push(entry.id.clone());
            return true;
        }
        let (count, stays) = match (self.root.contains_source(&entry.id, &entry.path), self.prune) {
            (true, _) => (&mut report.removed, false),
            (false, true) => (&mut report.pruned, false),
            (false, false) => (&mut report.elsewhere, true),
        };
        *count += 1;
        stays
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

/// Puts new and changed files into the index. Returns the names of all files that are in it afterwards.
pub(super) fn fill(
    writer: &mut IndexWriter,
    files: Vec<Hashed>,
    options: &DescribeOptions,
    limits: ShapeLimits,
    report: &mut BuildReport,
    observer: &dyn Observer,
) -> Result<HashSet<String>, Error> {
    let mut kept = HashSet::new();
    let mut renamed: Vec<Entry> = Vec::new();
    let mut wanted = Vec::new();
    let known: HashMap<_, String> = writer
        .entries()?
        .into_iter()
        .map(|entry| (described_from(&entry.content, Path::new(&entry.path)), entry.id))
        .collect();
    for (listed, hash) in files {
        let content = match hash {
            Ok(content) => content,
            Err(fault) => {
                report.fail(&listed, &fault);
                continue;
            }
        };
        match writer.entry(&listed.file.name)? {
            Some(known) if known.content == content => {
                let is_renamed = !same_source(&known, &listed);
                let entry = entry_of(&listed, known);
                report.unchanged += 1;
                report.note_dropped(writer.path(), &entry);
                kept.insert(entry.id.clone());
                if is_renamed {
                    renamed.push(entry);
                }
            }
            _ => wanted.push((listed, content)),
        }
    }
    report.renamed = renamed.len();
    if !renamed.is_empty() {
        writer.set_entries(&renamed)?;
    }
    let mut equal: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (place, (listed, content)) in wanted.iter().enumerate() {
        equal.entry(described_from(content, &listed.file.path)).or_default().push(place);
    }
    observer.begin("describing", wanted.len());
    // A file that was moved or copied is described already.
    let mut copied = Vec::new();
    for (key, places) in &mut equal {
        let Some(shape) = known.get(key).map(|id| writer.shape(id)).transpose()? else { continue };
        // Another file may just have taken its name.
        if shape.entry.content != key.0 {
            continue;
        }
        for place in places.drain(..) {
            let entry = entry_of(&wanted[place].0, shape.entry.clone());
            copied.push(entry.clone());
            writer.put(&[Shape { entry, ..shape.clone() }])?;
        }
    }
    if !copied.is_empty() {
        writer.commit()?;
        copied.iter().for_each(|_| observer.step());
    }
    let mut equal: Vec<Vec<usize>> = equal.into_values().filter(|places| !places.is_empty()).collect();
    equal.sort();
    let copies = AtomicUsize::new(copied.len());
    let whole = observer.budget();
    let (stored, mut failed) = std::thread::scope(|scope| {
        let (send, receive) = sync_channel(WAITING);
        let stored = scope.spawn(|| store(writer, receive, observer));
        // Sending fails only if the writer has failed, and then nothing more is described.
        drop(side_by_side(equal, |places| {
            let mut known: Option<Shape> = None;
            places.iter().try_for_each(|&place| {
                let (listed, content) = &wanted[place];
                let described = match &known {
                    Some(shape) => Ok(shape.clone()),
                    None => describe_file(&listed.file.path, options, limits, whole.clone()),
                };
                let described = described.map(|shape: Shape| {
                    let entry = Entry { content: *content, ..shape.entry };
                    Shape { entry: entry_of(listed, entry), ..shape }
                });
                match (&described, &known) {
                    (Ok(_), Some(_)) => drop(copies.fetch_add(1, Ordering::Relaxed)),
                    (Ok(shape), None) if places.len() > 1 => known = Some(shape.clone()),
                    _ => {}
                }
                send.send((place, described)).map_err(drop)
            })
        }));
        drop(send);
        stored.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })?;
    (report.described, report.copies) = (stored.len() + copied.len(), copies.into_inner());
    for entry in stored.into_iter().chain(copied) {
        report.note_dropped(writer.path(), &entry);
        kept.insert(entry.id);
    }
    report.dropped.sort_by(|a, b| a.id.cmp(&b.id));
    failed.sort_by_key(|(place, _)| *place);
    failed.iter().for_each(|(place, fault)| report.fail(&wanted[*place].0, fault));
    Ok(kept)
}

/// What a description is made from: bytes, and the extension, which decides how they are read.
fn described_from(content: &ContentHash, path: &Path) -> (ContentHash, Option<String>) {
    (*content, full_extension(path))
}

/// What is known of a shape as that of a file.
fn entry_of(listed: &Listed, known: Entry) -> Entry {
    let Listed { file, stored, .. } = listed;
    Entry { id: file.name.clone(), label: file.label.clone(), path: stored.clone(), ..known }
}

/// Describes a mesh within limits.
fn describe_file(
    path: &Path,
    options: &DescribeOptions,
    limits: ShapeLimits,
    whole: Budget,
) -> Result<Shape, Error> {
    let budget = limits.budget(whole);
    let mesh = limits.read(path, &budget)?;
    budget.check()?;
    let surface = Surface::new(&mesh, &options.form.repair, &budget)?;
    let components = match surface.input.report.components {
        0 | 1 => Vec::new(),
        _ => other_components(&mesh, options, &budget)?,
    };
    drop(mesh);
    Ok(Shape { components, ..describe(&surface, options, &budget)? })
}

/// Shapes that were described, and meshes that failed, by their places.
type Outcome = (Vec<Entry>, Vec<(usize, Error)>);

/// Writes shapes as they arrive, all that are waiting in one transaction.
fn store(
    writer: &mut IndexWriter,
    receive: Receiver<(usize, Result<Shape, Error>)>,
    observer: &dyn Observer,
) -> Result<Outcome, Error> {
    let (mut stored, mut failed) = (Vec::new(), Vec::new());
    while let Ok(first) = receive.recv() {
        let (mut shapes, n_failed) = (Vec::new(), failed.len());
        for (place, result) in std::iter::once(first).chain(receive.try_iter().take(BATCH - 1)) {
            match result {
                Ok(shape) => shapes.push(shape),
                Err(fault) => failed.push((place, fault)),
            }
        }
        if !shapes.is_empty() {
            writer.put(&shapes)?;
            writer.commit()?;
        }
        (n_failed..failed.len() + shapes.len()).for_each(|_| observer.step());
        stored.extend(shapes.into_iter().map(|shape| shape.entry));
    }
    Ok((stored, failed))
}
