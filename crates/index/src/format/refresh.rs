//! Brings the cells of a database up to date with its shapes.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use redb::WriteTransaction;
use serde::Serialize;

use super::IndexError;
use super::codec::{Floats, encode};
use super::guard::Guarded;
use super::stored_cells::{
    CELLS, CENTROIDS, FORMAT_1, HEADER, Heads, Key, Part, ROWS, TRIALS, all_shapes, rows_in_part,
    vector_length,
};
use super::tables::{CHANGED, CellState, Snapshot, Store};
use crate::vectors::{
    CellsHeader, Centroids, Change, Rows, Trial, TrialKey, Trials, divided, n_cells, nearest_cells, padded,
};

/// Brings the cells of a database up to date with its shapes. `base` is the database that it was copied from, if there
/// is one. Writes only what has changed since, unless that is much.
pub(crate) fn refresh_cells(store: &Store<'_>, base: Option<&Store<'_>>) -> Result<(), IndexError> {
    let snapshot = store.read()?;
    let state = snapshot.about("cells")?.unwrap_or(CellState::Stale);
    let (n, dim) = (snapshot.len()?, vector_length(&snapshot)?);
    let follows = match (state, base) {
        (CellState::Current, _) => return Ok(()),
        (CellState::Stale, _) | (_, None) => None,
        (CellState::Follow, Some(base)) => {
            let changed = snapshot.keys(CHANGED)?;
            let is_little = 2 * changed.len() <= n.max(64);
            let heads = Heads::stored(&snapshot)?.filter(|heads| is_little && heads.header.serves(n, dim));
            heads.map(|heads| (base, changed, heads))
        }
    };
    match follows {
        Some((base, changed, heads)) => change(&snapshot, &base.read()?, &heads, changed, n),
        None => train(store),
    }
}

/// Divides all vectors into new cells.
fn train(store: &Store<'_>) -> Result<(), IndexError> {
    let (shapes, dim) = all_shapes(store)?;
    let (n_rows, n) = (shapes.ids.len(), padded(dim));
    let (centroids, cells) = divided(shapes.rows(), n, n_cells(n_rows));
    let n_cells = centroids.rows.len() / n;
    let all = Rows { cells: &cells, ..shapes.in_cell(&0) };
    let trials = Trials::of(all, n_cells);
    let mut order: Vec<usize> = (0..n_rows).collect();
    order.sort_by_key(|i| cells[*i]);
    write(store, |put| {
        put.clear()?;
        for (i, rows) in centroids.rows.chunks(rows_in_part(n) * n).enumerate() {
            put.value((CENTROIDS, i as u32, 0), &Floats(rows.to_vec()))?;
        }
        for of_cell in order.chunk_by(|a, b| cells[*a] == cells[*b]) {
            for (i, of_part) in of_cell.chunks(rows_in_part(n)).enumerate() {
                let mut part = Part::default();
                for row in of_part {
                    part.push(shapes.ids.get(*row), shapes.classes.get(*row), &shapes.rows()[row * n..][..n]);
                }
                put.value((ROWS, cells[of_part[0]], i as u32), &part)?;
            }
        }
        put.trials(&[], &trials.all)?;
        put.header(header(dim, n_rows, n_rows, &centroids, &trials))
    })
}

fn header(dim: usize, n: usize, n_trained: usize, centroids: &Centroids, trials: &Trials) -> CellsHeader {
    let (reach, recall) = trials.calibrated(centroids);
    let n_cells = centroids.rows.len() / padded(dim);
    CellsHeader { dim, n, n_cells, n_trained, reach, recall, threshold: trials.threshold() }
}

/// A shape as cells hold it: its padded vector and its class.
type Held = (Vec<f32>, String);

fn held(snapshot: &Snapshot<'_>, id: &str, dim: usize) -> Result<Option<Held>, IndexError> {
    let (Some(mut fused), Some(entry)) = (snapshot.fused(id)?, snapshot.entry(id)?) else { return Ok(None) };
    if fused.len() != dim {
        return Err(snapshot.store.damaged(format!("the vector of `{id}` has {} numbers", fused.len())));
    }
    fused.resize(padded(dim), 0.0);
    Ok(Some((fused, entry.label)))
}

