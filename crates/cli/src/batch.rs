//! One result for each of several meshes.

use std::collections::HashMap;
use std::convert::Infallible;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use base::files::is_input;
use base::terminal::Bars;
use canonform::collection::ShapeFile;
use canonform::side_by_side;
use serde::Serialize;

use crate::args::{Common, keep_inputs};
use crate::input::{expand, is_stream};
use crate::output::shown;

/// A mesh without a result.
#[derive(Serialize)]
pub(crate) struct Failure {
    /// Of a mesh that was to have a result of its name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    pub(crate) path: PathBuf,
    pub(crate) error: String,
}

impl Failure {
    /// Prints the error.
    pub(crate) fn new(path: PathBuf, fault: &anyhow::Error) -> Self {
        let error = crate::remedy::message(fault);
        base::terminal::error(&error);
        Self { name: None, path, error }
    }
}

/// What is written, and where.
pub(crate) struct Results<'a> {
    /// In words.
    pub(crate) what: &'a str,
    /// The meshes.
    pub(crate) arguments: &'a [PathBuf],
    pub(crate) folder: &'a Path,
    pub(crate) extension: &'a str,
    /// Whether meshes are worked on side by side, or each has all threads.
    pub(crate) in_parallel: bool,
}

/// A mesh and what was made of it.
type Made<T> = (ShapeFile, T);

impl Results<'_> {
    /// Makes `FOLDER/NAME.EXTENSION` of every mesh. Failures are printed at the end and do not stop the rest.
    ///
    /// # Errors
    /// Results that would overwrite each other or a mesh, before any work is done.
    pub(crate) fn make<T: Send>(
        &self,
        common: &Common,
        one: impl Fn(&ShapeFile, &Path) -> Result<T> + Sync,
    ) -> Result<(Vec<Made<T>>, Vec<Failure>)> {
        if is_stream(self.folder) {
            bail!("several {} cannot go to standard output; name a folder for them", self.what);
        }
        let shapes = expand(self.arguments)?;
        let outputs = self.outputs(&shapes)?;
        let bar = Bars::new(common.quiet).bar(self.what, shapes.len());
        let work = |(shape, output): (&ShapeFile, &PathBuf)| {
            let folder = output.parent().unwrap_or(self.folder);
            let result = std::fs::create_dir_all(folder)
                .with_context(|| format!("cannot create the folder {}", folder.display()))
                .and_then(|()| one(shape, output));
            bar.inc(1);
            result
        };
        let each = shapes.iter().zip(&outputs);
        let results: Vec<Result<T>> = match self.in_parallel {
            true => side_by_side(each.collect(), |one| Ok::<_, Infallible>(work(one)))?,
            false => each.map(work).collect(),
        };
        bar.finish_and_clear();
        let (mut done, mut failed) = (Vec::new(), Vec::new());
        for (shape, result) in shapes.into_iter().zip(results) {
            match result {
                Ok(result) => done.push((shape, result)),
                Err(fault) => {
                    let name = Some(shape.name);
                    failed.push(Failure { name, ..Failure::new(shape.path, &fault) });
                }
            }
        }
        Ok((done, failed))
    }

    /// How many there are.
    pub(crate) fn counts(&self, n_done: usize, failed: &[Failure]) -> String {
        format!("{n_done} {} in {}, {} failed", self.what, shown(self.folder), failed.len())
    }

    /// Where the result of each mesh goes.
    fn outputs(&self, shapes: &[ShapeFile]) -> Result<Vec<PathBuf>> {
        let Self { folder, extension, .. } = self;
        if folder.exists() && !folder.is_dir() {
            bail!("{} is a file; with several meshes, -o names a folder", folder.display());
        }
        shapes.iter().for_each(|shape| keep_inputs(&shape.path));
        let outputs: Vec<PathBuf> =
            shapes.iter().map(|shape| folder.join(format!("{}.{extension}", shape.name))).collect();
        let mut first = HashMap::new();
        for (shape, output) in shapes.iter().zip(&outputs) {
            if is_input(output) {
                let output = output.display();
                bail!("{output}: the result would overwrite a mesh; choose another folder with -o");
            }
            if let Some(other) = first.insert(output, &shape.path) {
                bail!(
                    "{} and {} would have the same result file; rename one of them",
                    other.display(),
                    shape.path.display()
                );
            }
        }
        Ok(outputs)
    }
}
