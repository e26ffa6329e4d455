//! Vectors divided into cells, in a table of the index.

use redb::TableDefinition;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::IndexError;
use super::codec::{Floats, LIMIT};
use super::tables::{ENTRIES, FUSED, Snapshot, Store};
use crate::ShapeEntry;
use crate::texts::Texts;
use crate::vectors::{CellsHeader, Centroids, Reach, Rows, Trial, Trials, padded};

/// A key: the kind of a part, then the cell and the part of it, the part and zero, or the key of a trial.
pub(super) type Key = (u8, u32, u32);

pub(super) const CELLS: TableDefinition<'_, Key, &[u8]> = TableDefinition::new("cells");

/// The same in format 1, which numbered vectors by the order of their names.
pub(super) const FORMAT_1: TableDefinition<'_, Key, &[u8]> = TableDefinition::new("search");

/// Kinds of parts.
pub(super) const HEADER: u8 = 0;
pub(super) const CENTROIDS: u8 = 1;
pub(super) const ROWS: u8 = 2;
pub(super) const TRIALS: u8 = 3;

/// Bytes of vectors in one value: with overhead just below a power of two, to which redb rounds up.
const PART: usize = 56 << 10;

/// Some shapes of one cell.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Part {
    pub(crate) ids: Texts,
    pub(crate) classes: Texts,
    rows: Floats,
}

impl Part {
    /// The padded vectors.
    pub(crate) fn rows(&self) -> &[f32] {
        &self.rows.0
    }

    pub(crate) fn in_cell<'a>(&'a self, cell: &'a u32) -> Rows<'a> {
        let cells = std::slice::from_ref(cell);
        Rows { rows: self.rows(), ids: &self.ids, classes: &self.classes, cells }
    }

    /// Brings the shapes into an order: `order[i]` becomes the `i`-th. Vectors have `n` numbers.
    pub(super) fn sort(&mut self, order: &[usize], n: usize) {
        self.ids = order.iter().map(|i| self.ids.get(*i)).collect();
        self.classes = order.iter().map(|i| self.classes.get(*i)).collect();
        // In place, one cycle of the permutation after the other: the vectors of a million shapes take a gigabyte.
        let rows = &mut self.rows.0;
        let mut is_done = vec![false; order.len()];
        for first in 0..order.len() {
            if is_done[first] {
                continue;
            }
            let start = rows[first * n..][..n].to_vec();
            let mut to = first;
            loop {
                is_done[to] = true;
                let from = order[to];
                if from == first {
                    rows[to * n..][..n].copy_from_slice(&start);
                    break;
                }
                rows.copy_within(from * n..(from + 1) * n, to * n);
                to = from;
            }
        }
    }

    pub(super) fn push(&mut self, id: &str, class: &str, row: &[f32]) {
        self.ids.push(id);
        self.classes.push(class);
        self.rows.0.extend_from_slice(row);
    }
}

/// Number of vectors, `n` long, in one value.
pub(super) fn rows_in_part(n: usize) -> usize {
    (PART / (4 * n)).max(1)
}

/// What a search needs to know before it reads cells.
#[derive(Debug)]
pub(crate) struct Heads {
    pub(crate) header: CellsHeader,
    pub(crate) centroids: Centroids,
    /// All shapes, if the file has format 1.
    format_1: Option<Part>,
}

impl Heads {
    pub(crate) fn read(store: &Store<'_>) -> Result<Self, IndexError> {
        let snapshot = store.read()?;
        if let Some(heads) = Self::stored(&snapshot)? {
            return Ok(heads);
        }
        if !snapshot.has(FORMAT_1)? {
            return Err(missing(store, "the header"));
        }
        let (part, dim) = all_shapes(store)?;
        let (n, trials) = (part.ids.len(), Trials::of(part.in_cell(&0), 1));
        let threshold = trials.threshold();
        let header =
            CellsHeader { dim, n, n_cells: 1, n_trained: n, reach: Reach::ALL, recall: 1.0, threshold };
        let centroids = Centroids::new(vec![0.0; padded(dim)], padded(dim));
        Ok(Self { header, centroids, format_1: Some(part) })
    }

