//! Search for the nearest vectors.

use retrieval::UnknownThreshold;

use crate::reader::vectors;
use crate::vectors::threshold;
use crate::{Index, IndexError};

impl Index {
    /// The `k` shapes whose vectors are nearest to `query`, nearest first, and their Euclidean distances; ties by name. All
    /// vectors are measured.
    ///
    /// # Errors
    /// [`IndexError::OtherLength`], [`IndexError::BadVector`], [`IndexError::Io`], [`IndexError::Damaged`].
    pub fn nearest(&self, query: &[f32], k: usize) -> Result<Vec<(String, f64)>, IndexError> {
        let all = self.vector_table()?;
        let name = || "the query".to_owned();
        if !all.is_empty() && query.len() != all.dim() {
            return Err(IndexError::OtherLength { id: name(), found: query.len(), expected: all.dim() });
        }
        match query.iter().all(|x| x.is_finite()) {
            true => Ok(all
                .nearest(query, k)
                .into_iter()
                .map(|near| (all.id(near.index).to_owned(), near.distance))
                .collect()),
            false => Err(IndexError::BadVector(name())),
        }
    }
}

/// The [threshold](Index::threshold) of the index that would hold the shapes of all of these, which have different names
/// and were described with the same options. Holds the vectors of one index at a time in memory.
///
/// # Errors
/// [`IndexError::Io`], [`IndexError::Damaged`].
pub fn class_threshold(indexes: &[Index]) -> Result<Option<UnknownThreshold>, IndexError> {
    threshold(|visit| {
        indexes.iter().try_for_each(|index| {
            let classes: Vec<String> = index.entries()?.into_iter().map(|entry| entry.label).collect();
            let vectors = vectors(&index.database())?;
            index.expect_all(vectors.len())?;
            visit(&vectors, &classes);
            Ok(())
        })
    })
}
