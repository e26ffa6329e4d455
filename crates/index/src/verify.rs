//! Integrity check of a whole index.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use crate::derived::all_shapes;
use crate::shape::{ShapeKey, shape_key};
use crate::tables::nodes;
use crate::vectors::{Divided, Links, Part, Reach, Trials};
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

/// Reads every byte, every shape and everything that follows from the shapes, and checks that they agree.
///
/// # Errors
/// As [`Index::open`], if the file is not an index.
pub fn verify(path: &Path) -> Result<Verification, IndexError> {
    let index = Index::open(path)?;
    let mut found = Verification { n_shapes: 0, n_bytes: index.n_bytes(), faults: Vec::new() };
    if let Err(error) = index.stored.check() {
        found.faults.push(error.to_string());
        return Ok(found);
    }
    let shapes = check_shapes(&index, &mut found.n_shapes);
    let derived = all_shapes(index.view()).and_then(|(shapes, dim)| {
        let cells = check_cells(&index, &shapes, dim)?;
        found.faults.extend(cells);
        check_graph(&index, &shapes)
    });
    found.faults.extend([shapes, derived].into_iter().filter_map(|result| Some(result.err()?.to_string())));
    Ok(found)
}

/// Reads all shapes and checks that classes are counted.
fn check_shapes(index: &Index, n_shapes: &mut usize) -> Result<(), IndexError> {
    let mut classes = BTreeMap::new();
    index.each(|shape: Shape| {
        *n_shapes += 1;
        if !shape.entry.label.is_empty() {
            *classes.entry(shape.entry.label).or_insert(0) += 1;
        }
        Ok::<(), IndexError>(())
    })?;
    match index.classes()? == classes {
        true => Ok(()),
        false => Err(index.view().damaged("its classes are counted wrong")),
    }
}

/// Compares the cells with the shapes. Returns the differences.
fn check_cells(index: &Index, shapes: &Part, dim: usize) -> Result<Vec<String>, IndexError> {
    let (heads, view) = (index.heads()?, index.view());
    let mut faults = Vec::new();
    let mut cells = vec![u32::MAX; shapes.ids.len()];
    if shapes.ids.len() > 0 && heads.header.dim != dim {
        return Err(view.damaged(format!("its cells hold vectors of {} numbers", heads.header.dim)));
    }
    let numbered = shapes.shapes().zip(0..);
    let mut missing: BTreeMap<&str, (usize, &str, &[f32])> =
        numbered.map(|((id, class, row), place)| (id, (place, class, row))).collect();
    for cell in 0..heads.header.n_cells as u32 {
        for part in heads.parts(view, cell) {
            for (id, class, row) in part?.1.shapes() {
                match missing.remove(id) {
                    Some((place, known, of)) if (known, of) == (class, row) => cells[place] = cell,
                    _ => faults.push(format!("`{id}` in cell {cell} is not a shape")),
                }
            }
        }
    }
    faults.extend(missing.keys().map(|id| format!("`{id}` is in no cell")));
    if faults.is_empty() {
        let fresh = Trials::of(shapes, &cells, heads.header.n_cells);
        if heads.header.n != shapes.ids.len() || !heads.trials(view)?.agree(&fresh) {
            faults.push("its trials are not those of its shapes".to_owned());
        }
    }
    Ok(faults)
}

/// Shapes whose neighbours are found again: those whose keys come first.
const CHECKED: usize = 512;

/// Checks that the graph holds all shapes and no others. If searches are exact, finds the neighbours of some shapes again.
fn check_graph(index: &Index, shapes: &Part) -> Result<(), IndexError> {
    let view = index.view();
    let keys: Vec<ShapeKey> = shapes.ids.iter().map(shape_key).collect();
    let mut places: HashMap<ShapeKey, usize> = keys.iter().copied().zip(0..).collect();
    let mut first: Vec<(usize, Links)> = Vec::new();
    for row in nodes(view) {
        let (key, node) = row?;
        let place = places.remove(&key).filter(|place| shapes.ids.get(*place) == node.id);
        let place =
            place.ok_or_else(|| view.damaged(format!("`{}` is in its graph but is not a shape", node.id)))?;
        if first.len() < CHECKED {
            first.push((place, node.links));
        }
    }
    if let Some(missing) = places.values().min() {
        return Err(view.damaged(format!("`{}` is not in its graph", shapes.ids.get(*missing))));
    }
    let (heads, starts) = (index.heads()?, [0, keys.len()]);
    if !heads.header.is_exact() {
        return Ok(());
    }
    let centroids = &heads.centroids;
    let all = Divided { rows: shapes.rows(), starts: &starts, centroids, reach: Reach::ALL };
    match first.iter().find(|(place, links)| !links.agrees(&all.links_of(&keys, *place))) {
        None => Ok(()),
        Some((place, _)) => {
            let id = shapes.ids.get(*place);
            Err(view.damaged(format!("the neighbours of `{id}` are not the nearest")))
        }
    }
}
