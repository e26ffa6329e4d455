//! Integrity check of a whole index.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use crate::format::{BODIES, FUSED, Graph, Sealed, all_shapes};
use crate::vectors::{Divided, Links, NodeKey, Reach, Rows, Trials, node_key, padded};
use crate::{Index, IndexError, Shape};

/// The result of [`verify`].
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// Number of shapes read.
    pub n_shapes: usize,
    /// Number of bytes read.
    pub n_bytes: u64,
    /// The defects found; empty if the index is intact.
    pub faults: Vec<String>,
}

/// Reads every byte, every shape and all search data of an index, and checks that they agree.
///
/// Calls `done` after each mebibyte.
///
/// # Errors
/// As [`Index::open`], if the file is not an index.
pub fn verify(path: &Path, done: impl FnMut()) -> Result<Verification, IndexError> {
    let sealed = Sealed::open(path)?;
    let mut found = Verification { n_shapes: 0, n_bytes: sealed.n_bytes(), faults: Vec::new() };
    if let Err(error) = sealed.check(done) {
        found.faults.push(error.to_string());
        return Ok(found);
    }
    let index = Index::of(path, sealed)?;
    let mut n_shapes = 0;
    let read = index.each(|_: Shape| {
        n_shapes += 1;
        Ok(())
    });
    let searched = check_cells(&index).and_then(|faults| match faults.is_empty() {
        true => Ok(()),
        false => Err(IndexError::damaged(path, faults.join("; "))),
    });
    let graph = check_graph(&index);
    for result in [read, check_entries(&index), searched, graph] {
        found.faults.extend(result.err().map(|error| error.to_string()));
    }
    found.n_shapes = n_shapes;
    Ok(found)
}

/// Checks that all vectors belong to an entry, and that classes are counted.
fn check_entries(index: &Index) -> Result<(), IndexError> {
    let store = index.store();
    let snapshot = store.read()?;
    for table in [FUSED, BODIES] {
        for id in snapshot.keys(table)? {
            if snapshot.entry(&id)?.is_none() {
                return Err(IndexError::damaged(index.path(), format!("`{id}` has vectors but no entry")));
            }
        }
    }
    let mut classes = BTreeMap::new();
    for (_, entry) in index.entries()? {
        if !entry.label.is_empty() {
            *classes.entry(entry.label).or_insert(0) += 1;
        }
    }
    match index.classes()? == classes {
        true => Ok(()),
        false => Err(IndexError::damaged(index.path(), "its classes are counted wrong")),
    }
}

/// Compares the cells with the shapes. Returns the differences.
fn check_cells(index: &Index) -> Result<Vec<String>, IndexError> {
    let store = index.store();
    let (shapes, dim) = all_shapes(&store)?;
    let n = padded(dim);
    let (heads, snapshot) = (index.heads()?, store.read()?);
    let places: HashMap<&str, usize> = shapes.ids.iter().zip(0..).collect();
    let mut faults = Vec::new();
    let mut cells = vec![u32::MAX; shapes.ids.len()];
    for cell in 0..heads.header.n_cells as u32 {
        heads.each_part(&snapshot, cell, |part| {
            for (i, (id, class)) in part.ids.iter().zip(part.classes.iter()).enumerate() {
                let place = places.get(id).filter(|place| {
                    let (row, known) = (&part.rows()[i * n..][..n], &shapes.rows()[**place * n..][..n]);
                    cells[**place] == u32::MAX && class == shapes.classes.get(**place) && row == known
                });
                match place {
                    Some(place) => cells[*place] = cell,
                    None => faults.push(format!("`{id}` in cell {cell} is not a shape")),
                }
            }
            Ok(())
        })?;
    }
    let unseen = cells.iter().zip(shapes.ids.iter()).filter(|(cell, _)| **cell == u32::MAX);
    faults.extend(unseen.map(|(_, id)| format!("`{id}` is in no cell")));
    if faults.is_empty() {
        let all = Rows { cells: &cells, ..shapes.in_cell(&0) };
        let fresh = Trials::of(all, heads.header.n_cells);
        if heads.header.n != shapes.ids.len() || !heads.trials(&snapshot)?.agree(&fresh) {
            faults.push("its trials are not those of its shapes".to_owned());
        }
    }
    Ok(faults)
}

/// Shapes whose neighbours are found again: those whose keys come first.
const CHECKED: usize = 512;

/// Checks that the graph holds all shapes and no others. If searches are exact, finds the neighbours of some shapes again.
fn check_graph(index: &Index) -> Result<(), IndexError> {
    let store = index.store();
    let snapshot = store.read()?;
    let Some(graph) = Graph::open(&snapshot)? else { return Ok(()) };
    let damaged = |what: String| IndexError::damaged(index.path(), what);
    let (shapes, dim) = all_shapes(&store)?;
    let n = padded(dim);
    let keys: Vec<NodeKey> = shapes.ids.iter().map(node_key).collect();
    let mut places: HashMap<NodeKey, usize> = keys.iter().copied().zip(0..).collect();
    let mut first: Vec<(usize, Links)> = Vec::new();
    graph.each(|key, node| {
        let place = places.remove(&key).filter(|place| shapes.ids.get(*place) == node.id);
        let place =
            place.ok_or_else(|| damaged(format!("`{}` is in its graph but is not a shape", node.id)))?;
        if first.len() < CHECKED {
            first.push((place, node.links));
        }
        Ok(())
    })?;
    if let Some(missing) = places.values().min() {
        return Err(damaged(format!("`{}` is not in its graph", shapes.ids.get(*missing))));
    }
    let heads = index.heads()?;
    if heads.header.is_exact() {
        let starts = [0, keys.len()];
        let all = Divided {
            rows: shapes.rows(),
            n,
            keys: &keys,
            starts: &starts,
            centroids: &heads.centroids,
            reach: Reach::ALL,
        };
        for (place, links) in first {
            if !links.agrees(&all.links_of(place)) {
                return Err(damaged(format!(
                    "the neighbours of `{}` are not the nearest",
                    shapes.ids.get(place)
                )));
            }
        }
    }
    Ok(())
}
