//! The graph of nearest neighbours: for every shape, its nearest others.
//!
//! Lists are ordered by squared distance, ties by key. A key is a hash of a name, so lists depend on the shapes alone.
//! Each pair has one squared distance on one machine, in either direction; another machine may round it differently.

use std::convert::Infallible;

use base::Observer;
use rayon::prelude::*;
use retrieval::LINKS;
use serde::{Deserialize, Serialize};

use super::cells::{Reach, scan, search_cells};
use super::kmeans::Centroids;
use super::nearest::Nearest;
use crate::shape::ShapeKey;

/// Shapes whose lists are made together, and shapes that they meet while both are in the cache.
const GROUP: usize = 16;
const BLOCK: usize = 1024;

/// A neighbour of a shape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Link {
    /// Squared distance.
    pub(crate) sq: f32,
    pub(crate) key: ShapeKey,
}

impl Link {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.sq.total_cmp(&other.sq).then(self.key.cmp(&other.key))
    }
}

/// The neighbours of a shape, nearest first, at most [`LINKS`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Links(pub(crate) Vec<Link>);

impl Links {
    /// The nearest of these shapes, without the shape itself.
    pub(crate) fn of(own: ShapeKey, found: impl Iterator<Item = Link>) -> Self {
        let mut links: Vec<Link> = found.filter(|link| link.key != own).collect();
        links.sort_unstable_by(Link::cmp);
        links.truncate(LINKS);
        Self(links)
    }

    /// Whether they can be the neighbours of this shape.
    pub(crate) fn are_sound(&self, own: ShapeKey) -> bool {
        let is_link = |link: &Link| link.key != own && link.sq >= 0.0 && link.sq.is_finite();
        self.0.len() <= LINKS && self.0.iter().all(is_link) && self.0.is_sorted_by(|a, b| a.cmp(b).is_lt())
    }

    /// Shapes beyond this squared distance do not enter.
    pub(crate) fn bound(&self) -> f32 {
        if self.0.len() < LINKS { f32::INFINITY } else { self.0.last().map_or(f32::INFINITY, |last| last.sq) }
    }

    /// Adds a shape that is not listed, if it is near enough.
    pub(crate) fn offer(&mut self, link: Link) {
        if self.0.iter().any(|known| known.key == link.key) {
            return;
        }
        let at = self.0.partition_point(|known| known.cmp(&link).is_lt());
        self.0.insert(at, link);
        self.0.truncate(LINKS);
    }

    /// Whether the lists agree up to the rounding of another machine.
    pub(crate) fn agrees(&self, fresh: &Self) -> bool {
        let close = |a: f32, b: f32| (a - b).abs() <= 1e-3 * a.max(b) || a == b;
        self.0.len() == fresh.0.len() && self.0.iter().zip(&fresh.0).all(|(a, b)| close(a.sq, b.sq))
    }
}

/// Vectors in memory, cell after cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Divided<'a> {
    /// Padded vectors.
    pub(crate) rows: &'a [f32],
    /// The start of each cell, and the end of the last one.
    pub(crate) starts: &'a [usize],
    pub(crate) centroids: &'a Centroids,
    pub(crate) reach: Reach,
}

