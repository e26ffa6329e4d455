//! What an index says of its shapes.

use std::fmt::Display;
use std::path::Path;

use index::{Entry, Index, IndexError};

use super::source::Listed;
use crate::error::Error;
use crate::form::DescribeOptions;

/// How the shapes of an index were described.
pub(super) fn options_of(index: &Index) -> Result<DescribeOptions, Error> {
    let options = DescribeOptions::from_text(&index.options)
        .ok_or_else(|| Error::UnknownOptions { path: index.path.clone(), options: index.options.clone() })?;
    options.validate()?;
    Ok(options)
}

/// Whether an entry has the class and the path of a file.
pub(super) fn same_source(entry: &Entry, listed: &Listed) -> bool {
    entry.label == listed.file.label && entry.path == listed.stored
}

/// The error that a shape of an index lacks something.
pub(super) fn missing(path: &Path, id: &str, what: impl Display) -> IndexError {
    IndexError::Damaged { path: path.to_owned(), what: format!("`{id}` has no {what}") }
}
