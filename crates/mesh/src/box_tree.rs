//! A tree of bounding boxes over points.

use std::ops::Range;

use nalgebra::{Point3, Vector3};

/// The most points in a leaf of the tree.
const LEAF: usize = 8;

/// A tree of bounding boxes in one array, parents before their children.
pub(crate) struct BoxTree {
    /// Points and their numbers.
    pub(crate) items: Vec<(Point3<f64>, u32)>,
    pub(crate) nodes: Vec<Node>,
}

#[derive(Debug, Clone)]
pub(crate) struct Node {
    low: Point3<f64>,
    high: Point3<f64>,
    pub(crate) items: Range<usize>,
    /// The two children; `None` for a leaf.
    pub(crate) children: Option<[usize; 2]>,
}

impl BoxTree {
    /// The tree over points, each with a number. `O(n log n)`.
    pub(crate) fn new(points: impl Iterator<Item = (Point3<f64>, u32)>) -> Self {
        let mut tree = Self { items: points.collect(), nodes: Vec::new() };
        tree.grow(0..tree.items.len());
        tree
    }

    /// Adds the node over a range of items and all below it; returns its index.
    fn grow(&mut self, range: Range<usize>) -> usize {
        let nothing = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]].map(Point3::from);
        let around = |[low, high]: [Point3<f64>; 2], (p, _): &(Point3<f64>, u32)| [low.inf(p), high.sup(p)];
        let [low, high] = self.items[range.clone()].iter().fold(nothing, around);
        let index = self.nodes.len();
        self.nodes.push(Node { low, high, items: range.clone(), children: None });
        if range.len() > LEAF {
            let width = |axis: &usize| high[*axis] - low[*axis];
            let widest = (0..3).max_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or(0);
            let half = range.len() / 2;
            self.items[range.clone()]
                .select_nth_unstable_by(half, |a, b| a.0[widest].total_cmp(&b.0[widest]));
            let middle = range.start + half;
            let children = [self.grow(range.start..middle), self.grow(middle..range.end)];
            self.nodes[index].children = Some(children);
        }
        index
    }

    /// The `k` points nearest to a position, or all if there are fewer, as squared distances and numbers in ascending order.
    pub(crate) fn nearest(&self, at: &Point3<f64>, k: usize) -> Vec<(f64, u32)> {
        self.nearest_within(at, f64::INFINITY, k, |_| false, |_| false)
    }

    /// The `k` points nearest to a position within a radius, which is squared, as squared distances and numbers in ascending
    /// order. `skips` excludes points, `prunes` nodes by their index.
    pub(crate) fn nearest_within(
        &self,
        at: &Point3<f64>,
        sq_radius: f64,
        k: usize,
        skips: impl Fn(u32) -> bool,
        prunes: impl Fn(usize) -> bool,
    ) -> Vec<(f64, u32)> {
        let (mut found, mut pending) = (Vec::<(f64, u32)>::with_capacity(k), vec![0]);
        while let Some(index) = pending.pop() {
            let node = &self.nodes[index];
            let gap = node.sq_gap_to(at);
            let is_full = found.len() == k;
            if gap > sq_radius || is_full && gap >= found[k - 1].0 || prunes(index) {
                continue;
            }
            match node.children {
                Some([a, b]) => {
                    let a_first = self.nodes[a].sq_gap_to(at) <= self.nodes[b].sq_gap_to(at);
                    pending.extend(if a_first { [b, a] } else { [a, b] });
                }
                None => {
                    for (p, id) in &self.items[node.items.clone()] {
                        let sq = (p - at).norm_squared();
                        let candidate = (sq, *id);
                        if sq > sq_radius || skips(*id) {
                            continue;
                        }
                        let place = found.partition_point(|known| *known < candidate);
                        if place < k {
                            found.truncate(k - 1);
                            found.insert(place, candidate);
                        }
                    }
                }
            }
        }
        found
    }
}

impl Node {
    /// Squared distance to a point. Never larger than that of a point in the box, even with rounding, since every step
    /// is monotonic.
    fn sq_gap_to(&self, point: &Point3<f64>) -> f64 {
        (self.low - point).sup(&(point - self.high)).sup(&Vector3::zeros()).norm_squared()
    }
}