/// Takes shapes that have changed since `base` out of their cells and puts them into the nearest ones.
fn change(
    snapshot: &Snapshot<'_>,
    base: &Snapshot<'_>,
    heads: &Heads,
    changed: Vec<String>,
    n_shapes: usize,
) -> Result<(), IndexError> {
    let (store, dim) = (snapshot.store, heads.header.dim);
    let (mut gone, mut come) = (Vec::new(), Vec::new());
    let mut changes = Vec::new();
    for id in changed {
        let (before, now) = (held(base, &id, dim)?, held(snapshot, &id, dim)?);
        if before == now {
            continue;
        }
        changes.push(Change { id: id.clone(), was_there: before.is_some(), now: None });
        gone.extend(before.map(|held| (id.clone(), held)));
        come.extend(now.map(|held| (id, held)));
    }
    if heads.header.n + come.len() != n_shapes + gone.len() {
        return Err(store.damaged(format!("its cells do not hold {n_shapes} shapes")));
    }
    let nearest = |shapes: &[(String, Held)]| {
        heads.centroids.assign(&shapes.iter().flat_map(|(_, (row, _))| row).copied().collect::<Vec<_>>())
    };
    let (from, to) = (nearest(&gone), nearest(&come));
    let mut cells = Cells { snapshot, heads, loaded: BTreeMap::new() };
    let mut names: BTreeMap<u32, HashSet<&str>> = BTreeMap::new();
    for (cell, (id, _)) in from.iter().zip(&gone) {
        names.entry(*cell).or_default().insert(id);
    }
    let mut lost = HashSet::new();
    for (cell, mut names) in names {
        cells.remove(cell, &mut names)?;
        lost.extend(names);
    }
    // Another processor may have rounded the other way between two cells.
    for (id, (row, _)) in gone.iter().filter(|(id, _)| lost.contains(id.as_str())) {
        let mut name = HashSet::from([id.as_str()]);
        for cell in nearest_cells(row, &heads.centroids, heads.header.n_cells) {
            cells.remove(cell.cell, &mut name)?;
            if name.is_empty() {
                break;
            }
        }
        if !name.is_empty() {
            return Err(store.damaged(format!("`{id}` is in no cell")));
        }
    }
    let mut now: HashMap<String, (Vec<f32>, String, u32)> = HashMap::new();
    for (cell, (id, (row, class))) in to.into_iter().zip(come) {
        cells.push(cell, &id, &class, &row)?;
        now.insert(id, (row, class, cell));
    }
    changes.iter_mut().for_each(|change| change.now = now.remove(&change.id));
    let mut trials = heads.trials(snapshot)?;
    let before = trials.all.clone();
    trials.change(&changes, |visit| cells.each(visit))?;
    let header = header(dim, n_shapes, heads.header.n_trained, &heads.centroids, &trials);
    write(store, |put| {
        for (cell, loaded) in &cells.loaded {
            for i in &loaded.dirty {
                match loaded.parts.get(i).filter(|part| part.ids.len() > 0) {
                    Some(part) => put.value((ROWS, *cell, *i), part)?,
                    None => put.remove((ROWS, *cell, *i))?,
                }
            }
        }
        put.trials(&before, &trials.all)?;
        put.header(header)
    })
}

/// Cells that are changed, over those that are stored.
struct Cells<'a> {
    snapshot: &'a Snapshot<'a>,
    heads: &'a Heads,
    loaded: BTreeMap<u32, Loaded>,
}

/// Parts of a cell by their numbers.
#[derive(Default)]
struct Loaded {
    parts: BTreeMap<u32, Part>,
    dirty: BTreeSet<u32>,
    /// Whether all parts are here, not the last only.
    is_whole: bool,
}

