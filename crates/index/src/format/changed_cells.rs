//! Cells of a database after shapes have come and gone, before they are written.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use super::IndexError;
use super::stored_cells::{Heads, Part, rows_in_part};
use super::tables::Snapshot;
use crate::vectors::{Rows, padded};

/// A shape as cells hold it: its padded vector and its class.
pub(super) type Held = (Vec<f32>, String);

pub(super) fn held(snapshot: &Snapshot<'_>, id: &str, dim: usize) -> Result<Option<Held>, IndexError> {
    let (Some(mut fused), Some(entry)) = (snapshot.fused(id)?, snapshot.entry(id)?) else { return Ok(None) };
    if fused.len() != dim {
        return Err(snapshot.store.damaged(format!("the vector of `{id}` has {} numbers", fused.len())));
    }
    fused.resize(padded(dim), 0.0);
    Ok(Some((fused, entry.label)))
}

/// Cells that are changed, over those that are stored.
pub(super) struct Cells<'a> {
    pub(super) snapshot: &'a Snapshot<'a>,
    pub(super) heads: &'a Heads,
    pub(super) loaded: BTreeMap<u32, Loaded>,
}

/// Parts of a cell by their numbers.
#[derive(Default)]
pub(super) struct Loaded {
    pub(super) parts: BTreeMap<u32, Part>,
    pub(super) dirty: BTreeSet<u32>,
    /// Whether all parts are here, not the last only.
    is_whole: bool,
}

impl Cells<'_> {
    /// Removes the shapes of these names, and the names of those that were there.
    pub(super) fn remove(&mut self, cell: u32, names: &mut HashSet<&str>) -> Result<(), IndexError> {
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

    pub(super) fn push(&mut self, cell: u32, id: &str, class: &str, row: &[f32]) -> Result<(), IndexError> {
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
    pub(super) fn each(&self, visit: &mut dyn FnMut(Rows<'_>)) -> Result<(), IndexError> {
        (0..self.heads.header.n_cells as u32).try_for_each(|cell| self.each_of(cell, visit))
    }

    /// Visits the shapes of a cell as they are after the changes.
    pub(super) fn each_of(&self, cell: u32, visit: &mut dyn FnMut(Rows<'_>)) -> Result<(), IndexError> {
        let none = Loaded::default();
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
        Ok(())
    }
}
