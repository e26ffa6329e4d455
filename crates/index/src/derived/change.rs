//! Following changes: shapes leave their cells and enter the nearest ones.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use super::change_graph::follow;
use super::changed_cells::{Cells, Held, held};
use super::train::header;
use crate::store::{Changes, View};
use crate::tables::{ABOUT, About, BODIES, CLASSES, ENTRIES, FUSED, GRAPH, TRIALS};
use crate::vectors::{Change, Trial, TrialKey, nearest_cells};
use crate::{Index, IndexError};

/// What changes in the tables that follow from the shapes, of which there are `n_shapes` now, when those of `base` become
/// those of `view`. `None` if everything is better derived anew.
pub(crate) fn changes(
    view: View<'_>,
    base: &Index,
    n_shapes: usize,
    dim: usize,
) -> Result<Option<Changes>, IndexError> {
    let keys = view.changed(&ENTRIES).into_iter().chain(view.changed(&FUSED)).chain(view.changed(&BODIES));
    let changed: BTreeSet<String> = keys.map(|(id, _)| id).collect();
    let is_little = 2 * changed.len() <= n_shapes.max(64);
    let heads = base.heads()?;
    if !is_little || !heads.header.serves(n_shapes, dim) {
        return Ok(None);
    }
    let before = base.view();
    let (mut gone, mut come) = (Vec::new(), Vec::new());
    let mut shapes = Vec::new();
    let mut classes: BTreeMap<String, i64> = BTreeMap::new();
    for id in changed {
        let (was, now) = (held(before, &id, dim)?, held(view, &id, dim)?);
        if was == now {
            continue;
        }
        for (held, change) in [(&was, -1), (&now, 1)] {
            if let Some((_, class)) = held.as_ref().filter(|(_, class)| !class.is_empty()) {
                *classes.entry(class.clone()).or_default() += change;
            }
        }
        shapes.push(Change { id: id.clone(), was_there: was.is_some(), now: None });
        gone.extend(was.map(|held| (id.clone(), held)));
        come.extend(now.map(|held| (id, held)));
    }
    if heads.header.n + come.len() != n_shapes + gone.len() {
        return Err(before.damaged(format!("its cells do not hold {n_shapes} shapes")));
    }
    let mut cells = Cells::new(before, heads);
    let to = regroup(&mut cells, &gone, &come)?;
    let mut changes = Changes::new();
    let graph = follow(view, &cells, &gone, &come)?;
    for (key, node) in &graph {
        GRAPH.put(&mut changes, key, node.as_ref())?;
    }
    let placed = to.into_iter().zip(come).map(|(cell, (id, (row, class)))| (id, (row, class, cell)));
    let mut now: HashMap<String, (Vec<f32>, String, u32)> = placed.collect();
    shapes.iter_mut().for_each(|change| change.now = now.remove(&change.id));
    let mut trials = heads.trials(before)?;
    let known: HashMap<TrialKey, Trial> =
        trials.all.iter().map(|trial| (trial.key(), trial.clone())).collect();
    trials.change(&shapes, |visit| cells.each(visit))?;
    let present: HashSet<TrialKey> = trials.all.iter().map(Trial::key).collect();
    for gone in known.keys().filter(|gone| !present.contains(*gone)) {
        TRIALS.put(&mut changes, gone, None)?;
    }
    for trial in trials.all.iter().filter(|trial| known.get(&trial.key()) != Some(trial)) {
        TRIALS.put(&mut changes, &trial.key(), Some(trial))?;
    }
    for (class, change) in classes.into_iter().filter(|(_, change)| *change != 0) {
        let count = before.get(&CLASSES, &class)?.unwrap_or(0).saturating_add_signed(change);
        CLASSES.put(&mut changes, &class, Some(&count).filter(|count| **count > 0))?;
    }
    cells.put(&mut changes)?;
    let header = header(dim, n_shapes, heads.header.n_trained, &heads.centroids, &trials);
    ABOUT.put(&mut changes, "", Some(&About { options: base.options().to_owned(), cells: header }))?;
    Ok(Some(changes))
}

/// Takes shapes out of their cells and puts others into the nearest ones. Returns the cells of these.
fn regroup(
    cells: &mut Cells<'_>,
    gone: &[(String, Held)],
    come: &[(String, Held)],
) -> Result<Vec<u32>, IndexError> {
    let heads = cells.heads;
    let nearest = |shapes: &[(String, Held)]| {
        heads.centroids.assign(&shapes.iter().flat_map(|(_, (row, _))| row).copied().collect::<Vec<_>>())
    };
    let mut names: BTreeMap<u32, HashSet<&str>> = BTreeMap::new();
    for (cell, (id, _)) in nearest(gone).iter().zip(gone) {
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
            return Err(cells.view.damaged(format!("`{id}` is in no cell")));
        }
    }
    let to = nearest(come);
    for (cell, (id, (row, class))) in to.iter().zip(come) {
        cells.push(*cell, id, class, row)?;
    }
    Ok(to)
}
