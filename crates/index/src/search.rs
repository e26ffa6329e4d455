//! Search for the nearest vectors, and on the graph of nearest neighbours.

use retrieval::{GraphNeighbor, LINKS, Neighbor, UnknownThreshold, graph_rank};

use crate::derived::{classes, vectors};
use crate::vectors::{VectorTable, distance, threshold};
use crate::{Index, IndexError};

/// A shape found by a search.
#[derive(Debug, Clone, PartialEq)]
pub struct NearShape {
    /// Its name.
    pub id: String,
    /// Euclidean distance of its vector from the query.
    pub distance: f64,
}

/// A shape found on the graph.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedShape {
    /// Its name.
    pub id: String,
    /// Euclidean distance of its vector from the query.
    pub distance: f64,
    /// Its rank distance, in 0..1, by which results are ordered; see [`retrieval::graph_rank`].
    pub rank_distance: f64,
    /// Its rank by distance, counted from 1; `None` if it is found through its neighbours only.
    pub plain_rank: Option<usize>,
}

impl Index {
    /// The `k` shapes whose vectors are nearest to `query`, nearest first; ties by name. All vectors are measured.
    ///
    /// # Errors
    /// [`IndexError::OtherLength`], [`IndexError::BadVector`], [`IndexError::Io`], [`IndexError::Damaged`].
    pub fn nearest(&self, query: &[f32], k: usize) -> Result<Vec<NearShape>, IndexError> {
        let all = self.checked(query)?;
        let near = |(i, distance)| NearShape { id: all.id(i).to_owned(), distance };
        Ok(all.nearest(query, k).into_iter().map(near).collect())
    }

    /// The `k` shapes whose rank distances from `query` are least, among its nearest shapes and their neighbours; ties by
    /// distance and name. Up to [`LINKS`] results are the first of one another; more look farther around. Measures all vectors once for every list of neighbours that is visited, at most about 600.
    ///
    /// # Errors
    /// Those of [`nearest`](Self::nearest).
    pub fn nearest_on_graph(&self, query: &[f32], k: usize) -> Result<Vec<RankedShape>, IndexError> {
        let all = self.checked(query)?;
        let nearest: Vec<Neighbor> = all.nearest(query, k.max(LINKS)).into_iter().map(neighbor).collect();
        let mut ranked = graph_rank(usize::MAX, &nearest, &mut Walk { all, query })?;
        ranked.truncate(k);
        let shape = |GraphNeighbor { index, distance, rank_distance }: GraphNeighbor| {
            let place = nearest.iter().position(|near| near.index == index);
            let plain_rank = place.map(|place| place + 1);
            RankedShape { id: all.id(index).to_owned(), distance, rank_distance, plain_rank }
        };
        Ok(ranked.into_iter().map(shape).collect())
    }

    /// The vectors of all shapes, if a query can be compared with them.
    fn checked(&self, query: &[f32]) -> Result<&VectorTable, IndexError> {
        let all = self.vector_table()?;
        if !all.is_empty() && query.len() != all.dim() {
            let (found, expected) = (query.len(), all.dim());
            return Err(IndexError::OtherLength { id: "the query".to_owned(), found, expected });
        }
        match query.iter().all(|x| x.is_finite()) {
            true => Ok(all),
            false => Err(IndexError::BadVector("the query".to_owned())),
        }
    }
}

fn neighbor((index, distance): (usize, f64)) -> Neighbor {
    Neighbor { index, distance }
}

/// The graph around a query.
struct Walk<'a> {
    all: &'a VectorTable,
    query: &'a [f32],
}

impl retrieval::Graph for Walk<'_> {
    type Error = IndexError;

    fn links(&mut self, shape: usize) -> Result<Vec<Neighbor>, IndexError> {
        let found = self.all.nearest(self.all.vector(shape), LINKS + 1).into_iter();
        Ok(found.filter(|(i, _)| *i != shape).take(LINKS).map(neighbor).collect())
    }

    fn distance(&mut self, shape: usize) -> Result<f64, IndexError> {
        Ok(distance(self.query, self.all.vector(shape)))
    }
}

/// The [threshold](Index::threshold) of the index that would hold the shapes of all of these, which have different names
/// and were described with the same options. Holds the vectors of one index at a time in memory.
///
/// # Errors
/// [`IndexError::Io`], [`IndexError::Damaged`].
pub fn class_threshold(indexes: &[Index]) -> Result<Option<UnknownThreshold>, IndexError> {
    threshold(|visit| {
        indexes.iter().try_for_each(|index| {
            let vectors = vectors(index.view())?;
            let classes = classes(index.view(), &vectors)?;
            visit(&vectors, &classes);
            Ok(())
        })
    })
}
