//! Dividing all vectors into new cells, and finding the neighbours of all.

use std::collections::BTreeMap;

use base::Observer;

use super::cells::{all_shapes, rows_in_part};
use crate::IndexError;
use crate::shape::{ShapeKey, shape_key};
use crate::store::{Changes, Floats, Record, View};
use crate::tables::{ABOUT, About, CELLS, CENTROIDS, CLASSES, GRAPH, Node, TRIALS};
use crate::vectors::{CellsHeader, Centroids, Divided, Links, Rows, Trials, divided, n_cells, padded};

use super::Part;

/// Everything that follows from the shapes of an index.
pub(crate) struct Trained {
    /// The shapes, cell after cell.
    shapes: Part,
    n: usize,
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
    let trials = Trials::of(Rows { cells: &cells, ..shapes.in_cell(&0) }, n_cells);
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
    Ok(Trained { shapes, n, starts, centroids, trials, links, keys, about })
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
        let heads = std::iter::once_with(|| self.heads());
        let cells = (0..self.starts.len() - 1).map(|cell| self.cell(cell));
        let trials = std::iter::once_with(|| {
            let mut changes = Changes::new();
            for trial in &self.trials.all {
                TRIALS.put(&mut changes, &trial.key(), Some(trial))?;
            }
            Ok(changes)
        });
        let nodes = self.keys.iter().map(|(key, place)| {
            let node = Node { id: self.shapes.ids.get(*place).to_owned(), links: self.links[*place].clone() };
            let mut changes = Changes::new();
            GRAPH.put(&mut changes, key, Some(&node))?;
            Ok(changes)
        });
        heads.chain(cells).chain(trials).chain(nodes).flat_map(|changes: Result<Changes, _>| {
            let (changes, error) = match changes {
                Ok(changes) => (changes, None),
                Err(error) => (Changes::new(), Some(Err(error))),
            };
            changes.into_iter().map(Ok).chain(error)
        })
    }

    fn heads(&self) -> Result<Changes, IndexError> {
        let mut changes = Changes::new();
        ABOUT.put(&mut changes, "", Some(&self.about))?;
        let mut classes = BTreeMap::new();
        for class in self.shapes.classes.iter().filter(|class| !class.is_empty()) {
            *classes.entry(class).or_insert(0) += 1;
        }
        for (class, count) in &classes {
            CLASSES.put(&mut changes, class, Some(count))?;
        }
        for (i, rows) in self.centroids.rows.chunks(rows_in_part(self.n) * self.n).enumerate() {
            CENTROIDS.put(&mut changes, &[i as u32, 0], Some(&Floats(rows.to_vec())))?;
        }
        Ok(changes)
    }

    fn cell(&self, cell: usize) -> Result<Changes, IndexError> {
        let mut changes = Changes::new();
        let rows: Vec<usize> = (self.starts[cell]..self.starts[cell + 1]).collect();
        for (i, of_part) in rows.chunks(rows_in_part(self.n)).enumerate() {
            let mut part = Part::default();
            for row in of_part {
                let vector = &self.shapes.rows()[row * self.n..][..self.n];
                part.push(self.shapes.ids.get(*row), self.shapes.classes.get(*row), vector);
            }
            CELLS.put(&mut changes, &[cell as u32, i as u32], Some(&part))?;
        }
        Ok(changes)
    }
}
