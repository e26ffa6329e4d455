//! Brings the graph of nearest neighbours up to date with shapes that come and go.
//!
//! A shape that comes is searched for, and enters the lists of the shapes that it is near to. The lists that name a shape
//! that goes are made again by searches. In an index of one cell, whose searches are exact, all lists are compared with
//! the changes, so the graph is that of a new start. In a larger index those of the shapes nearest to a change are; others
//! may miss a shape that came, or still name one that is gone, which is then skipped.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::OnceLock;

use rayon::prelude::*;
use retrieval::LINKS;

use super::changed_cells::{Cells, held};
use crate::IndexError;
use crate::shape::{ShapeKey, shape_key};
use crate::store::View;
use crate::tables::{Node, node, nodes};
use crate::vectors::{Link, Links, Part, scan, search_cells, sq_distances_into};

/// Shapes near a change whose lists are looked at, if searches are not exact.
const AROUND: usize = 128;

/// The changes of the graph that follow from shapes that are `gone` from, or have `come` into, the cells: `None` for a shape
/// that is gone.
pub(super) fn follow(
    view: View<'_>,
    cells: &Cells<'_>,
    gone: &Part,
    come: &Part,
) -> Result<BTreeMap<ShapeKey, Option<Node>>, IndexError> {
    let (mut before, mut now) = (by_key(gone), by_key(come));
    // A change of the class moves nothing.
    let stays = before.iter().filter(|(key, shape)| now.get(key) == Some(shape));
    for key in stays.map(|(key, _)| *key).collect::<Vec<_>>() {
        before.remove(&key);
        now.remove(&key);
    }
    let field = Field::new(cells);
    let near = |(key, (_, row)): (&ShapeKey, &(&str, &[f32]))| Ok((*key, field.near(row, AROUND)?));
    // The lists that a change may reach, and those that each shape may enter that has come.
    let known: HashMap<ShapeKey, Node>;
    let mut entered: Vec<(ShapeKey, Vec<Link>)>;
    if cells.heads.header.is_exact() {
        known = nodes(view).collect::<Result<_, _>>()?;
        let bound = |key| known.get(key).map_or(f32::NEG_INFINITY, |node| node.links.bound());
        let bounds: Vec<f32> = field.cell(0)?.keys.iter().map(bound).collect();
        let within = now.par_iter().map(|(key, (_, row))| Ok((*key, field.within(row, &bounds)?)));
        entered = within.collect::<Result<_, IndexError>>()?;
    } else {
        entered = now.par_iter().map(near).collect::<Result<_, IndexError>>()?;
        let left = before.par_iter().map(near).collect::<Result<Vec<_>, IndexError>>()?;
        let around = entered.iter().chain(&left).flat_map(|(_, links)| links);
        let around: HashSet<ShapeKey> = around.map(|link| link.key).collect();
        let nodes = around.into_iter().filter_map(|key| Some(node(view, key).transpose()?.map(|n| (key, n))));
        known = nodes.collect::<Result<_, _>>()?;
    }
    // Made again: the lists that name a shape that is gone, and those of shapes that have come.
    let mut again = Vec::new();
    for (key, node) in &known {
        let is_stale = node.links.0.iter().any(|link| before.contains_key(&link.key));
        if is_stale && !before.contains_key(key) && !now.contains_key(key) {
            let held = held(view, &node.id, cells.heads.header.dim)?;
            let missing = || view.damaged(format!("`{}` is in its graph but has no vector", node.id));
            again.push((*key, node.id.as_str(), held.ok_or_else(missing)?.0));
        }
    }
    again.extend(now.iter().map(|(key, (id, row))| (*key, *id, row.to_vec())));
    let made = again.par_iter().map(|(key, id, row)| {
        let links = Links::of(*key, field.near(row, LINKS + 1)?.into_iter());
        Ok((*key, Node { id: (*id).to_owned(), links }))
    });
    let mut lists: BTreeMap<ShapeKey, Node> = made.collect::<Result<_, IndexError>>()?;
    entered.sort_unstable_by_key(|(key, _)| *key);
    for (key, found) in entered {
        for Link { sq, key: other } in found {
            // Lists that were made again hold it already.
            if other == key || now.contains_key(&other) {
                continue;
            }
            if !lists.contains_key(&other) {
                let wider = known.get(&other).filter(|node| sq <= node.links.bound());
                lists.extend(wider.map(|node| (other, node.clone())));
            }
            if let Some(node) = lists.get_mut(&other) {
                node.links.offer(Link { sq, key });
            }
        }
    }
    let gone = before.into_keys().filter(|key| !now.contains_key(key)).map(|key| (key, None));
    Ok(lists.into_iter().map(|(key, node)| (key, Some(node))).chain(gone).collect())
}

/// Names and vectors of shapes.
fn by_key(shapes: &Part) -> HashMap<ShapeKey, (&str, &[f32])> {
    shapes.shapes().map(|(id, _, row)| (shape_key(id), (id, row))).collect()
}

/// The shapes of cells after the changes, read when they are needed.
struct Field<'a> {
    cells: &'a Cells<'a>,
    loaded: Vec<OnceLock<Loaded>>,
}

/// The shapes of a cell.
struct Loaded {
    rows: Vec<f32>,
    keys: Vec<ShapeKey>,
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
        self.cells.each_of(cell, &mut |shapes, _| {
            rows.extend_from_slice(shapes.rows());
            keys.extend(shapes.ids.iter().map(shape_key));
        })?;
        Ok(place.get_or_init(|| Loaded { rows, keys }))
    }

    /// The nearest shapes, as a search finds them, in any order.
    fn near(&self, row: &[f32], k: usize) -> Result<Vec<Link>, IndexError> {
        let (heads, mut keys) = (self.cells.heads, Vec::new());
        let nearest = search_cells(row, &heads.centroids, heads.header.reach, k, |cell, nearest| {
            let loaded = self.cell(cell)?;
            scan(row, keys.len() as u32, &loaded.rows, nearest);
            keys.extend_from_slice(&loaded.keys);
            Ok::<_, IndexError>(())
        })?;
        Ok(nearest.into_hits().map(|hit| Link { sq: hit.sq, key: keys[hit.slot as usize] }).collect())
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
