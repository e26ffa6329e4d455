//! Bringing an index up to date with files: what it has stays, the rest is described.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;
use std::sync::mpsc::{Receiver, sync_channel};

use base::{Budget, ContentHash, Observer};
use index::{Entry, IndexWriter, Shape};
use mesh::Surface;

use super::report::BuildReport;
use crate::error::Error;
use crate::form::{DescribeOptions, describe};
use crate::shape_index::components::other_components;
use crate::shape_index::record::same_source;
use crate::shape_index::source::{Hashed, Listed, ShapeLimits, full_extension};
use crate::side_by_side::side_by_side;

/// Most shapes written to disk in one transaction.
const BATCH: usize = 64;

/// Most described shapes that wait to be written.
const WAITING: usize = 64;

/// What a description is made from: bytes, and the extension, which decides how they are read.
type Source = (ContentHash, Option<String>);

fn source(content: &ContentHash, path: &Path) -> Source {
    (*content, full_extension(path))
}

/// A file that is to be described.
type Wanted = (Listed, ContentHash);

/// Puts new and changed files into the index. Returns the names of all files that are in it afterwards.
pub(in crate::shape_index) fn fill(
    writer: &mut IndexWriter,
    files: Vec<Hashed>,
    options: &DescribeOptions,
    limits: ShapeLimits,
    report: &mut BuildReport,
    observer: &dyn Observer,
) -> Result<HashSet<String>, Error> {
    let known = writer.entries()?.into_iter();
    let known = known.map(|entry| (source(&entry.content, Path::new(&entry.path)), entry.id)).collect();
    let (mut kept, wanted) = without_unchanged(writer, files, report)?;
    let mut equal: BTreeMap<Source, Vec<usize>> = BTreeMap::new();
    for (place, (listed, content)) in wanted.iter().enumerate() {
        equal.entry(source(content, &listed.file.path)).or_default().push(place);
    }
    observer.begin("describing", wanted.len());
    let copied = copy_known(writer, &wanted, &known, &mut equal)?;
    copied.iter().for_each(|_| observer.step());
    let mut equal: Vec<Vec<usize>> = equal.into_values().collect();
    equal.sort();
    let budget = observer.budget();
    let (stored, mut failed, n_equal) = std::thread::scope(|scope| {
        let (send, receive) = sync_channel(WAITING);
        let stored = scope.spawn(|| store(writer, receive, observer));
        // Sending fails only if the writer has failed, and then nothing more is described.
        let n_equal = side_by_side(equal, |places| {
            let (mut known, mut n_equal, has_copies) = (None, 0, places.len() > 1);
            for place in places {
                let (listed, content) = &wanted[place];
                n_equal += usize::from(known.is_some());
                let described: Result<Shape, Error> = match known.take() {
                    Some(shape) => Ok(shape),
                    None => describe_file(&listed.file.path, options, limits, budget.clone()),
                };
                known = described.as_ref().ok().filter(|_| has_copies).cloned();
                let described = described.map(|shape| {
                    let entry = Entry { content: *content, ..shape.entry };
                    Shape { entry: entry_of(listed, entry), ..shape }
                });
                send.send((place, described)).map_err(drop)?;
            }
            Ok::<_, ()>(n_equal)
        });
        drop(send);
        let (stored, failed) = stored.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        Ok::<_, Error>((stored, failed, n_equal.into_iter().flatten().sum::<usize>()))
    })?;
    (report.described, report.copies) = (stored.len() + copied.len(), n_equal + copied.len());
    for entry in stored.into_iter().chain(copied) {
        report.note_dropped(writer.path(), &entry);
        kept.insert(entry.id);
    }
    report.dropped.sort_by(|a, b| a.id.cmp(&b.id));
    failed.sort_by_key(|(place, _)| *place);
    failed.iter().for_each(|(place, fault)| report.fail(&wanted[*place].0, fault));
    Ok(kept)
}

/// The names of files that the index has with the same bytes, whose paths and classes it learns, and the files that are to be described.
fn without_unchanged(
    writer: &mut IndexWriter,
    files: Vec<Hashed>,
    report: &mut BuildReport,
) -> Result<(HashSet<String>, Vec<Wanted>), Error> {
    let (mut kept, mut renamed, mut wanted) = (HashSet::new(), Vec::new(), Vec::new());
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
    Ok((kept, wanted))
}

/// Puts files that were moved or copied, and so are described already, into the index, and leaves the others in `equal`.
fn copy_known(
    writer: &mut IndexWriter,
    wanted: &[Wanted],
    known: &HashMap<Source, String>,
    equal: &mut BTreeMap<Source, Vec<usize>>,
) -> Result<Vec<Entry>, Error> {
    let mut copied = Vec::new();
    for (key, places) in &mut *equal {
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
    }
    equal.retain(|_, places| !places.is_empty());
    Ok(copied)
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
