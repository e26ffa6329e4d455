//! Ranking on the graph of nearest neighbors.
//!
//! Two shapes of one class have the same neighbors. So the distance from a query to a shape is mixed with the
//! *dissimilarity of their neighborhoods*, a weighted Jaccard distance in the manner of k-reciprocal re-ranking (Zhong et
//! al. 2017, `zhong2017` in `REFERENCES.bib`).
//!
//! The neighborhood of shape `i` is a weight for each shape `j`: 1 for `i` itself,
//!
//! ```text
//! w_ij = exp(-(d_ij / (0.5 s_i))²)
//! ```
//!
//! for its [`LINKS`] nearest others, and 0 for the rest. The local scale `s_i` is the mean distance of these others
//! (after Zelnik-Manor and Perona 2004, `zelnik2004`). It adapts the neighborhood to classes of any size: if few shapes are
//! much nearer than the rest, the rest determines the scale and gets little weight; if all are about equally near, all
//! count. Then
//!
//! ```text
//! J_qj = 1 - sum_l min(w_ql, w_jl) / sum_l max(w_ql, w_jl)     r_qj = 0.6 x / (1 + x) + 0.4 J_qj,   x = d_qj / s_q
//! ```
//!
//! is the *rank distance*, in 0..1. It is scaled by the query alone, so shapes without a common neighbor keep the order of
//! their distances.
//!
//! A query visits its neighbors, theirs, and the lists of these. Other shapes have `J = 1`.

use std::collections::HashMap;

use linalg::DistanceMatrix;
use rayon::prelude::*;

use crate::{Neighbor, Rankings, rank};

/// Neighbors listed for every shape. With 16 generated classes gain 0.4 % mAP less than with 32, which take longer.
/// `cargo test -p canonform-retrieval --test it graph_gain -- --nocapture --include-ignored` prints what these constants give.
pub const LINKS: usize = 24;

/// The distance at which a weight has fallen to `1 / e`, in local scales. With 0.65, generated classes of two lose 1 % mAP;
/// with 0.4, others gain half as much. See [`LINKS`].
const WIDTH: f64 = 0.5;

/// The share of the distance in the rank distance. With 0.5, generated classes gain 0.3 % mAP more, but classes of two among
/// many neighbors lose more; with 0.7, they gain 0.4 % less. See [`LINKS`].
const DIRECT: f64 = 0.6;

/// A shape as a query finds it on the graph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GraphNeighbor {
    /// Index of the shape.
    pub index: usize,
    /// Its distance from the query.
    pub distance: f64,
    /// Its rank distance, in 0..1, by which results are ordered.
    pub rank_distance: f64,
}

/// Ranks shapes on the graph: those of `nearest`, the nearest shapes of the query, nearest first, and the neighbors of the
/// first [`LINKS`] of them. Results are ordered by rank distance, ties by distance and index.
///
/// `query` is the index of the query, any other number if it is not among the shapes. It need not be in the lists: it takes
/// its place in those that it is near enough to, so a query has the same results before and after it is added.
///
/// `links` gives the [`LINKS`] nearest others of a shape, or all if there are fewer, nearest first; `distance` that of the query to
/// a shape.
pub fn graph_rank(
    query: usize,
    nearest: &[Neighbor],
    links: impl Fn(usize) -> Vec<Neighbor>,
    distance: impl Fn(usize) -> f64,
) -> Vec<GraphNeighbor> {
    let own = &nearest[..nearest.len().min(LINKS)];
    let (scale, around) = (scale(own), Neighborhood::new(query, own));
    let mut distances: HashMap<usize, f64> = nearest.iter().map(|near| (near.index, near.distance)).collect();
    let mut lists: HashMap<usize, Vec<Neighbor>> = HashMap::new();
    // The order of visits decides nothing but the order of reading.
    let mut visited: Vec<usize> = own.iter().map(|near| near.index).collect();
    for near in own {
        let links = links(near.index);
        visited.extend(links.iter().map(|link| link.index).filter(|index| *index != query));
        lists.insert(near.index, links);
    }
    visited.sort_unstable();
    visited.dedup();
    let mut apart: HashMap<usize, f64> = HashMap::with_capacity(visited.len());
    for index in visited {
        let mut links = lists.remove(&index).unwrap_or_else(|| links(index));
        let distance = *distances.entry(index).or_insert_with(|| distance(index));
        enter(&mut links, Neighbor { index: query, distance });
        apart.insert(index, around.jaccard(index, &links));
    }
    let mut found: Vec<GraphNeighbor> = distances
        .into_iter()
        .map(|(index, distance)| {
            let x = if distance > 0.0 { distance / scale } else { 0.0 };
            // Infinite if the scale is 0.
            let direct = if x.is_finite() { x / (1.0 + x) } else { 1.0 };
            let apart = apart.get(&index).copied().unwrap_or(1.0);
            GraphNeighbor { index, distance, rank_distance: DIRECT * direct + (1.0 - DIRECT) * apart }
        })
        .collect();
    found.sort_unstable_by(|a, b| {
        let by_rank = a.rank_distance.total_cmp(&b.rank_distance);
        by_rank.then(a.distance.total_cmp(&b.distance)).then(a.index.cmp(&b.index))
    });
    found
}

