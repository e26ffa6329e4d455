//! Cell centres by k-means.

use rayon::prelude::*;

use super::kernels::Interleaved;

/// Points in one parallel task.
const BLOCK: usize = 256;

/// Iterations of Lloyd's algorithm. Half as many need a cell more for the same recall.
const ROUNDS: usize = 12;

/// Cell centres.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Centroids {
    pub(crate) rows: Vec<f32>,
    /// Length of a row.
    pub(crate) n: usize,
}

impl Centroids {
    pub(crate) fn new(rows: Vec<f32>, n: usize) -> Self {
        Self { rows, n }
    }

    /// The nearest centre of each point, in parallel.
    pub(crate) fn assign(&self, points: &[f32]) -> Vec<u32> {
        let centres = Interleaved::new(&self.rows, self.n);
        points.par_chunks(BLOCK * self.n).flat_map_iter(|part| centres.nearest(part)).collect()
    }

    /// `k` centres of `points` of length `n` by Lloyd's algorithm, started at every `n_points / k`-th point. An
    /// empty cell takes a point from the largest one.
    ///
    /// The result does not depend on the number of threads.
    pub(crate) fn of(points: &[f32], k: usize, n: usize) -> Self {
        let n_points = points.len() / n;
        let rows = (0..k).flat_map(|i| &points[i * n_points / k * n..][..n]).copied().collect();
        let mut centroids = Self::new(rows, n);
        for _ in 0..ROUNDS {
            let cells = centroids.assign(points);
            centroids = Self::new(means(points, &cells, &centroids.rows, n), n);
        }
        centroids
    }
}

/// The mean of the points of each cell, summed in double precision in the order of the points.
fn means(points: &[f32], cells: &[u32], old: &[f32], n: usize) -> Vec<f32> {
    let k = old.len() / n;
    let mut members = vec![Vec::new(); k];
    for (i, cell) in cells.iter().enumerate() {
        members[*cell as usize].push(i);
    }
    // Each empty cell takes one point from the largest cell.
    let empty: Vec<usize> = (0..k).filter(|cell| members[*cell].is_empty()).collect();
    for cell in empty {
        let largest = (0..k).max_by_key(|other| (members[*other].len(), k - other)).unwrap_or(cell);
        if members[largest].len() > 1
            && let Some(given) = members[largest].pop()
        {
            members[cell].push(given);
        }
    }
    let mean = |(members, old): (&Vec<usize>, &[f32])| {
        let mut sum = vec![0.0f64; n];
        for point in members {
            sum.iter_mut().zip(&points[point * n..][..n]).for_each(|(sum, x)| *sum += f64::from(*x));
        }
        match members.len() {
            0 => old.to_vec(),
            count => sum.iter().map(|sum| (sum / count as f64) as f32).collect(),
        }
    };
    members.par_iter().zip(old.par_chunks_exact(n)).flat_map_iter(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{clustered, noise};
    use super::*;

    #[test]
    fn separate_clusters_are_found() {
        let (points, of) = clustered(400, 8, 16, 0.01);
        let cells = Centroids::of(&points, 8, 16).assign(&points);
        // Lloyd's algorithm may merge clusters, but does not scatter a tight one over many cells.
        let mut pairs: Vec<_> = of.iter().zip(&cells).collect();
        pairs.sort_unstable();
        pairs.dedup();
        assert!(pairs.len() <= 12, "{} pairs of a cluster and a cell", pairs.len());
    }

    #[test]
    fn no_cell_is_empty() {
        let points = noise(1000, 16, 1);
        let centroids = Centroids::of(&points, 40, 16);
        // Copies of one point all belong to the same cell.
        let same = Centroids::of(&[1.0; 16 * 10], 3, 16);
        assert_eq!(same.assign(&[1.0; 16]), [0]);
        let filled: std::collections::BTreeSet<u32> = centroids.assign(&points).into_iter().collect();
        assert!(filled.len() >= 39);
    }
}
