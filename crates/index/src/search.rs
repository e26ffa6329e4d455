//! Search for the nearest vectors.

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
