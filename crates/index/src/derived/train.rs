//! Dividing all vectors into new cells, and finding the neighbours of all.

use std::collections::BTreeMap;

use base::Observer;

use super::cells::{all_shapes, rows_in_part};
use crate::IndexError;
use crate::floats::Floats;
use crate::shape::{ShapeKey, shape_key};
use crate::store::{Record, View};
use crate::tables::{ABOUT, About, CELLS, CENTROIDS, CLASSES, GRAPH, Node, TRIALS};
use crate::vectors::{CellsHeader, Centroids, Divided, Links, Part, Trials, divided, n_cells, padded};

/// Everything that follows from the shapes of an index.
pub(crate) struct Trained {
    /// The shapes, cell after cell.
    shapes: Part,
    starts: Vec<usize>,
    centroids: Centroids,
    trials: Trials,
    links: Vec<Links>,
    /// The keys of shapes in ascending order, and their places.
    keys: Vec<(ShapeKey, usize)>,
    about: About,
}

/// Derives everything anew from the shapes.
pub(crate) fn trained(view: View<'_>, options: &str, observer: &dyn Observer) -> Result<Trained, IndexError> {
    let (mut shapes, dim) = all_shapes(view)?;
    let (n_rows, n) = (shapes.ids.len(), padded(dim));
    let (centroids, mut cells) = divided(shapes.rows(), n, n_cells(n_rows));
    let n_cells = centroids.rows.len() / n;
    let mut order: Vec<usize> = (0..n_rows).collect();
    order.sort_by_key(|i| cells[*i]);
    shapes.sort(&order, n);
    cells.sort_unstable();
    let trials = Trials::of(&shapes, &cells, n_cells);
    let header = header(dim, n_rows, n_rows, &centroids, &trials);
    let keys: Vec<ShapeKey> = shapes.ids.iter().map(shape_key).collect();
    let starts: Vec<usize> =
        (0..=n_cells as u32).map(|cell| cells.partition_point(|other| *other < cell)).collect();
    let all = Divided { rows: shapes.rows(), starts: &starts, centroids: &centroids, reach: header.reach };
    observer.begin("linking neighbours", n_rows);
    let links = all.links(&keys, observer);
    let mut keys: Vec<(ShapeKey, usize)> = keys.into_iter().zip(0..).collect();
    keys.sort_unstable();
    let about = About { options: options.to_owned(), cells: header };
    Ok(Trained { shapes, starts, centroids, trials, links, keys, about })
}

/// What is known about cells that hold `n` vectors.
pub(super) fn header(
    dim: usize,
    n: usize,
    n_trained: usize,
    centroids: &Centroids,
    trials: &Trials,
) -> CellsHeader {
    let (reach, recall) = trials.calibrated(centroids);
    let n_cells = centroids.rows.len() / padded(dim);
    CellsHeader { dim, n, n_cells, n_trained, reach, recall, threshold: trials.threshold() }
}

impl Trained {
    /// All of it, in ascending order of keys. Cells and lists are encoded as they are asked for.
    pub(crate) fn records(&self) -> impl Iterator<Item = Result<Record, IndexError>> + '_ {
        let Self { shapes, starts, centroids, trials, links, keys, about } = self;
        let n_rows = rows_in_part(centroids.n);
        let about = std::iter::once_with(|| ABOUT.record("", Some(about)));
        let mut classes: BTreeMap<&str, u64> = BTreeMap::new();
        for class in shapes.classes.iter().filter(|class| !class.is_empty()) {
            *classes.entry(class).or_insert(0) += 1;
        }
        let classes = classes.into_iter().map(|(class, count)| CLASSES.record(class, Some(&count)));
        let centres = centroids.rows.chunks(n_rows * centroids.n).zip(0..);
        let centres = centres.map(|(rows, i)| CENTROIDS.record(&[i, 0], Some(&Floats(rows.to_vec()))));
        let cells = starts.windows(2).zip(0..).flat_map(move |(ends, cell)| {
            let parts = (ends[0]..ends[1]).step_by(n_rows).zip(0..);
            parts.map(move |(first, i)| {
                let part = shapes.slice(first..(first + n_rows).min(ends[1]));
                CELLS.record(&[cell, i], Some(&part))
            })
        });
        let trials = trials.all.iter().map(|trial| TRIALS.record(&trial.key(), Some(trial)));
        let nodes = keys.iter().map(|(key, place)| {
            let node = Node { id: shapes.ids.get(*place).to_owned(), links: links[*place].clone() };
            GRAPH.record(key, Some(&node))
        });
        about.chain(classes).chain(centres).chain(cells).chain(trials).chain(nodes)
    }
}
