//! Is all of an index what was written?

use std::path::Path;

use super::sealed::Sealed;
use super::tables::{BODIES, FUSED};
use super::{Index, IndexError, Shape, ShapeEntry};

/// What [`verify`] found.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// Shapes that were read.
    pub n_shapes: usize,
    /// Bytes of the file that were read.
    pub n_bytes: u64,
    /// What is wrong; nothing in a sound index.
    pub faults: Vec<String>,
}

/// Reads every byte of an index, every shape, and what is searched, and holds them against each other.
/// `done` is called after each mebibyte.
///
/// # Errors
/// Those of [`Index::open`] when it is no index at all.
pub fn verify(path: &Path, done: impl FnMut()) -> Result<Verification, IndexError> {
    let sealed = Sealed::open(path)?;
    let mut found = Verification { n_shapes: 0, n_bytes: sealed.len(), faults: Vec::new() };
    if let Err(fault) = sealed.check(done) {
        found.faults.push(fault.to_string());
        return Ok(found);
    }
    let index = Index::open(path)?;
    let mut tell = |result: Result<(), IndexError>| {
        if let Err(fault) = result {
            found.faults.push(fault.to_string());
        }
    };
    let mut n_shapes = 0;
    tell(index.each(|_: Shape| {
        n_shapes += 1;
        Ok(())
    }));
    let mut others = [0; 2];
    let store = index.store();
    let counted = store.read().and_then(|snapshot| {
        let known = |id: &str| match snapshot.entry(id)? {
            Some(ShapeEntry { .. }) => Ok(()),
            None => {
                Err(IndexError::Damaged { path: path.to_owned(), what: format!("`{id}` has vectors only") })
            }
        };
        for (table, count) in [FUSED, BODIES].into_iter().zip(&mut others) {
            for id in snapshot.keys(table)? {
                *count += 1;
                known(&id)?;
            }
        }
        Ok(())
    });
    tell(counted);
    tell(match crate::search::check(&index) {
        Ok(faults) if faults.is_empty() => Ok(()),
        Ok(faults) => Err(IndexError::Damaged { path: path.to_owned(), what: faults.join("; ") }),
        Err(fault) => Err(fault),
    });
    found.n_shapes = n_shapes;
    Ok(found)
}
