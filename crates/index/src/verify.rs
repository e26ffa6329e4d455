//! Integrity check of a whole index.

use std::path::Path;

use crate::derived::{classes, counted};
use crate::vectors::threshold;
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

/// Reads every byte, every shape and everything that follows from the shapes, and checks that they agree.
///
/// # Errors
/// As [`Index::open`], if the file is not an index.
pub fn verify(path: &Path) -> Result<Verification, IndexError> {
    let index = Index::open(path)?;
    let mut found = Verification { n_shapes: 0, n_bytes: index.n_bytes(), faults: Vec::new() };
    if let Err(error) = index.stored.check() {
        found.faults.push(error.to_string());
        return Ok(found);
    }
    found.faults.extend(check(&index, &mut found.n_shapes).err().map(|fault| fault.to_string()));
    Ok(found)
}

/// Reads all shapes, and checks what follows from them.
fn check(index: &Index, n_shapes: &mut usize) -> Result<(), IndexError> {
    index.each(|_: Shape| {
        *n_shapes += 1;
        Ok::<(), IndexError>(())
    })?;
    let (view, vectors) = (index.view(), index.vector_table()?);
    let classes = classes(view, vectors)?;
    if index.classes()? != counted(&classes) {
        return Err(view.damaged("its classes are counted wrong"));
    }
    let fresh = threshold(|visit| {
        visit(vectors, &classes);
        Ok::<_, IndexError>(())
    })?;
    // Other processors round in another way.
    let agree = match (index.threshold(), fresh) {
        (Some(a), Some(b)) => (a.distance - b.distance).abs() <= 1e-3 * b.distance,
        (a, b) => a.is_none() && b.is_none(),
    };
    match agree {
        true => Ok(()),
        false => Err(view.damaged("its threshold of unknown classes does not match its shapes")),
    }
}
