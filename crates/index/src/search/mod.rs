//! Search for the nearest vectors, in the file or in memory, and on the graph of nearest neighbours.

mod graph;
mod searcher;

use crate::derived::all_shapes;
use crate::tables::FUSED;
use crate::texts::Texts;
use crate::vectors::{CellsHeader, NEIGHBORS, Reach, Trials, padded, scan, search_cells};
use crate::{Index, IndexError};
use retrieval::UnknownThreshold;

pub use graph::{FoundOnGraph, RankedShape};
pub use searcher::Searcher;

/// How thoroughly to search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SearchMode {
    /// Exactly in small indexes; in large ones, in as many cells as are needed to find nearly all neighbours.
    #[default]
    Auto,
    /// Among all shapes.
    Exact,
}

impl SearchMode {
    /// Which cells to scan.
    fn reach(self, header: &CellsHeader) -> Reach {
        match self {
            Self::Auto => header.reach,
            Self::Exact => Reach::ALL,
        }
    }
}

/// A shape found by a search.
#[derive(Debug, Clone, PartialEq)]
pub struct NearShape {
    /// Its name.
    pub id: String,
    /// Euclidean distance of its vector from the query.
    pub distance: f64,
}

/// The result of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Nearest first; ties by name.
    pub shapes: Vec<NearShape>,
    /// Number of shapes that were measured.
    pub n_measured: usize,
    /// Number of shapes in the index.
    pub n_shapes: usize,
    /// Expected share of the ten nearest that such a search finds, calibrated when the index was finished; 1 for an
    /// exact search.
    pub recall: f64,
    /// A query whose nearest shape is farther belongs to no class of the index; `None` if the classes are too small to
    /// tell.
    pub threshold: Option<UnknownThreshold>,
}

impl Found {
    /// Takes the `k` nearest and what is as near as the last of them.
    fn new(
        mut shapes: Vec<NearShape>,
        k: usize,
        n_measured: usize,
        header: &CellsHeader,
        mode: SearchMode,
    ) -> Self {
        // Selected in single precision, sorted in double.
        shapes.sort_by(|a, b| a.distance.total_cmp(&b.distance).then_with(|| a.id.cmp(&b.id)));
        shapes.truncate(k);
        let is_exact = mode == SearchMode::Exact || header.is_exact();
        Self {
            shapes,
            n_measured,
            n_shapes: header.n,
            recall: if is_exact { 1.0 } else { header.recall },
            threshold: header.threshold,
        }
    }
}

impl Index {
    /// The `k` shapes whose vectors are nearest to `query`. Reads the cells it needs from the file.
    ///
    /// # Errors
    /// [`IndexError::OtherLength`], [`IndexError::BadVector`], [`IndexError::Io`], [`IndexError::Damaged`].
    pub fn nearest(&self, query: &[f32], k: usize, mode: SearchMode) -> Result<Found, IndexError> {
        let (heads, view) = (self.heads()?, self.view());
        let row = padded_query(query, &heads.header)?;
        let (mut ids, reach) = (Texts::default(), mode.reach(&heads.header));
        let nearest = search_cells(&row, &heads.centroids, reach, k.max(NEIGHBORS), |cell, nearest| {
            for part in heads.parts(view, cell) {
                let (_, part) = part?;
                scan(&row, ids.len() as u32, part.rows(), nearest);
                ids.extend(&part.ids);
            }
            Ok::<_, IndexError>(())
        })?;
        let mut shapes = Vec::with_capacity(k.min(self.len()));
        for hit in nearest.into_hits() {
            let id = ids.get(hit.slot as usize);
            let vector = FUSED.get(view, id)?.ok_or_else(|| view.damaged(format!("`{id}` has no vector")))?;
            shapes.push(NearShape { distance: distance(query, &vector.0), id: id.to_owned() });
        }
        Ok(Found::new(shapes, k, ids.len(), &heads.header, mode))
    }
}

/// Euclidean distance, summed in double precision in the order of the numbers.
fn distance(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (f64::from(*x) - f64::from(*y)).powi(2)).sum::<f64>().sqrt()
}

/// Checks a query and pads it.
fn padded_query(query: &[f32], header: &CellsHeader) -> Result<Vec<f32>, IndexError> {
    if header.n > 0 && query.len() != header.dim {
        let (found, expected) = (query.len(), header.dim);
        return Err(IndexError::OtherLength { id: "the query".to_owned(), found, expected });
    }
    if !query.iter().all(|x| x.is_finite()) {
        return Err(IndexError::BadVector("the query".to_owned()));
    }
    let mut row = query.to_vec();
    row.resize(padded(header.dim), 0.0);
    Ok(row)
}

/// The [threshold](Found::threshold) of the index that would hold the shapes of all of these, which have different names
/// and were described with the same options. Holds the vectors of one index at a time in memory.
///
/// # Errors
/// [`IndexError::Io`], [`IndexError::Damaged`].
pub fn class_threshold(indexes: &[Index]) -> Result<Option<UnknownThreshold>, IndexError> {
    let trials = Trials::in_pieces(1, |visit| {
        for index in indexes {
            let (shapes, _) = all_shapes(index.view())?;
            if shapes.ids.len() > 0 {
                visit(&shapes, &[0]);
            }
        }
        Ok::<_, IndexError>(())
    })?;
    Ok(trials.threshold())
}