    /// `None` if there are no cells.
    pub(super) fn stored(snapshot: &Snapshot<'_>) -> Result<Option<Self>, IndexError> {
        let store = snapshot.store;
        let Some(bytes) = snapshot.bytes(CELLS, (HEADER, 0, 0))? else { return Ok(None) };
        let header: CellsHeader = store.decoded(&bytes, "the header of the cells")?;
        check_header(store, &header)?;
        let n = padded(header.dim);
        let mut rows = Vec::with_capacity(header.n_cells * n);
        for i in 0..header.n_cells.div_ceil(rows_in_part(n)) {
            let bytes = snapshot.bytes(CELLS, (CENTROIDS, i as u32, 0))?;
            let bytes = bytes.ok_or_else(|| missing(store, "a centre"))?;
            let Floats(more) = store.decoded(&bytes, "the centres of the cells")?;
            rows.extend(more);
        }
        if rows.len() != header.n_cells * n {
            return Err(store.damaged("the number of its cells is wrong"));
        }
        Ok(Some(Self { header, centroids: Centroids::new(rows, n), format_1: None }))
    }

    /// Calls `visit` with each part of a cell.
    pub(crate) fn each_part(
        &self,
        snapshot: &Snapshot<'_>,
        cell: u32,
        mut visit: impl FnMut(Part) -> Result<(), IndexError>,
    ) -> Result<(), IndexError> {
        if let Some(part) = &self.format_1 {
            return visit(part.clone());
        }
        self.each_stored(snapshot, cell, |_, part| visit(part))
    }

    /// Calls `visit` with the number and the content of each part of a cell.
    pub(super) fn each_stored(
        &self,
        snapshot: &Snapshot<'_>,
        cell: u32,
        mut visit: impl FnMut(u32, Part) -> Result<(), IndexError>,
    ) -> Result<(), IndexError> {
        each_value(snapshot, (ROWS, cell, 0), (ROWS, cell, u32::MAX), |(.., i), part| {
            visit(i, self.checked(snapshot.store, part)?)
        })
    }

    /// The last part of a cell and its number.
    pub(super) fn last_part(
        &self,
        snapshot: &Snapshot<'_>,
        cell: u32,
    ) -> Result<Option<(u32, Part)>, IndexError> {
        let store = snapshot.store;
        let Some(table) = snapshot.table(CELLS)? else { return Ok(None) };
        let found = store.call(|| {
            let last = table.range((ROWS, cell, 0)..=(ROWS, cell, u32::MAX))?.next_back().transpose()?;
            Ok::<_, redb::Error>(last.map(|(key, bytes)| (key.value().2, bytes.value().to_vec())))
        })?;
        let Some((i, bytes)) = found else { return Ok(None) };
        Ok(Some((i, self.checked(store, store.decoded(&bytes, "a part of a cell")?)?)))
    }

    fn checked(&self, store: &Store<'_>, part: Part) -> Result<Part, IndexError> {
        let n = part.ids.len();
        let agrees = part.classes.len() == n && part.rows.0.len() == n * padded(self.header.dim);
        if agrees { Ok(part) } else { Err(store.damaged("a part of a cell contradicts itself")) }
    }

    /// The trials, in the order of their keys.
    pub(crate) fn trials(&self, snapshot: &Snapshot<'_>) -> Result<Trials, IndexError> {
        let (n, n_cells) = (padded(self.header.dim), self.header.n_cells);
        if let Some(part) = &self.format_1 {
            return Ok(Trials::of(part.in_cell(&0), 1));
        }
        let mut all: Vec<Trial> = Vec::new();
        each_value(snapshot, (TRIALS, 0, 0), (TRIALS, u32::MAX, u32::MAX), |key, trial: Trial| {
            let [a, b] = trial.key();
            match trial.is_of(n, n_cells) && key == (TRIALS, a, b) {
                true => all.push(trial),
                false => return Err(snapshot.store.damaged("a trial contradicts itself")),
            }
            Ok(())
        })?;
        Ok(Trials::stored(all, n_cells))
    }
}

/// Calls `visit` with each value of the table from one key to another, in ascending order.
fn each_value<T: DeserializeOwned>(
    snapshot: &Snapshot<'_>,
    from: Key,
    to: Key,
    mut visit: impl FnMut(Key, T) -> Result<(), IndexError>,
) -> Result<(), IndexError> {
    let store = snapshot.store;
    let Some(table) = snapshot.table(CELLS)? else { return Ok(()) };
    let rows = store.call(|| table.range(from..=to))?;
    store.each_row(rows, |key| key, |&key, bytes| visit(key, store.decoded(&bytes, "a part of a cell")?))
}