impl Divided<'_> {
    /// The lists of all shapes, in the order of their keys. A step is a list.
    pub(crate) fn links(&self, keys: &[ShapeKey], observer: &dyn Observer) -> Vec<Links> {
        let groups = keys.par_chunks(GROUP).enumerate();
        groups
            .flat_map_iter(|(group, own)| {
                let first = group * GROUP;
                let found = match self.starts.len() {
                    2 => self.all_near(first, own.len()),
                    _ => (first..first + own.len()).map(|i| self.near_row(i)).collect(),
                };
                own.iter().for_each(|_| observer.step());
                found.into_iter().zip(own).map(|(hits, own)| listed(keys, *own, hits)).collect::<Vec<_>>()
            })
            .collect()
    }

    /// The list of one shape.
    pub(crate) fn links_of(&self, keys: &[ShapeKey], i: usize) -> Links {
        listed(keys, keys[i], self.near_row(i))
    }

    fn row(&self, i: usize) -> &[f32] {
        let n = self.centroids.n;
        &self.rows[i * n..][..n]
    }

    /// Measures everything, for some shapes together.
    fn all_near(&self, first: usize, count: usize) -> Vec<Nearest> {
        let mut found = vec![Nearest::new(LINKS + 1); count];
        for (block, rows) in self.rows.chunks(BLOCK * self.centroids.n).enumerate() {
            for (i, nearest) in found.iter_mut().enumerate() {
                scan(self.row(first + i), (block * BLOCK) as u32, rows, nearest);
            }
        }
        found
    }

    fn near_row(&self, i: usize) -> Nearest {
        self.near(self.row(i), LINKS + 1).0
    }

    /// Searches for a padded vector. Returns the number of vectors that were measured, too.
    pub(crate) fn near(&self, row: &[f32], k: usize) -> (Nearest, usize) {
        let (n, mut n_measured) = (row.len(), 0);
        let Ok(nearest) = search_cells(row, self.centroids, self.reach, k, |cell, nearest| {
            let [start, end] = [0, 1].map(|next| self.starts[cell as usize + next]);
            n_measured += end - start;
            scan(row, start as u32, &self.rows[start * n..end * n], nearest);
            Ok::<_, Infallible>(())
        });
        (nearest, n_measured)
    }
}

fn listed(keys: &[ShapeKey], own: ShapeKey, hits: Nearest) -> Links {
    Links::of(own, hits.into_hits().map(|hit| Link { sq: hit.sq, key: keys[hit.slot as usize] }))
}

#[cfg(test)]
mod tests {
    use super::super::testing::noise;
    use super::*;
    use crate::shape::shape_key;

    fn all<'a>(rows: &'a [f32], centroids: &'a Centroids, starts: &'a [usize]) -> Divided<'a> {
        Divided { rows, starts, centroids, reach: Reach::ALL }
    }

    #[test]
    fn lists_hold_the_nearest_others_and_do_not_depend_on_cells() {
        let n = 300;
        let rows = noise(n, 16, 4);
        let keys: Vec<ShapeKey> = (0..n).map(|i| shape_key(&i.to_string())).collect();
        let one = Centroids::new(vec![0.0; 16], 16);
        let whole = all(&rows, &one, &[0, n]).links(&keys, &());
        let two = Centroids::new([vec![0.1; 16], vec![-0.1; 16]].concat(), 16);
        assert_eq!(all(&rows, &two, &[0, 120, n]).links(&keys, &()), whole);
        for (i, links) in whole.iter().enumerate() {
            let sq = |j: usize| -> f32 {
                let [a, b] = [i, j].map(|i| &rows[16 * i..][..16]);
                a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
            };
            let mut expected: Vec<f32> = (0..n).filter(|j| *j != i).map(sq).collect();
            expected.sort_by(f32::total_cmp);
            assert_eq!(links.0.len(), LINKS);
            assert!(links.0.iter().zip(expected).all(|(link, sq)| (link.sq - sq).abs() < 1e-4 * sq));
        }
    }

    #[test]
    fn offers_in_any_order_give_the_same_list() {
        let links: Vec<Link> =
            (0..40u32).map(|i| Link { sq: (i * 7 % 11) as f32, key: u64::from(i) }).collect();
        let whole = Links::of(u64::MAX, links.iter().copied());
        for turn in 0..40 {
            let mut list = Links::default();
            for i in 0..40 {
                list.offer(links[(i + turn) % 40]);
                list.offer(links[(i + turn) % 40]);
            }
            assert_eq!(list, whole);
            assert_eq!(list.bound(), whole.0[LINKS - 1].sq);
        }
    }
}
