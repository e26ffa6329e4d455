//! Changing an index, and merging several.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use index::{Entry, Index, IndexError, IndexWriter, Shape};
use serde::Serialize;

use super::agreement::finish;
use super::build::{BuildReport, fill};
use super::place::{Home, mesh_path};
use super::record::options_of;
use super::source::{Inputs, hash_all, name_places};
use crate::error::Error;
use base::{ContentHash, Observer};

/// Adds meshes to an index, described with its options. Shapes with the same name and content are kept. The next
/// run resumes an interrupted one.
///
/// # Errors
/// [`Error::AlreadyThere`] if another shape has one of the names, unless `replace` is set; nothing is added then.
/// [`Error::Index`], [`Error::Collection`].
pub fn add_to_index(
    path: &Path,
    inputs: &Inputs<'_>,
    replace: bool,
    observer: &dyn Observer,
) -> Result<BuildReport, Error> {
    let start = Instant::now();
    let index = Index::open(path)?;
    let options = options_of(&index)?;
    let classes = index.classes()?;
    let listing = inputs.list(&Home::new(path)?, |label| classes.contains_key(label))?;
    let mut report = BuildReport::new(&listing);
    let mut hashed = hash_all(listing.shapes, observer);
    let entries = index.entries()?;
    name_places(
        &mut hashed,
        (path, &entries),
        |_, _| true,
        |listed, hash, entry| (listed.is_single || replace) && hash != Some(&entry.content),
    )?;
    if !replace {
        let hashes: HashMap<&str, &ContentHash> = hashed
            .iter()
            .filter_map(|(listed, hash)| Some((listed.file.name.as_str(), hash.as_ref().ok()?)))
            .collect();
        let is_another =
            |entry: &&Entry| hashes.get(entry.id.as_str()).is_some_and(|hash| **hash != entry.content);
        if let Some(Entry { id, path: stored, .. }) = entries.iter().find(is_another) {
            return Err(Error::AlreadyThere { id: id.clone(), path: mesh_path(path, stored) });
        }
    }
    drop(index);
    let mut writer = IndexWriter::open(path)?;
    report.resumed = writer.is_resumed;
    fill(&mut writer, hashed, &options, inputs.limits, &mut report, observer)?;
    report.n_shapes = writer.n_shapes();
    if report.described + report.renamed == 0 && !report.resumed {
        drop(writer);
    } else {
        finish(writer, &options, observer)?;
    }
    report.seconds = start.elapsed().as_secs_f64();
    Ok(report)
}

/// Removes shapes from an index by name. Returns how many are left.
///
/// # Errors
/// [`Error::Index`] if one of the names is unknown; nothing is removed then.
pub fn remove_from_index(path: &Path, ids: &[String]) -> Result<usize, Error> {
    let options = options_of(&Index::open(path)?)?;
    let mut writer = IndexWriter::open(path)?;
    writer.remove(ids)?;
    Ok(finish(writer, &options, &())?.len())
}

/// The outcome of a merge.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MergeReport {
    /// Shapes in the result.
    pub n_shapes: usize,
    /// Shapes that several indexes had.
    pub repeated: usize,
}

/// Merges indexes into the file `path`, which is replaced. A shape that several of them have with the same content
/// is taken from the first.
///
/// # Errors
/// [`Error::Index`] if their shapes were described with different options, or if different shapes have one name.
pub fn merge_indexes(inputs: &[PathBuf], path: &Path, observer: &dyn Observer) -> Result<MergeReport, Error> {
    let indexes = inputs.iter().map(|input| Index::open(input)).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = indexes.first() else { return Ok(MergeReport { n_shapes: 0, repeated: 0 }) };
    for index in &indexes {
        index.expect_options(&first.options)?;
    }
    let home = Home::new(path)?;
    let mut writer = IndexWriter::build(path, &first.options)?;
    writer.clear()?;
    let mut repeated = 0;
    observer.begin("merging", indexes.iter().map(Index::len).sum());
    for index in &indexes {
        index.each(|shape| {
            observer.step();
            match writer.entry(&shape.entry.id)? {
                None => {
                    let path = home.text_of(&index.path, &shape.entry.path);
                    writer.put(&[Shape { entry: Entry { path, ..shape.entry }, ..shape }])?;
                }
                Some(entry) if entry.content == shape.entry.content => repeated += 1,
                Some(entry) => {
                    return Err(IndexError::Conflict { id: entry.id, path: index.path.clone() });
                }
            }
            Ok(())
        })?;
    }
    Ok(MergeReport { n_shapes: finish(writer, &options_of(first)?, observer)?.len(), repeated })
}
