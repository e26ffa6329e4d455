//! Cells after shapes have come and gone, before they are written.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use super::cells::{Heads, rows_in_part};
use crate::IndexError;
use crate::floats::Floats;
use crate::store::{Changes, View};
use crate::tables::{CELLS, ENTRIES, FUSED};
use crate::vectors::{Part, Visit, padded};

/// A shape as cells hold it: its padded vector and its class.
pub(super) fn held(view: View<'_>, id: &str, dim: usize) -> Result<Option<(Vec<f32>, String)>, IndexError> {
    let (Some(Floats(mut fused)), Some(entry)) = (FUSED.get(view, id)?, ENTRIES.get(view, id)?) else {
        return Ok(None);
    };
    if fused.len() != dim {
        return Err(view.damaged(format!("the vector of `{id}` has {} numbers", fused.len())));
    }
    fused.resize(padded(dim), 0.0);
    Ok(Some((fused, entry.label)))
}

/// Cells that are changed, over those that are stored.
pub(super) struct Cells<'a> {
    pub(super) view: View<'a>,
    pub(super) heads: &'a Heads,
    loaded: BTreeMap<u32, Loaded>,
}

/// The parts of a cell by their numbers, and those that have changed.
#[derive(Default)]
struct Loaded {
    parts: BTreeMap<u32, Part>,
    changed: BTreeSet<u32>,
}

impl<'a> Cells<'a> {
    pub(super) fn new(view: View<'a>, heads: &'a Heads) -> Self {
        Self { view, heads, loaded: BTreeMap::new() }
    }

    fn load(&mut self, cell: u32) -> Result<&mut Loaded, IndexError> {
        if !self.loaded.contains_key(&cell) {
            let parts = self.heads.parts(self.view, cell).collect::<Result<_, _>>()?;
            self.loaded.insert(cell, Loaded { parts, changed: BTreeSet::new() });
        }
        Ok(self.loaded.entry(cell).or_default())
    }

    /// Removes the shapes of these names, and the names of those that were there.
    pub(super) fn remove(&mut self, cell: u32, names: &mut HashSet<&str>) -> Result<(), IndexError> {
        let Loaded { parts, changed } = self.load(cell)?;
        for (i, part) in parts {
            if !part.ids.iter().any(|id| names.contains(id)) {
                continue;
            }
            let mut rest = Part::default();
            for (id, class, row) in part.shapes() {
                if !names.remove(id) {
                    rest.push(id, class, row);
                }
            }
            *part = rest;
            changed.insert(*i);
        }
        Ok(())
    }

    pub(super) fn push(&mut self, cell: u32, id: &str, class: &str, row: &[f32]) -> Result<(), IndexError> {
        let full = rows_in_part(row.len());
        let Loaded { parts, changed } = self.load(cell)?;
        let last = match parts.last_key_value() {
            Some((i, part)) if part.ids.len() < full => *i,
            Some((i, _)) => i + 1,
            None => 0,
        };
        parts.entry(last).or_default().push(id, class, row);
        changed.insert(last);
        Ok(())
    }

    /// Visits all shapes as they are after the changes.
    pub(super) fn each(&self, visit: &mut Visit<'_>) -> Result<(), IndexError> {
        (0..self.heads.header.n_cells as u32).try_for_each(|cell| self.each_of(cell, visit))
    }

    /// Visits the shapes of a cell as they are after the changes.
    pub(super) fn each_of(&self, cell: u32, visit: &mut Visit<'_>) -> Result<(), IndexError> {
        match self.loaded.get(&cell) {
            Some(loaded) => loaded.parts.values().for_each(|part| visit(part, &[cell])),
            None => {
                for part in self.heads.parts(self.view, cell) {
                    visit(&part?.1, &[cell]);
                }
            }
        }
        Ok(())
    }

    /// What has changed.
    pub(super) fn put(&self, changes: &mut Changes) -> Result<(), IndexError> {
        for (cell, loaded) in &self.loaded {
            for i in &loaded.changed {
                let part = loaded.parts.get(i).filter(|part| part.ids.len() > 0);
                CELLS.put(changes, &[*cell, *i], part)?;
            }
        }
        Ok(())
    }
}
