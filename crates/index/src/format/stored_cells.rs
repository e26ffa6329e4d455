//! Vectors divided into cells, in a table of the index.

use std::collections::HashMap;

use redb::TableDefinition;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::IndexError;
use super::codec::{Floats, encode};
use super::tables::{At, ENTRIES, FUSED, Snapshot, Store};
use crate::ShapeEntry;
use crate::vectors::{Cells, CellsHeader, Centroids, padded, threshold};

/// A key: the kind of a part, then the cell and the part of it, or the part and zero.
type Key = (u8, u32, u32);

const SEARCH: TableDefinition<'_, Key, &[u8]> = TableDefinition::new("search");

/// Kinds of parts.
const HEADER: u8 = 0;
const CENTROIDS: u8 = 1;
const CELLS: u8 = 2;
const NAMES: u8 = 3;

/// Bytes of vectors in one value: with overhead just below a power of two, to which redb rounds up.
const PART: usize = 62 << 10;

/// Names in one value.
const NAMES_IN_PART: usize = 128;

/// Some vectors of one cell.
#[derive(Serialize, Deserialize)]
pub(crate) struct Part {
    /// Numbers of the vectors.
    pub(crate) slots: Vec<u32>,
    rows: Floats,
}

impl Part {
    /// The padded vectors.
    pub(crate) fn rows(&self) -> &[f32] {
        &self.rows.0
    }
}

/// Number of vectors, `n` long, in one value.
fn rows_in_part(n: usize) -> usize {
    (PART / (4 * n)).max(1)
}

/// Divides the vectors of a database into cells and stores them, replacing earlier cells.
pub(crate) fn write_cells(store: &Store<'_>) -> Result<(), IndexError> {
    let (names, rows, dim) = vectors(store)?;
    let n = padded(dim);
    let mut cells = Cells::of(&rows, dim, n);
    cells.header.threshold = threshold(&rows, n, &classes(store)?);
    store.write(|transaction| {
        transaction.delete_table(SEARCH).at(store)?;
        let mut table = transaction.open_table(SEARCH).at(store)?;
        let mut put = |key: Key, bytes: Result<Vec<u8>, _>| {
            let bytes =
                bytes.map_err(|source| IndexError::Codec { id: format!("search {key:?}"), source })?;
            table.insert(key, bytes.as_slice()).at(store)?;
            Ok::<(), IndexError>(())
        };
        put((HEADER, 0, 0), encode(&cells.header))?;
        for (i, rows) in cells.centroids.rows.chunks(rows_in_part(n) * n).enumerate() {
            put((CENTROIDS, i as u32, 0), encode(&Floats(rows.to_vec())))?;
        }
        let mut slots = cells.slots.as_slice();
        for (cell, size) in cells.header.sizes.iter().enumerate() {
            let (of_cell, rest) = slots.split_at(*size as usize);
            slots = rest;
            for (i, slots) in of_cell.chunks(rows_in_part(n)).enumerate() {
                let of_part =
                    slots.iter().flat_map(|slot| &rows[*slot as usize * n..][..n]).copied().collect();
                let part = Part { slots: slots.to_vec(), rows: Floats(of_part) };
                put((CELLS, cell as u32, i as u32), encode(&part))?;
            }
        }
        for (i, names) in names.chunks(NAMES_IN_PART).enumerate() {
            put((NAMES, i as u32, 0), encode(&names))?;
        }
        Ok(())
    })
}

/// The class of each shape, as a number, in the order of the shapes' names.
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

/// All names in ascending order, their padded vectors in the same order, and the length of a vector without padding.
pub(crate) fn vectors(store: &Store<'_>) -> Result<(Vec<String>, Vec<f32>, usize), IndexError> {
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

/// Cells in an index file, read on demand.
pub(crate) struct StoredCells<'a> {
    snapshot: Snapshot<'a>,
    pub(crate) header: CellsHeader,
    pub(crate) centroids: Centroids,
}

impl<'a> StoredCells<'a> {
    pub(crate) fn open(store: &'a Store<'a>) -> Result<Self, IndexError> {
        let snapshot = store.read()?;
        let header: CellsHeader = part(&snapshot, (HEADER, 0, 0))?;
        let n = padded(header.dim);
        let mut rows = Vec::with_capacity(header.sizes.len() * n);
        for i in 0.. {
            if rows.len() >= header.sizes.len() * n {
                break;
            }
            rows.extend(part::<Floats>(&snapshot, (CENTROIDS, i, 0))?.0);
        }
        Ok(Self { snapshot, header, centroids: Centroids::new(rows, n) })
    }

    /// Calls `visit` with each part of a cell.
    pub(crate) fn each_part(
        &self,
        cell: u32,
        mut visit: impl FnMut(Part) -> Result<(), IndexError>,
    ) -> Result<(), IndexError> {
        let n = padded(self.header.dim);
        let n_parts = (self.header.sizes[cell as usize] as usize).div_ceil(rows_in_part(n));
        (0..n_parts as u32).try_for_each(|i| visit(part(&self.snapshot, (CELLS, cell, i))?))
    }

    /// The names of all vectors, in the order of their numbers.
    pub(crate) fn names(&self) -> impl Iterator<Item = Result<Vec<String>, IndexError>> {
        (0..self.header.n.div_ceil(NAMES_IN_PART)).map(|i| part(&self.snapshot, (NAMES, i as u32, 0)))
    }

    /// The name of a vector.
    pub(crate) fn name(&self, slot: u32) -> Result<String, IndexError> {
        let names: Vec<String> = part(&self.snapshot, (NAMES, slot / NAMES_IN_PART as u32, 0))?;
        let name = names.into_iter().nth(slot as usize % NAMES_IN_PART);
        name.ok_or_else(|| missing(self.snapshot.store, "a name"))
    }

    /// The vector of a name, without padding.
    pub(crate) fn vector(&self, id: &str) -> Result<Vec<f32>, IndexError> {
        self.snapshot.fused(id)?.ok_or_else(|| missing(self.snapshot.store, "a vector"))
    }
}

fn missing(store: &Store<'_>, what: &str) -> IndexError {
    IndexError::damaged(store.path, format!("{what} of the search table is missing"))
}

fn part<T: DeserializeOwned>(snapshot: &Snapshot<'_>, key: Key) -> Result<T, IndexError> {
    let store = snapshot.store;
    let lost = || missing(store, "a part");
    let table = snapshot.table(SEARCH)?.ok_or_else(lost)?;
    let bytes = table.get(key).at(store)?.ok_or_else(lost)?;
    store.decoded(bytes.value(), "search table")
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
