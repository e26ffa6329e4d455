//! Integrity check of a whole index.

use std::path::Path;

use crate::format::{BODIES, FUSED, Sealed, StoredCells, vectors};
use crate::vectors::padded;
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

/// Reads every byte, every shape and all search data of an index, and checks that they agree.
///
/// Calls `done` after each mebibyte.
///
/// # Errors
/// As [`Index::open`], if the file is not an index.
pub fn verify(path: &Path, done: impl FnMut()) -> Result<Verification, IndexError> {
    let sealed = Sealed::open(path)?;
    let mut found = Verification { n_shapes: 0, n_bytes: sealed.len(), faults: Vec::new() };
    if let Err(error) = sealed.check(done) {
        found.faults.push(error.to_string());
        return Ok(found);
    }
    let index = Index::open(path)?;
    let mut n_shapes = 0;
    let read = index.each(|_: Shape| {
        n_shapes += 1;
        Ok(())
    });
    let searched = check_cells(&index).and_then(|faults| match faults.is_empty() {
        true => Ok(()),
        false => Err(IndexError::damaged(path, faults.join("; "))),
    });
    for result in [read, check_entries(&index), searched] {
        found.faults.extend(result.err().map(|error| error.to_string()));
    }
    found.n_shapes = n_shapes;
    Ok(found)
}

/// Checks that all vectors belong to an entry.
fn check_entries(index: &Index) -> Result<(), IndexError> {
    let store = index.store();
    let snapshot = store.read()?;
    for table in [FUSED, BODIES] {
        for id in snapshot.keys(table)? {
            if snapshot.entry(&id)?.is_none() {
                return Err(IndexError::damaged(index.path(), format!("`{id}` has vectors but no entry")));
            }
        }
    }
    Ok(())
}

/// Compares the cells with the vectors that they were made from. Returns the differences.
fn check_cells(index: &Index) -> Result<Vec<String>, IndexError> {
    let store = index.store();
    let (names, rows, dim) = vectors(&store)?;
    let n = padded(dim);
    let stored = StoredCells::open(&store)?;
    let mut faults = Vec::new();
    let mut seen = vec![false; names.len()];
    for cell in 0..stored.header.sizes.len() as u32 {
        stored.each_part(cell, |part| {
            for (slot, row) in part.slots.iter().zip(part.rows().chunks_exact(n)) {
                let slot = *slot as usize;
                match seen.get_mut(slot) {
                    Some(seen) if !*seen && rows[slot * n..][..n] == *row => *seen = true,
                    _ => faults.push(format!("row {slot} of cell {cell} is not the vector of a shape")),
                }
            }
            Ok(())
        })?;
    }
    let unseen = seen.iter().zip(&names).filter(|(seen, _)| !**seen);
    faults.extend(unseen.map(|(_, id)| format!("`{id}` is in no cell")));
    let stored_names: Vec<String> = stored.names().collect::<Result<Vec<_>, _>>()?.concat();
    for (slot, id) in names.iter().enumerate() {
        if stored_names.get(slot) != Some(id) {
            faults.push(format!("row {slot} is not named `{id}`"));
        }
    }
    Ok(faults)
}
