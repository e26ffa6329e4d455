//! Search on the graph of nearest neighbours.

use std::collections::HashMap;

use retrieval::{GraphNeighbor, LINKS, Neighbor, graph_rank};

use super::{Found, SearchMode, distance};
use crate::shape::{ShapeKey, shape_key};
use crate::store::View;
use crate::tables::{FUSED, node};
use crate::{Index, IndexError};

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

/// The result of a search on the graph.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundOnGraph {
    /// Smallest rank distance first; ties by distance and name.
    pub shapes: Vec<RankedShape>,
    /// Number of lists of neighbours that were read.
    pub n_lists: usize,
    /// The search for the nearest vectors, without its shapes.
    pub search: Found,
}

impl Index {
    /// The `k` shapes whose rank distances from `query` are least, among its nearest shapes and their neighbours. Reads the
    /// cells and the lists that it needs from the file.
    ///
    /// # Errors
    /// Those of [`nearest`](Self::nearest).
    pub fn nearest_on_graph(
        &self,
        query: &[f32],
        k: usize,
        mode: SearchMode,
    ) -> Result<FoundOnGraph, IndexError> {
        let mut search = self.nearest(query, k.max(LINKS), mode)?;
        let mut walk =
            Walk { view: self.view(), query, numbers: HashMap::new(), met: Vec::new(), n_lists: 0 };
        let nearest: Vec<Neighbor> = std::mem::take(&mut search.shapes)
            .into_iter()
            .map(|near| {
                let index = walk.number(shape_key(&near.id));
                walk.met[index].1 = Some(near.id);
                Neighbor { index, distance: near.distance }
            })
            .collect();
        let ranked = graph_rank(usize::MAX, &nearest, &mut walk)?;
        let Walk { mut met, n_lists, .. } = walk;
        let shape = |found: GraphNeighbor| {
            let GraphNeighbor { index, distance, rank_distance } = found;
            // The nearest were numbered first.
            let plain_rank = (index < nearest.len()).then_some(index + 1);
            Some(RankedShape { id: met[index].1.take()?, distance, rank_distance, plain_rank })
        };
        // A neighbour without a name is gone.
        let mut shapes: Vec<RankedShape> =
            ranked.into_iter().filter(|near| near.distance.is_finite()).filter_map(shape).collect();
        shapes.sort_by(|a, b| {
            let by_rank = a.rank_distance.total_cmp(&b.rank_distance);
            by_rank.then(a.distance.total_cmp(&b.distance)).then_with(|| a.id.cmp(&b.id))
        });
        shapes.truncate(k);
        Ok(FoundOnGraph { shapes, n_lists, search })
    }
}

/// The part of the graph around a query.
struct Walk<'a> {
    view: View<'a>,
    query: &'a [f32],
    /// The numbers of shapes, in the order in which they are met.
    numbers: HashMap<ShapeKey, usize>,
    /// Their names, as far as they are known.
    met: Vec<(ShapeKey, Option<String>)>,
    n_lists: usize,
}

impl Walk<'_> {
    fn number(&mut self, key: ShapeKey) -> usize {
        *self.numbers.entry(key).or_insert_with(|| {
            self.met.push((key, None));
            self.met.len() - 1
        })
    }
}

impl retrieval::Graph for Walk<'_> {
    type Error = IndexError;

    fn links(&mut self, shape: usize) -> Result<Vec<Neighbor>, IndexError> {
        self.n_lists += 1;
        let Some(node) = node(self.view, self.met[shape].0)? else { return Ok(Vec::new()) };
        self.met[shape].1.get_or_insert(node.id);
        let links = node.links.0.into_iter();
        Ok(links
            .map(|link| Neighbor { index: self.number(link.key), distance: f64::from(link.sq).sqrt() })
            .collect())
    }

    /// Infinite for a shape that is gone: its list named no shape.
    fn distance(&mut self, shape: usize) -> Result<f64, IndexError> {
        let Some(id) = &self.met[shape].1 else { return Ok(f64::INFINITY) };
        let vector = FUSED.get(self.view, id.as_str())?;
        Ok(vector.map_or(f64::INFINITY, |vector| distance(self.query, &vector.0)))
    }
}