/// All shapes in ascending order of their names, and the length of a vector without padding.
pub(crate) fn all_shapes(store: &Store<'_>) -> Result<(Part, usize), IndexError> {
    let snapshot = store.read()?;
    let dim = vector_length(&snapshot)?;
    let n = padded(dim);
    let count = snapshot.len()?;
    let mut part = Part::default();
    // A database may state any numbers, but vectors without padding fit into it.
    let fits = (count * dim) as u64 <= store.n_bytes;
    part.rows.0.reserve_exact(if fits { count * n } else { 0 });
    snapshot.each(FUSED, |id, Floats(fused)| {
        if fused.len() != dim {
            let found = fused.len();
            return Err(store.damaged(format!("the vector of `{id}` has {found} numbers, not {dim}")));
        }
        part.ids.push(id);
        part.rows.0.extend(fused);
        part.rows.0.resize(part.ids.len() * n, 0.0);
        Ok(())
    })?;
    snapshot.each(ENTRIES, |id, entry: ShapeEntry| {
        let i = part.classes.len();
        if i >= part.ids.len() || part.ids.get(i) != id {
            return Err(store.damaged(format!("`{id}` has no vector")));
        }
        part.classes.push(&entry.label);
        Ok(())
    })?;
    if part.classes.len() != part.ids.len() {
        return Err(store.damaged("there are vectors without an entry"));
    }
    Ok((part, dim))
}

/// The length of the vectors; 1 if there are none.
pub(super) fn vector_length(snapshot: &Snapshot<'_>) -> Result<usize, IndexError> {
    let dim = snapshot.about("length")?.unwrap_or(1);
    check_length(snapshot.store, dim)?;
    Ok(dim)
}

/// Checks the length of the vectors, as the file states it.
fn check_length(store: &Store<'_>, dim: usize) -> Result<(), IndexError> {
    match (1..=LIMIT / 4).contains(&dim) {
        true => Ok(()),
        false => Err(store.damaged(format!("its vectors have {dim} numbers"))),
    }
}

/// Checks the sizes in a header: what they promise must fit into the file.
fn check_header(store: &Store<'_>, header: &CellsHeader) -> Result<(), IndexError> {
    check_length(store, header.dim)?;
    let row = 4 * padded(header.dim) as u64;
    let rows = (header.n_cells as u64).saturating_add(header.n as u64);
    let centres_fit = (header.n_cells as u64).saturating_mul(row) <= store.n_bytes;
    // An empty index has the centre of its one cell, which is stored.
    let rows_fit = rows.saturating_mul(row) <= store.n_bytes;
    if !(1..=header.n.max(1)).contains(&header.n_cells) || !centres_fit || !rows_fit {
        return Err(store.damaged("the sizes of its cells are wrong"));
    }
    Ok(())
}

fn missing(store: &Store<'_>, what: &str) -> IndexError {
    store.damaged(format!("{what} of its cells is missing"))
}

/// Overwrites the header with one that states these sizes.
#[cfg(test)]
pub(crate) fn write_header(
    store: &Store<'_>,
    dim: usize,
    n: usize,
    n_cells: usize,
) -> Result<(), IndexError> {
    let header =
        CellsHeader { dim, n, n_cells, n_trained: n, reach: Reach::ALL, recall: 1.0, threshold: None };
    let Ok(bytes) = super::codec::encode(&header) else { return Err(missing(store, "the header")) };
    store.write(|transaction| {
        store.call(|| {
            transaction.open_table(CELLS)?.insert((HEADER, 0, 0), bytes.as_slice())?;
            Ok::<_, redb::Error>(())
        })
    })
}

/// Removes what format 1 does not have.
#[cfg(test)]
pub(crate) fn make_format_1(store: &Store<'_>) -> Result<(), IndexError> {
    store.write(|transaction| {
        store.call(|| {
            transaction.delete_table(super::tables::CLASSES)?;
            transaction.open_table(FORMAT_1)?.insert((HEADER, 0, 0), &[][..])?;
            Ok::<_, redb::Error>(())
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_sorted_in_place() {
        let mut part = Part::default();
        (0..7).for_each(|i| part.push(&i.to_string(), &format!("c{i}"), &[i as f32, 0.5]));
        let order = [3, 1, 0, 6, 5, 4, 2];
        part.sort(&order, 2);
        for (i, from) in order.into_iter().enumerate() {
            assert_eq!((part.ids.get(i), part.classes.get(i)), (&*from.to_string(), &*format!("c{from}")));
            assert_eq!(part.rows()[2 * i..][..2], [from as f32, 0.5]);
        }
    }

    #[test]
    fn parts_hold_at_least_one_row() {
        assert_eq!(rows_in_part(1 << 20), 1);
        assert_eq!(rows_in_part(128), 112);
    }
}
