//! Cells in an index file.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::kernels::padded;
use super::kmeans::Centroids;
use super::nearest::{Hit, Nearest};
use super::plan::{About, Plan, nearest_cells, scan};
use super::searcher::{Found, NearShape, SearchMode, distance};
use super::threshold::threshold;
use crate::codec::{Floats, encode};
use crate::tables::{ENTRIES, FUSED, SEARCH, Snapshot, Store};
use crate::{Index, IndexError, ShapeEntry};

/// Bytes of vectors in one value: with all that comes with them, just below a power of two, to which redb
/// rounds.
const PART: usize = 62 << 10;

/// Names in one value.
const NAMES: usize = 128;

/// Kinds of parts: the first number of a key. The others are the cell and its part, or the part and zero.
const ABOUT: u8 = 0;
const CENTROIDS: u8 = 1;
const CELLS: u8 = 2;
const NAMED: u8 = 3;

/// Vectors of one cell.
#[derive(Serialize, Deserialize)]
struct Part {
    slots: Vec<u32>,
    rows: Floats,
}

/// Vectors that fit into one value.
fn rows_in_part(n: usize) -> usize {
    (PART / (4 * n)).max(1)
}

/// Makes what is searched from the vectors of a database, over what was there.
pub(crate) fn write(store: &Store<'_>) -> Result<(), IndexError> {
    let (names, rows, dim) = vectors(store)?;
    let n = padded(dim);
    let mut plan = Plan::of(&rows, dim, n);
    plan.about.threshold = threshold(&rows, n, &classes(store)?);
    store.write(|transaction| {
        transaction.delete_table(SEARCH).map_err(|fault| store.fault(fault))?;
        let mut table = transaction.open_table(SEARCH).map_err(|fault| store.fault(fault))?;
        let mut put = |key: (u8, u32, u32), bytes: Result<Vec<u8>, _>| {
            let bytes =
                bytes.map_err(|source| IndexError::Codec { id: format!("search {key:?}"), source })?;
            table.insert(key, bytes.as_slice()).map_err(|fault| store.fault(fault))?;
            Ok::<(), IndexError>(())
        };
        put((ABOUT, 0, 0), encode(&plan.about))?;
        for (i, rows) in plan.centroids.rows.chunks(rows_in_part(n) * n).enumerate() {
            put((CENTROIDS, i as u32, 0), encode(&Floats(rows.to_vec())))?;
        }
        let mut slots = plan.slots.as_slice();
        for (cell, size) in plan.about.sizes.iter().enumerate() {
            let (of_cell, rest) = slots.split_at(*size as usize);
            slots = rest;
            for (i, slots) in of_cell.chunks(rows_in_part(n)).enumerate() {
                let of_part =
                    slots.iter().flat_map(|slot| &rows[*slot as usize * n..][..n]).copied().collect();
                let part = Part { slots: slots.to_vec(), rows: Floats(of_part) };
                put((CELLS, cell as u32, i as u32), encode(&part))?;
            }
        }
        for (i, names) in names.chunks(NAMES).enumerate() {
            put((NAMED, i as u32, 0), encode(&names))?;
        }
        Ok(())
    })
}

/// The classes of all shapes in order of their names, as numbers.
fn classes(store: &Store<'_>) -> Result<Vec<u32>, IndexError> {
    let mut numbers: HashMap<String, u32> = HashMap::new();
    let mut classes = Vec::new();
    store.read()?.each(ENTRIES, |_, entry: ShapeEntry| {
        let next = numbers.len() as u32;
        classes.push(*numbers.entry(entry.label).or_insert(next));
        Ok::<(), IndexError>(())
    })?;
    Ok(classes)
}

/// All vectors in order of their names, padded, and their length.
fn vectors(store: &Store<'_>) -> Result<(Vec<String>, Vec<f32>, usize), IndexError> {
    let snapshot = store.read()?;
    let dim: usize = snapshot.about("length")?.unwrap_or(1);
    let n = padded(dim);
    let count = snapshot.len()?;
    let mut names = Vec::with_capacity(count);
    let mut rows = Vec::with_capacity(count * n);
    snapshot.each(FUSED, |id, Floats(fused)| {
        names.push(id.to_owned());
        rows.extend(fused);
        rows.resize(names.len() * n, 0.0);
        Ok::<(), IndexError>(())
    })?;
    Ok((names, rows, dim))
}

/// Holds what is searched against the vectors it was made from: the faults.
pub(crate) fn check(index: &Index) -> Result<Vec<String>, IndexError> {
    let store = index.store();
    let (names, rows, dim) = vectors(&store)?;
    let n = padded(dim);
    let stored = Stored::open(&store)?;
    let mut faults = Vec::new();
    let mut seen = vec![false; names.len()];
    for cell in 0..stored.about.sizes.len() as u32 {
        stored.each_part(cell, |part| {
            for (slot, row) in part.slots.iter().zip(part.rows.0.chunks_exact(n)) {
                let slot = *slot as usize;
                match seen.get_mut(slot) {
                    Some(seen) if !*seen && rows[slot * n..][..n] == *row => *seen = true,
                    _ => faults.push(format!("row {slot} of cell {cell} is not the vector of a shape")),
                }
            }
            Ok(())
        })?;
    }
    faults.extend(
        seen.iter().zip(&names).filter(|(seen, _)| !**seen).map(|(_, id)| format!("`{id}` is in no cell")),
    );
    for (slot, id) in names.iter().enumerate() {
        if stored.name(slot as u32)? != *id {
            faults.push(format!("row {slot} is not named `{id}`"));
        }
    }
    Ok(faults)
}