/// The mean distance of the neighbors of a shape.
fn scale(links: &[Neighbor]) -> f64 {
    links.iter().map(|link| link.distance).sum::<f64>() / links.len().max(1) as f64
}

/// Adds the query to a list that it is near enough to, unless it is there.
fn enter(links: &mut Vec<Neighbor>, query: Neighbor) {
    if !links.iter().any(|link| link.index == query.index) {
        links.insert(links.partition_point(|link| link.distance <= query.distance), query);
        links.truncate(LINKS);
    }
}

/// The weights of the neighbors of a shape, itself included.
fn weights(of: usize, links: &[Neighbor]) -> impl Iterator<Item = (usize, f64)> {
    let width = WIDTH * scale(links);
    let weight = move |distance: f64| if distance > 0.0 { (-(distance / width).powi(2)).exp() } else { 1.0 };
    std::iter::once((of, 1.0)).chain(links.iter().map(move |link| (link.index, weight(link.distance))))
}

/// The neighborhood of a query.
struct Neighborhood {
    weights: HashMap<usize, f64>,
    total: f64,
}

impl Neighborhood {
    fn new(query: usize, links: &[Neighbor]) -> Self {
        let total = weights(query, links).map(|(_, weight)| weight).sum();
        Self { weights: weights(query, links).collect(), total }
    }

    /// The Jaccard distance from the neighborhood of a shape.
    fn jaccard(&self, of: usize, links: &[Neighbor]) -> f64 {
        let (mut common, mut total) = (0.0, 0.0);
        for (index, weight) in weights(of, links) {
            total += weight;
            common += self.weights.get(&index).map_or(0.0, |own| own.min(weight));
        }
        1.0 - common / (self.total + total - common)
    }
}

/// The rankings of a matrix of distances on its graph of nearest neighbors. The distances of the ranked shapes are rank
/// distances.
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::DistanceMatrix;
/// use canonform_retrieval::{GraphRankings, Rankings, rank};
///
/// let positions = [0.0_f64, 1.0, 2.0, 3.0, 4.0, 9.0, 9.5, 10.0];
/// let distances = DistanceMatrix::from_pairs(8, |i, j| (positions[i] - positions[j]).abs())?;
/// let graph = GraphRankings::new(&distances);
/// let found: Vec<usize> = graph.ranking(0).iter().map(|near| near.index).collect();
/// assert_eq!(found[..4], [1, 2, 3, 4]);
/// assert_eq!(found.len(), rank(&distances, 0).len());
/// # Ok::<(), canonform_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone)]
pub struct GraphRankings<'a> {
    distances: &'a DistanceMatrix,
    lists: Vec<Vec<Neighbor>>,
}

impl<'a> GraphRankings<'a> {
    /// Makes the graph, in parallel.
    pub fn new(distances: &'a DistanceMatrix) -> Self {
        let links = |i: usize| {
            let mut links = rank(distances, i);
            links.truncate(LINKS);
            links.shrink_to_fit();
            links
        };
        Self { distances, lists: (0..distances.n_points()).into_par_iter().map(links).collect() }
    }
}

impl Rankings for GraphRankings<'_> {
    fn n_points(&self) -> usize {
        self.distances.n_points()
    }

    fn ranking(&self, query: usize) -> Vec<Neighbor> {
        let nearest = rank(self.distances, query);
        let links = |shape: usize| self.lists[shape].clone();
        let found = graph_rank(query, &nearest, links, |shape| self.distances.get(query, shape));
        found.into_iter().map(|near| Neighbor { index: near.index, distance: near.rank_distance }).collect()
    }
}
