//! Brings the graph of nearest neighbours up to date with shapes that come and go.
//!
//! A shape that comes is searched for, and enters the lists of the shapes that it is near to. The lists that name a shape
//! that goes are made again by searches. In an index of one cell, whose searches are exact, all lists are compared with
//! the changes, so the graph is that of a new start. In a larger index those of the shapes nearest to a change are; others
//! may miss a shape that came, or still name one that is gone, which is then skipped.

use std::collections::btree_map::{BTreeMap, Entry};
use std::collections::{HashMap, HashSet};
use std::sync::OnceLock;

use rayon::prelude::*;
use retrieval::LINKS;

use super::changed_cells::{Cells, Held, held};
use crate::IndexError;
use crate::store::View;
use crate::tables::{Node, node, nodes};
use crate::vectors::{Link, Links, Nearest, NodeKey, nearest_cells, node_key, sq_distances_into};

/// Shapes near a change whose lists are looked at, if searches are not exact.
const AROUND: usize = 128;

/// The lists that change: `None` for a shape that is gone.
type Lists = BTreeMap<NodeKey, Option<Node>>;

/// The changes of the graph that follow from shapes that are `gone` from, or have `come` into, the cells.
pub(super) fn follow(
    view: View<'_>,
    cells: &Cells<'_>,
    gone: &[(String, Held)],
    come: &[(String, Held)],
) -> Result<Lists, IndexError> {
    // A change of the class moves nothing.
    let rows = |shapes: &[(String, Held)]| -> HashMap<NodeKey, (String, Vec<f32>)> {
        shapes.iter().map(|(id, (row, _))| (node_key(id), (id.clone(), row.clone()))).collect()
    };
    let (mut before, mut now) = (rows(gone), rows(come));
    let stays: Vec<NodeKey> =
        before.iter().filter(|(key, shape)| now.get(key) == Some(shape)).map(|(key, _)| *key).collect();
    for key in stays {
        before.remove(&key);
        now.remove(&key);
    }
    let field = Field::new(cells);
    let is_exact = cells.heads.header.is_exact();
    let known: HashMap<NodeKey, Node> =
        if is_exact { nodes(view).collect::<Result<_, _>>()? } else { HashMap::new() };
    // Lists that name a shape that is gone.
    let mut stale: Vec<NodeKey> = if is_exact {
        known.keys().copied().collect()
    } else {
        let around = before.par_iter().map(|(_, (_, row))| field.near(row, AROUND));
        let around = around.collect::<Result<Vec<_>, _>>()?;
        around.into_iter().flatten().map(|link| link.key).collect::<HashSet<_>>().into_iter().collect()
    };
    stale.retain(|key| !before.contains_key(key) && !now.contains_key(key));
    let mut again = Vec::new();
    for key in stale {
        let node = if is_exact { known.get(&key).cloned() } else { node(view, key)? };
        let Some(node) = node else { continue };
        if node.links.0.iter().any(|link| before.contains_key(&link.key)) {
            let held = held(view, &node.id, cells.heads.header.dim)?;
            let missing = || view.damaged(format!("`{}` is in its graph but has no vector", node.id));
            again.push((key, node.id.clone(), held.ok_or_else(missing)?.0));
        }
    }
    again.extend(now.iter().map(|(key, (id, row))| (*key, id.clone(), row.clone())));
    let made = again.par_iter().map(|(key, id, row)| {
        let links = Links::of(*key, field.near(row, LINKS + 1)?.into_iter());
        Ok((*key, Node { id: id.clone(), links }))
    });
    let mut lists: BTreeMap<NodeKey, Node> = made.collect::<Result<_, IndexError>>()?;
    // Lists that a shape enters that has come.
    let bound = |key: &NodeKey| match known.get(key) {
        Some(node) if !lists.contains_key(key) => node.links.bound(),
        _ => f32::NEG_INFINITY,
    };
    let bounds = if is_exact { Some(field.bounds(&bound)?) } else { None };
    let entered = now.par_iter().map(|(key, (_, row))| {
        let found = match &bounds {
            Some(bounds) => field.within(row, bounds)?,
            None => field.near(row, AROUND)?,
        };
        Ok((*key, found))
    });
    let mut entered = entered.collect::<Result<Vec<(NodeKey, Vec<Link>)>, IndexError>>()?;
    entered.sort_unstable_by_key(|(key, _)| *key);
    for (key, found) in entered {
        for Link { sq, key: other } in found {
            // Lists that were made again hold it already.
            if other == key || now.contains_key(&other) {
                continue;
            }
            let node = match lists.entry(other) {
                Entry::Occupied(place) => place.into_mut(),
                Entry::Vacant(place) => {
                    let node = if is_exact { known.get(&other).cloned() } else { node(view, other)? };
                    match node {
                        Some(node) if sq <= node.links.bound() => place.insert(node),
                        _ => continue,
                    }
                }
            };
            node.links.offer(Link { sq, key });
        }
    }
    let gone = before.into_keys().filter(|key| !now.contains_key(key)).map(|key| (key, None));
    Ok(lists.into_iter().map(|(key, node)| (key, Some(node))).chain(gone).collect())
}

