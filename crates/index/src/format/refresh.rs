//! Brings the cells and the graph of a database up to date with its shapes.

use std::collections::{BTreeMap, HashMap, HashSet};

use redb::WriteTransaction;
use serde::Serialize;

use super::IndexError;
use super::changed_cells::{Cells, Held, held};
use super::codec::{Floats, encode};
use super::guard::Guarded;
use super::refresh_graph::{GraphChanges, follow};
use super::stored_cells::{
    CELLS, CENTROIDS, FORMAT_1, HEADER, Heads, Key, Part, ROWS, TRIALS, all_shapes, rows_in_part,
    vector_length,
};
use super::stored_graph::{GRAPH, N_NODES, Node};
use super::tables::{CHANGED, CellState, Snapshot, Store};
use crate::progress::Progress;
use crate::vectors::{
    CellsHeader, Centroids, Change, Divided, NodeKey, Rows, Trial, TrialKey, Trials, divided, n_cells,
    nearest_cells, node_key, padded,
};

/// Brings the cells and the graph of a database up to date with its shapes. `base` is the database that it was copied
/// from, if there is one. Writes only what has changed since, unless that is much or there is no graph.
pub(crate) fn refresh_cells(
    store: &Store<'_>,
    base: Option<&Store<'_>>,
    progress: &dyn Progress,
) -> Result<(), IndexError> {
    let snapshot = store.read()?;
    let has_graph = snapshot.about::<u64>(N_NODES)?.is_some();
    let state = snapshot.about("cells")?.unwrap_or(CellState::Stale);
    let (n, dim) = (snapshot.len()?, vector_length(&snapshot)?);
    let follows = match (state, base) {
        (CellState::Current, _) if has_graph => return Ok(()),
        (CellState::Current | CellState::Stale, _) | (_, None) => None,
        (CellState::Follow, _) if !has_graph => None,
        (CellState::Follow, Some(base)) => {
            let changed = snapshot.keys(CHANGED)?;
            let is_little = 2 * changed.len() <= n.max(64);
            let heads = Heads::stored(&snapshot)?.filter(|heads| is_little && heads.header.serves(n, dim));
            heads.map(|heads| (base, changed, heads))
        }
    };
    match follows {
        Some((base, changed, heads)) => change(&snapshot, &base.read()?, &heads, changed, n),
        None => train(store, progress),
    }
}

/// Divides all vectors into new cells, and finds the neighbours of all.
fn train(store: &Store<'_>, progress: &dyn Progress) -> Result<(), IndexError> {
    let (mut shapes, dim) = all_shapes(store)?;
    let (n_rows, n) = (shapes.ids.len(), padded(dim));
    let (centroids, mut cells) = divided(shapes.rows(), n, n_cells(n_rows));
    let n_cells = centroids.rows.len() / n;
    let mut order: Vec<usize> = (0..n_rows).collect();
    order.sort_by_key(|i| cells[*i]);
    shapes.sort(&order, n);
    cells.sort_unstable();
    let all = Rows { cells: &cells, ..shapes.in_cell(&0) };
    let trials = Trials::of(all, n_cells);
    let header = header(dim, n_rows, n_rows, &centroids, &trials);
    let keys: Vec<NodeKey> = shapes.ids.iter().map(node_key).collect();
    let starts: Vec<usize> =
        (0..=n_cells as u32).map(|cell| cells.partition_point(|other| *other < cell)).collect();
    let divided = Divided {
        rows: shapes.rows(),
        n,
        keys: &keys,
        starts: &starts,
        centroids: &centroids,
        reach: header.reach,
    };
    progress.begin(n_rows);
    let links = divided.links(&|done| progress.step(done));
    let mut nodes: Vec<(NodeKey, usize)> = keys.iter().copied().zip(0..).collect();
    nodes.sort_unstable();
    write(store, |put| {
        put.clear()?;
        for (i, rows) in centroids.rows.chunks(rows_in_part(n) * n).enumerate() {
            put.value((CENTROIDS, i as u32, 0), &Floats(rows.to_vec()))?;
        }
        for (cell, range) in (0..).zip(starts.windows(2)) {
            let rows: Vec<usize> = (range[0]..range[1]).collect();
            for (i, of_part) in rows.chunks(rows_in_part(n)).enumerate() {
                let mut part = Part::default();
                for row in of_part {
                    part.push(shapes.ids.get(*row), shapes.classes.get(*row), &shapes.rows()[row * n..][..n]);
                }
                put.value((ROWS, cell, i as u32), &part)?;
            }
        }
        put.trials(&[], &trials.all)?;
        let node = |(key, i): &(NodeKey, usize)| {
            (*key, Node { id: shapes.ids.get(*i).to_owned(), links: links[*i].clone() })
        };
        put.nodes(nodes.iter().map(node))?;
        put.n_nodes(n_rows)?;
        put.header(header)
    })
}

fn header(dim: usize, n: usize, n_trained: usize, centroids: &Centroids, trials: &Trials) -> CellsHeader {
    let (reach, recall) = trials.calibrated(centroids);
    let n_cells = centroids.rows.len() / padded(dim);
    CellsHeader { dim, n, n_cells, n_trained, reach, recall, threshold: trials.threshold() }
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
    for (cell, (id, (row, class))) in to.iter().zip(&come) {
        cells.push(*cell, id, class, row)?;
    }
    let GraphChanges { put: nodes, remove } = follow(snapshot, heads, &cells, &gone, &come)?;
    let placed = to.into_iter().zip(come).map(|(cell, (id, (row, class)))| (id, (row, class, cell)));
    let mut now: HashMap<String, (Vec<f32>, String, u32)> = placed.collect();
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
        put.remove_nodes(&remove)?;
        put.nodes(nodes.into_iter())?;
        put.n_nodes(n_shapes)?;
        put.header(header)
    })
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
            self.transaction.delete_table(GRAPH)?;
            self.transaction.delete_table(CELLS).map(drop)
        })
    }

    /// Writes shapes of the graph.
    fn nodes(&self, mut nodes: impl Iterator<Item = (NodeKey, Node)>) -> Result<(), IndexError> {
        /// Shapes written between two looks at the table.
        const BATCH: usize = 1024;
        loop {
            let mut batch = Vec::with_capacity(BATCH);
            for (key, node) in nodes.by_ref().take(BATCH) {
                let bytes = encode(&node).map_err(|source| IndexError::Codec { id: node.id, source })?;
                batch.push((key, bytes));
            }
            if batch.is_empty() {
                return Ok(());
            }
            self.store.call(|| {
                let mut table = Guarded::new(self.transaction.open_table(GRAPH)?);
                for (key, bytes) in &batch {
                    table.insert(key, bytes.as_slice())?;
                }
                Ok::<_, redb::Error>(())
            })?;
        }
    }

    fn remove_nodes(&self, keys: &[NodeKey]) -> Result<(), IndexError> {
        self.store.call(|| {
            let mut table = Guarded::new(self.transaction.open_table(GRAPH)?);
            for key in keys {
                table.remove(key)?;
            }
            Ok::<_, redb::Error>(())
        })
    }

    /// States that the graph holds all shapes.
    fn n_nodes(&self, n: usize) -> Result<(), IndexError> {
        self.store.set(self.transaction, N_NODES, &(n as u64))
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