impl Cells<'_> {
    /// Removes the shapes of these names, and the names of those that were there.
    fn remove(&mut self, cell: u32, names: &mut HashSet<&str>) -> Result<(), IndexError> {
        let loaded = self.loaded.entry(cell).or_default();
        if !loaded.is_whole {
            self.heads.each_stored(self.snapshot, cell, |i, part| {
                loaded.parts.entry(i).or_insert(part);
                Ok(())
            })?;
            loaded.is_whole = true;
        }
        let n = padded(self.heads.header.dim);
        for (i, part) in &mut loaded.parts {
            if !part.ids.iter().any(|id| names.contains(id)) {
                continue;
            }
            let mut rest = Part::default();
            for (row, (id, class)) in part.ids.iter().zip(part.classes.iter()).enumerate() {
                if !names.remove(id) {
                    rest.push(id, class, &part.rows()[row * n..][..n]);
                }
            }
            *part = rest;
            loaded.dirty.insert(*i);
        }
        Ok(())
    }

    fn push(&mut self, cell: u32, id: &str, class: &str, row: &[f32]) -> Result<(), IndexError> {
        let loaded = self.loaded.entry(cell).or_default();
        if !loaded.is_whole && loaded.parts.is_empty() {
            loaded.parts.extend(self.heads.last_part(self.snapshot, cell)?);
        }
        let full = rows_in_part(row.len());
        let last = match loaded.parts.last_key_value() {
            Some((i, part)) if part.ids.len() < full => *i,
            Some((i, _)) => i + 1,
            None => 0,
        };
        loaded.parts.entry(last).or_default().push(id, class, row);
        loaded.dirty.insert(last);
        Ok(())
    }

    /// Visits all shapes as they are after the changes.
    fn each(&self, visit: &mut dyn FnMut(Rows<'_>)) -> Result<(), IndexError> {
        let none = Loaded::default();
        for cell in 0..self.heads.header.n_cells as u32 {
            let loaded = self.loaded.get(&cell).unwrap_or(&none);
            if !loaded.is_whole {
                self.heads.each_stored(self.snapshot, cell, |i, part| {
                    if !loaded.parts.contains_key(&i) {
                        visit(part.in_cell(&cell));
                    }
                    Ok(())
                })?;
            }
            loaded.parts.values().for_each(|part| visit(part.in_cell(&cell)));
        }
        Ok(())
    }
}

/// Writes the table of cells in one transaction, and marks it as up to date.
fn write(
    store: &Store<'_>,
    fill: impl FnOnce(&mut Put<'_>) -> Result<(), IndexError>,
) -> Result<(), IndexError> {
    store.write(|transaction| {
        fill(&mut Put { store, transaction })?;
        store.set(transaction, "cells", &CellState::Current)?;
        store.call(|| transaction.delete_table(CHANGED).map(drop))
    })
}

struct Put<'a> {
    store: &'a Store<'a>,
    transaction: &'a WriteTransaction,
}

impl Put<'_> {
    fn clear(&self) -> Result<(), IndexError> {
        self.store.call(|| {
            self.transaction.delete_table(FORMAT_1)?;
            self.transaction.delete_table(CELLS).map(drop)
        })
    }

    fn value<T: Serialize>(&self, key: Key, value: &T) -> Result<(), IndexError> {
        let bytes =
            encode(value).map_err(|source| IndexError::Codec { id: format!("cells {key:?}"), source })?;
        self.store.call(|| {
            let mut table = Guarded::new(self.transaction.open_table(CELLS)?);
            table.insert(key, bytes.as_slice())?;
            Ok::<_, redb::Error>(())
        })
    }

    fn remove(&self, key: Key) -> Result<(), IndexError> {
        self.store.call(|| {
            let mut table = Guarded::new(self.transaction.open_table(CELLS)?);
            table.remove(key)?;
            Ok::<_, redb::Error>(())
        })
    }

    fn header(&self, header: CellsHeader) -> Result<(), IndexError> {
        self.value((HEADER, 0, 0), &header)
    }

    /// Writes the trials that were not there before, and removes those that are no longer.
    fn trials(&self, before: &[Trial], now: &[Trial]) -> Result<(), IndexError> {
        let key = |[a, b]: TrialKey| (TRIALS, a, b);
        let known: HashMap<TrialKey, &Trial> = before.iter().map(|trial| (trial.key(), trial)).collect();
        let present: HashSet<TrialKey> = now.iter().map(Trial::key).collect();
        for gone in known.keys().filter(|gone| !present.contains(*gone)) {
            self.remove(key(*gone))?;
        }
        for trial in now.iter().filter(|trial| known.get(&trial.key()) != Some(trial)) {
            self.value(key(trial.key()), trial)?;
        }
        Ok(())
    }
}