/// The shapes of cells after the changes, read when they are needed.
struct Field<'a> {
    cells: &'a Cells<'a>,
    loaded: Vec<OnceLock<Loaded>>,
}

/// The shapes of a cell.
struct Loaded {
    rows: Vec<f32>,
    keys: Vec<NodeKey>,
}

impl<'a> Field<'a> {
    fn new(cells: &'a Cells<'a>) -> Self {
        let loaded = (0..cells.heads.header.n_cells).map(|_| OnceLock::new()).collect();
        Self { cells, loaded }
    }

    fn cell(&self, cell: u32) -> Result<&Loaded, IndexError> {
        let place = &self.loaded[cell as usize];
        if let Some(loaded) = place.get() {
            return Ok(loaded);
        }
        let (mut rows, mut keys) = (Vec::new(), Vec::new());
        self.cells.each_of(cell, &mut |shapes| {
            rows.extend_from_slice(shapes.rows);
            keys.extend(shapes.ids.iter().map(node_key));
        })?;
        Ok(place.get_or_init(|| Loaded { rows, keys }))
    }

    /// The nearest shapes, as a search finds them, in any order.
    fn near(&self, row: &[f32], k: usize) -> Result<Vec<Link>, IndexError> {
        let reach = self.cells.heads.header.reach;
        let (mut nearest, mut keys) = (Nearest::new(k), Vec::new());
        for cell in nearest_cells(row, &self.cells.heads.centroids, reach.probes) {
            if reach.includes(&cell, nearest.bound()) {
                let loaded = self.cell(cell.cell)?;
                crate::vectors::scan(row, keys.len() as u32, &loaded.rows, &mut nearest);
                keys.extend_from_slice(&loaded.keys);
            }
        }
        Ok(nearest.into_hits().map(|hit| Link { sq: hit.sq, key: keys[hit.slot as usize] }).collect())
    }

    /// The bound of every shape of the only cell.
    fn bounds(&self, bound: &dyn Fn(&NodeKey) -> f32) -> Result<Vec<f32>, IndexError> {
        Ok(self.cell(0)?.keys.iter().map(bound).collect())
    }

    /// The shapes of the only cell within their bounds.
    fn within(&self, row: &[f32], bounds: &[f32]) -> Result<Vec<Link>, IndexError> {
        let loaded = self.cell(0)?;
        let mut sqs = vec![0.0; loaded.keys.len()];
        sq_distances_into(row, &loaded.rows, &mut sqs);
        let all = sqs.into_iter().zip(bounds).zip(&loaded.keys);
        Ok(all.filter(|((sq, bound), _)| sq <= bound).map(|((sq, _), key)| Link { sq, key: *key }).collect())
    }
}
