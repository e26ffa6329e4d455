//! Search in memory.

use rayon::prelude::*;

use super::{Found, NearShape, SearchMode, distance, padded_query};
use crate::format::StoredCells;
use crate::vectors::{CellsHeader, Centroids, Hit, Nearest, nearest_cells, padded, scan};
use crate::{Index, IndexError};

/// Rows in one parallel task.
const TASK: usize = 8192;

/// All vectors of an index in memory, for many searches; see the [example](crate) of this crate.
#[derive(Debug)]
pub struct Searcher {
    header: CellsHeader,
    centroids: Centroids,
    /// The start of each cell, and the end of the last one.
    starts: Vec<usize>,
    slots: Vec<u32>,
    rows: Vec<f32>,
    names: Names,
    /// The position of each slot in `rows`.
    positions: Vec<u32>,
}

/// Names, one after the other.
#[derive(Debug, Default)]
struct Names {
    text: String,
    ends: Vec<usize>,
}

impl Names {
    fn of(stored: &StoredCells<'_>) -> Result<Self, IndexError> {
        let mut names = Self::default();
        for part in stored.names() {
            for name in part? {
                names.text += &name;
                names.ends.push(names.text.len());
            }
        }
        names.text.shrink_to_fit();
        names.ends.shrink_to_fit();
        Ok(names)
    }

    fn len(&self) -> usize {
        self.ends.len()
    }

    fn get(&self, slot: u32) -> &str {
        let start = slot.checked_sub(1).map_or(0, |before| self.ends[before as usize]);
        &self.text[start..self.ends[slot as usize]]
    }
}

impl Searcher {
    /// Reads the vectors of an index: `4 d` bytes and the name of each shape.
    ///
    /// # Errors
    /// [`IndexError::Io`], [`IndexError::Damaged`].
    pub fn load(index: &Index) -> Result<Self, IndexError> {
        let store = index.store();
        let stored = StoredCells::open(&store)?;
        let n = padded(stored.header.dim);
        let mut slots = Vec::with_capacity(stored.header.n);
        let mut rows = Vec::with_capacity(stored.header.n * n);
        for cell in 0..stored.header.sizes.len() as u32 {
            stored.each_part(cell, |part| {
                slots.extend_from_slice(&part.slots);
                rows.extend_from_slice(part.rows());
                Ok(())
            })?;
        }
        let names = Names::of(&stored)?;
        let mut positions = vec![0; names.len()];
        for (position, slot) in slots.iter().enumerate() {
            if let Some(entry) = positions.get_mut(*slot as usize) {
                *entry = position as u32;
            }
        }
        let mut starts = vec![0];
        starts.extend(stored.header.sizes.iter().scan(0, |end, size| {
            *end += *size as usize;
            Some(*end)
        }));
        if slots.len() != names.len() || rows.len() != names.len() * n || starts.last() != Some(&slots.len())
        {
            return Err(IndexError::damaged(index.path(), "the parts of its search table disagree"));
        }
        let StoredCells { header, centroids, .. } = stored;
        Ok(Self { header, centroids, starts, slots, rows, names, positions })
    }

    /// The `k` shapes whose vectors are nearest to `query`.
    ///
    /// # Errors
    /// [`IndexError::OtherLength`], [`IndexError::BadVector`].
    pub fn nearest(&self, query: &[f32], k: usize, mode: SearchMode) -> Result<Found, IndexError> {
        let row = padded_query(query, &self.header)?;
        let n = row.len();
        let (nearest, n_measured) = if mode.probes(&self.header) >= self.header.sizes.len() {
            let start = || Nearest::new(k);
            let parts = self.slots.par_chunks(TASK).zip(self.rows.par_chunks(TASK * n));
            let nearest = parts
                .fold(start, |mut nearest, (slots, rows)| {
                    scan(&row, slots, rows, &mut nearest);
                    nearest
                })
                .reduce(start, Nearest::join);
            (nearest, self.slots.len())
        } else {
            let (mut nearest, mut n_measured) = (Nearest::new(k), 0);
            for cell in nearest_cells(&row, &self.centroids, self.header.probes) {
                let [start, end] = [0, 1].map(|i| self.starts[cell as usize + i]);
                n_measured += end - start;
                scan(&row, &self.slots[start..end], &self.rows[start * n..end * n], &mut nearest);
            }
            (nearest, n_measured)
        };
        let shape = |Hit { slot, .. }: Hit| {
            let position = self.positions[slot as usize] as usize;
            let id = self.names.get(slot).to_owned();
            NearShape { id, distance: distance(query, &self.rows[position * n..][..query.len()]) }
        };
        let shapes = nearest.into_sorted().into_iter().map(shape).collect();
        Ok(Found::new(shapes, n_measured, &self.header, mode))
    }
}