/// What is searched, read from the file as it is needed.
pub(super) struct Stored<'a> {
    snapshot: Snapshot<'a>,
    pub(super) about: About,
    pub(super) centroids: Centroids,
}

impl<'a> Stored<'a> {
    pub(super) fn open(store: &'a Store<'a>) -> Result<Self, IndexError> {
        let snapshot = store.read()?;
        let about: About = part(&snapshot, (ABOUT, 0, 0))?;
        let n = padded(about.dim);
        let mut rows = Vec::with_capacity(about.sizes.len() * n);
        for i in 0.. {
            if rows.len() >= about.sizes.len() * n {
                break;
            }
            rows.extend(part::<Floats>(&snapshot, (CENTROIDS, i, 0))?.0);
        }
        Ok(Self { snapshot, about, centroids: Centroids::new(rows, n) })
    }

    /// Calls `visit` with the parts of a cell: numbers and padded vectors.
    fn each_part(
        &self,
        cell: u32,
        mut visit: impl FnMut(Part) -> Result<(), IndexError>,
    ) -> Result<(), IndexError> {
        let n = padded(self.about.dim);
        let n_parts = (self.about.sizes[cell as usize] as usize).div_ceil(rows_in_part(n));
        (0..n_parts as u32).try_for_each(|i| visit(part(&self.snapshot, (CELLS, cell, i))?))
    }

    /// Calls `visit` with numbers and padded vectors of one cell after another.
    pub(super) fn each_cell(&self, mut visit: impl FnMut(&[u32], &[f32])) -> Result<(), IndexError> {
        (0..self.about.sizes.len() as u32).try_for_each(|cell| {
            self.each_part(cell, |part| {
                visit(&part.slots, &part.rows.0);
                Ok(())
            })
        })
    }

    /// Calls `visit` with some names after others, in order.
    pub(super) fn each_names(&self, mut visit: impl FnMut(Vec<String>)) -> Result<(), IndexError> {
        (0..self.about.n.div_ceil(NAMES))
            .try_for_each(|i| part(&self.snapshot, (NAMED, i as u32, 0)).map(&mut visit))
    }

    fn name(&self, slot: u32) -> Result<String, IndexError> {
        let names: Vec<String> = part(&self.snapshot, (NAMED, slot / NAMES as u32, 0))?;
        let name = names.into_iter().nth(slot as usize % NAMES);
        name.ok_or_else(|| missing(self.snapshot.store, "a name"))
    }
}

fn missing(store: &Store<'_>, what: &str) -> IndexError {
    IndexError::Damaged {
        path: store.path.to_owned(),
        what: format!("{what} of what is searched is missing"),
    }
}

fn part<T: serde::de::DeserializeOwned>(
    snapshot: &Snapshot<'_>,
    key: (u8, u32, u32),
) -> Result<T, IndexError> {
    let store = snapshot.store;
    let lost = || missing(store, "a part");
    let table = snapshot.table(SEARCH)?.ok_or_else(lost)?;
    let bytes = table.get(key).map_err(|fault| store.fault(fault))?.ok_or_else(lost)?;
    store.decoded(bytes.value(), "what is searched")
}

impl Index {
    /// The `k` shapes whose vectors are nearest to `query`, read from the file as they are needed.
    ///
    /// # Errors
    /// [`IndexError::OtherLength`], [`IndexError::BadVector`], [`IndexError::Io`],
    /// [`IndexError::Damaged`].
    pub fn nearest(&self, query: &[f32], k: usize, mode: SearchMode) -> Result<Found, IndexError> {
        let store = self.store();
        let stored = Stored::open(&store)?;
        let padded_query = super::searcher::prepared(query, &stored.about)?;
        let probes = mode.probes(&stored.about);
        let cells = nearest_cells(&padded_query, &stored.centroids, probes);
        let (mut nearest, mut n_measured) = (Nearest::new(k), 0);
        for cell in cells {
            stored.each_part(cell, |part| {
                n_measured += part.slots.len();
                scan(&padded_query, &part.slots, &part.rows.0, &mut nearest);
                Ok(())
            })?;
        }
        let mut neighbors = Vec::with_capacity(k.min(self.len()));
        for Hit { slot, .. } in nearest.into_sorted() {
            let id = stored.name(slot)?;
            let lost = || missing(&store, "a vector");
            let fused = stored.snapshot.fused(&id)?.ok_or_else(lost)?;
            neighbors.push(NearShape { distance: distance(query, &fused), id });
        }
        Ok(Found::new(neighbors, n_measured, &stored.about, mode))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_at_least_one_row() {
        assert_eq!(rows_in_part(1 << 20), 1);
        assert_eq!(rows_in_part(128), 124);
    }
}
