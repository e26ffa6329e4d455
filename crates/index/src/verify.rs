//! Integrity check of a whole index.

use std::path::Path;

use crate::{Index, IndexError, Shape};

/// The result of [`verify`].
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// Number of shapes read.
    pub n_shapes: usize,
    /// Number of bytes read.
    pub n_bytes: u64,
    /// The defects found; empty if the index is intact.
    pub faults: Vec<String>,
}

/// Most defects of the structure that are named.
const MAX_FAULTS: usize = 20;

/// Checks the structure of the database, and every value of every shape.
///
/// # Errors
/// As [`Index::open`], if the file is not an index.
pub fn verify(path: &Path) -> Result<Verification, IndexError> {
    let index = match Index::open(path) {
        Err(IndexError::Damaged { what, .. }) => {
            return Ok(Verification { n_shapes: 0, n_bytes: 0, faults: vec![what] });
        }
        opened => opened?,
    };
    let mut found = Verification { n_shapes: 0, n_bytes: index.n_bytes(), faults: Vec::new() };
    match check(&index, &mut found.n_shapes) {
        Ok(faults) => found.faults = faults,
        Err(IndexError::Damaged { what, .. }) => found.faults.push(what),
        Err(fault) => return Err(fault),
    }
    Ok(found)
}

/// The defects of the structure; the first of values is an error.
fn check(index: &Index, n_shapes: &mut usize) -> Result<Vec<String>, IndexError> {
    let sql = format!("PRAGMA integrity_check({MAX_FAULTS})");
    let faults: Vec<String> = index.database().all(&sql, [], |row| row.get(0))?;
    if faults != ["ok"] {
        return Ok(faults);
    }
    index.each(|_: Shape| {
        *n_shapes += 1;
        Ok::<(), IndexError>(())
    })?;
    if *n_shapes != index.len() {
        return Err(index.damaged(format!("it holds {n_shapes} shapes, and states {}", index.len())));
    }
    // Every row belongs to a shape.
    for table in ["fused", "vectors", "components"] {
        let sql = format!("SELECT id FROM {table} WHERE id NOT IN (SELECT id FROM shapes) LIMIT 1");
        if let Some(id) = index.database().all(&sql, [], |row| row.get::<_, String>(0))?.pop() {
            return Err(index.damaged(format!("there are vectors of `{id}`, but no entry")));
        }
    }
    Ok(Vec::new())
}
