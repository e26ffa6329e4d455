//! Changing an index, and joining several.

use std::path::{Path, PathBuf};
use std::time::Instant;

use index::{Index, IndexError, IndexWriter, Job, Shape};
use serde::Serialize;

use super::build::{BuildReport, fill};
use super::record::options_of;
use super::source::{Inputs, hash_all};
use crate::{Observer, PipelineError};

/// Shapes copied together.
const BATCH: usize = 256;

/// Adds meshes to an index, described as those that are there. Those of the same name and content are left as
/// they are; an interrupted run is taken up by the next one.
///
/// # Errors
/// [`PipelineError::AlreadyThere`] for another shape of the same name unless `replace`; nothing is added then.
/// [`PipelineError::Index`], [`PipelineError::NoShapes`].
pub fn add_to_index(
    path: &Path,
    inputs: &Inputs<'_>,
    replace: bool,
    observer: &dyn Observer,
) -> Result<BuildReport, PipelineError> {
    let start = Instant::now();
    let index = Index::open(path)?;
    let options = options_of(&index)?;
    let hashed = hash_all(inputs.list()?, observer);
    if !replace {
        for (file, hash) in &hashed {
            let Ok(hash) = hash else { continue };
            if index.contains(&file.name)? {
                let entry = index.entry(&file.name)?;
                if entry.content != *hash {
                    return Err(PipelineError::AlreadyThere {
                        id: file.name.clone(),
                        path: entry.path.into(),
                    });
                }
            }
        }
    }
    let before = index.len();
    let mut writer = IndexWriter::open(path, Job::Add, None)?;
    let mut report = BuildReport { resumed: writer.is_resumed(), ..Default::default() };
    fill(&mut writer, hashed, &options, &mut report, observer)?;
    report.n_shapes = before;
    if report.described + report.renamed == 0 && !report.resumed {
        writer.discard()?;
    } else {
        report.n_shapes = writer.finish()?.len();
    }
    report.seconds = start.elapsed().as_secs_f64();
    Ok(report)
}

/// Takes shapes out of an index by name; the number of those that are left.
///
/// # Errors
/// [`PipelineError::Index`] when one of them is not there: then all stay.
pub fn remove_from_index(path: &Path, ids: &[String]) -> Result<usize, PipelineError> {
    let index = Index::open(path)?;
    for id in ids {
        if !index.contains(id)? {
            return Err(IndexError::NoSuchShape { path: path.to_owned(), id: id.clone() }.into());
        }
    }
    let mut unique = ids.to_vec();
    unique.sort();
    unique.dedup();
    let mut writer = IndexWriter::open(path, Job::Remove, None)?;
    writer.remove(&unique)?;
    Ok(writer.finish()?.len())
}

/// What became of indexes that were joined.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MergeReport {
    /// Shapes of the result.
    pub n_shapes: usize,
    /// Shapes that were in more than one.
    pub repeated: usize,
}

/// Writes the shapes of several indexes into one, over what was there. A shape that several have with the same
/// content is taken from the first of them.
///
/// # Errors
/// [`PipelineError::Index`] when they describe shapes in different ways, or give one name to different shapes.
pub fn merge_indexes(
    inputs: &[PathBuf],
    path: &Path,
    observer: &dyn Observer,
) -> Result<MergeReport, PipelineError> {
    let indexes = inputs.iter().map(|input| Index::open(input)).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = indexes.first() else { return Ok(MergeReport { n_shapes: 0, repeated: 0 }) };
    for index in &indexes {
        index.expect_options(first.options())?;
    }
    let mut writer = IndexWriter::open(path, Job::Merge, Some(first.options()))?;
    let mut repeated = 0;
    observer.begin("merging", indexes.iter().map(Index::len).sum());
    for index in &indexes {
        let mut batch: Vec<Shape> = Vec::new();
        index.each(|shape| {
            observer.step();
            match writer.entry(&shape.id)? {
                None => batch.push(shape),
                Some(entry) if entry.content == shape.entry.content => repeated += 1,
                Some(_) => return Err(IndexError::Conflict { id: shape.id, path: index.path().to_owned() }),
            }
            if batch.len() >= BATCH {
                writer.put(&std::mem::take(&mut batch))?;
            }
            Ok(())
        })?;
        writer.put(&batch)?;
    }
    Ok(MergeReport { n_shapes: writer.finish()?.len(), repeated })
}
