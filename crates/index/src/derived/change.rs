//! Following changes: shapes leave their cells and enter the nearest ones.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::change_graph::follow;
use super::changed_cells::{Cells, held};
use super::train::header;
use crate::shape::ShapeKey;
use crate::store::{Changes, View};
use crate::tables::{ABOUT, About, CLASSES, ENTRIES, GRAPH, TRIALS};
use crate::vectors::{Part, Trial, nearest_cells};
use crate::{Index, IndexError};

/// What changes in the tables that follow from the shapes, of which there are `n_shapes` now, when those of `base` become
/// those of `view`. `None` if everything is better derived anew.
pub(crate) fn changes(
    view: View<'_>,
    base: &Index,
    n_shapes: usize,
    dim: usize,
) -> Result<Option<Changes>, IndexError> {
    let (before, heads, changed) = (base.view(), base.heads()?, ENTRIES.changed(view));
    let is_little = 2 * changed.len() <= n_shapes.max(64);
    if !is_little || !heads.header.serves(n_shapes, dim) {
        return Ok(None);
    }
    let (mut gone, mut come) = (Part::default(), Part::default());
    let mut classes: BTreeMap<String, i64> = BTreeMap::new();
    for (id, _) in changed {
        let (was, now) = (held(before, &id, dim)?, held(view, &id, dim)?);
        if was == now {
            continue;
        }
        for (held, shapes, change) in [(was, &mut gone, -1), (now, &mut come, 1)] {
            let Some((row, class)) = held else { continue };
            shapes.push(&id, &class, &row);
            *classes.entry(class).or_default() += change;
        }
    }
    classes.remove("");
    if heads.header.n + come.ids.len() != n_shapes + gone.ids.len() {
        return Err(before.damaged(format!("its cells do not hold {n_shapes} shapes")));
    }
    let mut cells = Cells::new(before, heads);
    let to = regroup(&mut cells, &gone, &come)?;
    let mut changes = Changes::new();
    for (key, node) in &follow(view, &cells, &gone, &come)? {
        GRAPH.put(&mut changes, key, node.as_ref())?;
    }
    let mut trials = heads.trials(before)?;
    let mut known: HashMap<ShapeKey, Trial> =
        trials.all.iter().map(|trial| (trial.key(), trial.clone())).collect();
    trials.change(&gone.ids, &come, &to, |visit| cells.each(visit))?;
    for trial in &trials.all {
        if known.remove(&trial.key()).as_ref() != Some(trial) {
            TRIALS.put(&mut changes, &trial.key(), Some(trial))?;
        }
    }
    for gone in known.keys() {
        TRIALS.put(&mut changes, gone, None)?;
    }
    for (class, change) in classes.into_iter().filter(|(_, change)| *change != 0) {
        let count = CLASSES.get(before, &class)?.unwrap_or(0).saturating_add_signed(change);
        CLASSES.put(&mut changes, &class, Some(&count).filter(|count| **count > 0))?;
    }
    cells.put(&mut changes)?;
    let header = header(dim, n_shapes, heads.header.n_trained, &heads.centroids, &trials);
    ABOUT.put(&mut changes, "", Some(&About { options: base.options().to_owned(), cells: header }))?;
    Ok(Some(changes))
}

/// Takes shapes out of their cells and puts others into the nearest ones. Returns the cells of these.
fn regroup(cells: &mut Cells<'_>, gone: &Part, come: &Part) -> Result<Vec<u32>, IndexError> {
    let heads = cells.heads;
    let mut names: BTreeMap<u32, HashSet<&str>> = BTreeMap::new();
    for (cell, id) in heads.centroids.assign(gone.rows()).into_iter().zip(gone.ids.iter()) {
        names.entry(cell).or_default().insert(id);
    }
    let mut lost = HashSet::new();
    for (cell, mut names) in names {
        cells.remove(cell, &mut names)?;
        lost.extend(names);
    }
    // Another processor may have rounded the other way between two cells.
    for (id, _, row) in gone.shapes().filter(|(id, ..)| lost.contains(id)) {
        let mut name = HashSet::from([id]);
        for cell in nearest_cells(row, &heads.centroids, heads.header.n_cells) {
            cells.remove(cell.cell, &mut name)?;
            if name.is_empty() {
                break;
            }
        }
        if !name.is_empty() {
            return Err(cells.view.damaged(format!("`{id}` is in no cell")));
        }
    }
    let to = heads.centroids.assign(come.rows());
    for (cell, (id, class, row)) in to.iter().zip(come.shapes()) {
        cells.push(*cell, id, class, row)?;
    }
    Ok(to)
}
