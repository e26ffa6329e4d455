//! Search in the file.

use super::{Found, NearShape, SearchMode, distance, padded_query};
use crate::format::StoredCells;
use crate::vectors::{Hit, Nearest, nearest_cells, scan};
use crate::{Index, IndexError};

impl Index {
    /// The `k` shapes whose vectors are nearest to `query`. Reads the cells it needs from the file.
    ///
    /// # Errors
    /// [`IndexError::OtherLength`], [`IndexError::BadVector`], [`IndexError::Io`], [`IndexError::Damaged`].
    pub fn nearest(&self, query: &[f32], k: usize, mode: SearchMode) -> Result<Found, IndexError> {
        let store = self.store();
        let stored = StoredCells::open(&store)?;
        let row = padded_query(query, &stored.header)?;
        let (mut nearest, mut n_measured) = (Nearest::new(k), 0);
        for cell in nearest_cells(&row, &stored.centroids, mode.probes(&stored.header)) {
            stored.each_part(cell, |part| {
                n_measured += part.slots.len();
                scan(&row, &part.slots, part.rows(), &mut nearest);
                Ok(())
            })?;
        }
        let mut shapes = Vec::with_capacity(k.min(self.len()));
        for Hit { slot, .. } in nearest.into_sorted() {
            let id = stored.name(slot)?;
            shapes.push(NearShape { distance: distance(query, &stored.vector(&id)?), id });
        }
        Ok(Found::new(shapes, n_measured, &stored.header, mode))
    }
}
