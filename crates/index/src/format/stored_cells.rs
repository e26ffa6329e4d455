//! Vectors divided into cells, in a table of the index.

use std::collections::HashMap;

use redb::TableDefinition;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::IndexError;
use super::codec::{Floats, LIMIT, encode};
use super::guard::Guarded;
use super::tables::{ENTRIES, FUSED, Snapshot, Store};
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
    let classes = classes(store)?;
    if classes.len() != names.len() {
        return Err(store.damaged(format!("{} shapes have {} vectors", classes.len(), names.len())));
    }
    cells.header.threshold = if classes.contains(&None) {
        // Nothing is known about shapes without a class.
        let labelled = rows.chunks(n).zip(&classes).filter(|(_, class)| class.is_some());
        let labelled: Vec<f32> = labelled.flat_map(|(row, _)| row).copied().collect();
        threshold(&labelled, n, &classes.into_iter().flatten().collect::<Vec<_>>())
    } else {
        threshold(&rows, n, &classes.into_iter().flatten().collect::<Vec<_>>())
    };
    store.write(|transaction| {
        let mut table = Guarded::new(store.call(|| {
            transaction.delete_table(SEARCH)?;
            transaction.open_table(SEARCH)
        })?);
        let mut put = |key: Key, bytes: Result<Vec<u8>, _>| {
            let bytes =
                bytes.map_err(|source| IndexError::Codec { id: format!("search {key:?}"), source })?;
            store.call(|| table.insert(key, bytes.as_slice()).map(drop))
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

/// The class of each shape as a number, if it has one, in the order of the shapes' names.
fn classes(store: &Store<'_>) -> Result<Vec<Option<u32>>, IndexError> {
    let mut numbers: HashMap<String, u32> = HashMap::new();
    let mut classes = Vec::new();
    store.read()?.each(ENTRIES, |_, entry: ShapeEntry| {
        let next = numbers.len() as u32;
        let is_labelled = !entry.label.is_empty();
        classes.push(is_labelled.then(|| *numbers.entry(entry.label).or_insert(next)));
        Ok::<(), IndexError>(())
    })?;
    Ok(classes)
}

/// All names in ascending order, their padded vectors in the same order, and the length of a vector without padding.
pub(crate) fn vectors(store: &Store<'_>) -> Result<(Vec<String>, Vec<f32>, usize), IndexError> {
    let snapshot = store.read()?;
    let dim: usize = snapshot.about("length")?.unwrap_or(1);
    check_length(store, dim)?;
    let n = padded(dim);
    let count = snapshot.len()?;
    let mut names = Vec::with_capacity(count);
    // A database may state any numbers, but vectors without padding fit into it.
    let mut rows = Vec::with_capacity(if (count * dim) as u64 <= store.n_bytes { count * n } else { 0 });
    snapshot.each(FUSED, |id, Floats(fused)| {
        if fused.len() != dim {
            let found = fused.len();
            return Err(store.damaged(format!("the vector of `{id}` has {found} numbers, not {dim}")));
        }
        names.push(id.to_owned());
        rows.extend(fused);
        rows.resize(names.len() * n, 0.0);
        Ok(())
    })?;
    Ok((names, rows, dim))
}

/// Checks the length of the vectors, as the file states it.
fn check_length(store: &Store<'_>, dim: usize) -> Result<(), IndexError> {
    match (1..=LIMIT / 4).contains(&dim) {
        true => Ok(()),
        false => Err(store.damaged(format!("its vectors cannot have {dim} numbers"))),
    }
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
        check_header(store, &header)?;
        let n = padded(header.dim);
        let mut rows = Vec::with_capacity(header.sizes.len() * n);
        for i in 0.. {
            if rows.len() >= header.sizes.len() * n {
                break;
            }
            let more = part::<Floats>(&snapshot, (CENTROIDS, i, 0))?.0;
            if more.is_empty() {
                return Err(missing(store, "a part"));
            }
            rows.extend(more);
        }
        if rows.len() != header.sizes.len() * n {
            return Err(store.damaged("the number of its cells is wrong"));
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
        (0..n_parts as u32).try_for_each(|i| {
            let part: Part = part(&self.snapshot, (CELLS, cell, i))?;
            if part.rows.0.len() != part.slots.len() * n
                || part.slots.iter().any(|slot| *slot as usize >= self.header.n)
            {
                return Err(self
                    .snapshot
                    .store
                    .damaged(format!("part {i} of cell {cell} contradicts itself")));
            }
            visit(part)
        })
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

/// Checks the sizes in a header: what they promise must fit into the file.
fn check_header(store: &Store<'_>, header: &CellsHeader) -> Result<(), IndexError> {
    check_length(store, header.dim)?;
    let CellsHeader { n: n_rows, sizes, .. } = header;
    let total: u64 = sizes.iter().map(|size| u64::from(*size)).sum();
    let row = 4 * padded(header.dim) as u64;
    let n_bytes = (sizes.len() as u64).saturating_add(total).saturating_mul(row);
    if sizes.is_empty() || total != *n_rows as u64 || n_bytes > store.n_bytes {
        return Err(store.damaged("the sizes of its cells are wrong"));
    }
    Ok(())
}

fn missing(store: &Store<'_>, what: &str) -> IndexError {
    store.damaged(format!("{what} of the search table is missing"))
}

fn part<T: DeserializeOwned>(snapshot: &Snapshot<'_>, key: Key) -> Result<T, IndexError> {
    let store = snapshot.store;
    let bytes = snapshot.bytes(SEARCH, key)?.ok_or_else(|| missing(store, "a part"))?;
    store.decoded(&bytes, "search table")
}

/// Overwrites the header with one that states these sizes.
#[cfg(test)]
pub(crate) fn write_header(store: &Store<'_>, dim: usize, sizes: Vec<u32>) -> Result<(), IndexError> {
    let n = sizes.iter().map(|size| *size as usize).sum();
    let header = CellsHeader { dim, n, sizes, probes: 1, recall: 1.0, threshold: None };
    let Ok(bytes) = encode(&header) else { return Err(missing(store, "a part")) };
    store.write(|transaction| {
        store.call(|| {
            transaction.open_table(SEARCH)?.insert((HEADER, 0, 0), bytes.as_slice())?;
            Ok::<_, redb::Error>(())
        })
    })
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
