//! Search in memory.

use rayon::prelude::*;

use super::{Found, NearShape, SearchMode, distance, padded_query};
use crate::texts::Texts;
use crate::vectors::{CellsHeader, Centroids, Divided, Hit, NEIGHBORS, Nearest, Reach, padded, scan};
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
    rows: Vec<f32>,
    ids: Texts,
}

impl Searcher {
    /// Reads the vectors of an index: `4 d` bytes and the name of each shape.
    ///
    /// # Errors
    /// [`IndexError::Io`], [`IndexError::Damaged`].
    pub fn load(index: &Index) -> Result<Self, IndexError> {
        let (heads, view) = (index.heads()?, index.view());
        let header = heads.header.clone();
        let mut ids = Texts::default();
        let mut rows = Vec::with_capacity(header.n * padded(header.dim));
        let mut starts = vec![0];
        for cell in 0..header.n_cells as u32 {
            for part in heads.parts(view, cell) {
                let (_, part) = part?;
                ids.extend(&part.ids);
                rows.extend_from_slice(part.rows());
            }
            starts.push(ids.len());
        }
        if ids.len() != header.n {
            return Err(IndexError::damaged(index.path(), "its cells do not hold all shapes"));
        }
        ids.shrink_to_fit();
        Ok(Self { header, centroids: heads.centroids.clone(), starts, rows, ids })
    }

    /// The `k` shapes whose vectors are nearest to `query`.
    ///
    /// # Errors
    /// [`IndexError::OtherLength`], [`IndexError::BadVector`].
    pub fn nearest(&self, query: &[f32], k: usize, mode: SearchMode) -> Result<Found, IndexError> {
        let row = padded_query(query, &self.header)?;
        let n = row.len();
        let (reach, k_least) = (mode.reach(&self.header), k.max(NEIGHBORS));
        let (nearest, n_measured) = if reach == Reach::ALL {
            let start = || Nearest::new(k_least);
            let parts = self.rows.par_chunks(TASK * n).enumerate();
            let nearest = parts
                .fold(start, |mut nearest, (i, rows)| {
                    scan(&row, (i * TASK) as u32, rows, &mut nearest);
                    nearest
                })
                .reduce(start, Nearest::join);
            (nearest, self.ids.len())
        } else {
            let (rows, starts, centroids) = (&self.rows, &self.starts, &self.centroids);
            Divided { rows, starts, centroids, reach }.near(&row, k_least)
        };
        let shape = |Hit { slot, .. }: Hit| {
            let slot = slot as usize;
            let distance = distance(query, &self.rows[slot * n..][..query.len()]);
            NearShape { id: self.ids.get(slot).to_owned(), distance }
        };
        let shapes = nearest.into_hits().map(shape).collect();
        Ok(Found::new(shapes, k, n_measured, &self.header, mode))
    }
}
