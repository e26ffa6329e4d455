//! Division of vectors into cells, and the calibrated number of cells that a search scans.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::kernels::sq_distances_into;
use super::kmeans::Centroids;
use super::nearest::{Hit, Nearest};
use retrieval::UnknownThreshold;

/// Up to this many vectors a search measures all of them, which is exact and takes less than two milliseconds.
pub(crate) const EXACT_LIMIT: usize = 50_000;

/// Sampled points per cell for k-means.
const SAMPLE: usize = 48;

/// Vectors used as queries to calibrate the number of cells to scan.
const TRIALS: usize = 256;

/// Neighbours searched for in a trial.
const NEIGHBORS: usize = 10;

/// Share of them that must be found: higher than what is promised, because there are few trials.
const RECALL: f64 = 0.996;

/// Rows measured together.
pub(crate) const CHUNK: usize = 256;

/// Summary of [`Cells`], stored with them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct CellsHeader {
    /// Length of a vector.
    pub(crate) dim: usize,
    /// Number of vectors.
    pub(crate) n: usize,
    /// Number of vectors in each cell.
    pub(crate) sizes: Vec<u32>,
    /// Number of cells that a search scans.
    pub(crate) probes: usize,
    /// Measured share of the ten nearest that such a search finds; 1 if it scans all cells.
    pub(crate) recall: f64,
    /// Distance beyond which a query belongs to no class of the index.
    pub(crate) threshold: Option<UnknownThreshold>,
}

impl CellsHeader {
    /// Whether a search scans all cells.
    pub(crate) fn is_exact(&self) -> bool {
        self.probes >= self.sizes.len()
    }
}

/// Vectors divided into cells.
#[derive(Debug, PartialEq)]
pub(crate) struct Cells {
    pub(crate) header: CellsHeader,
    pub(crate) centroids: Centroids,
    /// The numbers of the vectors, cell by cell, ascending in each cell.
    pub(crate) slots: Vec<u32>,
}

impl Cells {
    /// Divides `rows`, vectors of `dim` numbers padded to `n`, into cells. The result does not depend on the number
    /// of threads.
    pub(crate) fn of(rows: &[f32], dim: usize, n: usize) -> Self {
        let n_rows = rows.len() / n;
        match n_rows {
            0..=EXACT_LIMIT => Self::with_cells(rows, dim, n, 1),
            _ => Self::with_cells(rows, dim, n, 2 * n_rows.isqrt()),
        }
    }

    pub(crate) fn with_cells(rows: &[f32], dim: usize, n: usize, n_cells: usize) -> Self {
        let n_rows = rows.len() / n;
        if n_cells < 2 || n_rows < n_cells {
            let sizes = vec![n_rows as u32];
            let header = CellsHeader { dim, n: n_rows, sizes, probes: 1, recall: 1.0, threshold: None };
            let centroids = Centroids::new(vec![0.0; n], n);
            return Self { header, centroids, slots: (0..n_rows as u32).collect() };
        }
        let n_sampled = (SAMPLE * n_cells).min(n_rows);
        let sample: Vec<f32> =
            (0..n_sampled).flat_map(|i| &rows[i * n_rows / n_sampled * n..][..n]).copied().collect();
        let centroids = Centroids::of(&sample, n_cells, n);
        drop(sample);
        let cells = centroids.assign(rows);
        let mut sizes = vec![0u32; n_cells];
        cells.iter().for_each(|cell| sizes[*cell as usize] += 1);
        let mut slots: Vec<u32> = (0..n_rows as u32).collect();
        slots.sort_by_key(|slot| cells[*slot as usize]);
        let (probes, recall) = calibrated(rows, n, &cells, &centroids);
        let header = CellsHeader { dim, n: n_rows, sizes, probes, recall, threshold: None };
        Self { header, centroids, slots }
    }
}

/// The `probes` cells nearest to `query`, nearest first.
pub(crate) fn nearest_cells(query: &[f32], centroids: &Centroids, probes: usize) -> Vec<u32> {
    let mut gaps = vec![0.0; centroids.rows.len() / query.len()];
    sq_distances_into(query, &centroids.rows, &mut gaps);
    let mut order: Vec<Hit> =
        gaps.iter().enumerate().map(|(cell, sq)| Hit { sq: *sq, slot: cell as u32 }).collect();
    if probes < order.len() {
        order.select_nth_unstable(probes);
        order.truncate(probes);
    }
    order.sort_unstable();
    order.into_iter().map(|hit| hit.slot).collect()
}

/// Offers `rows`, whose numbers are `slots`, to `nearest`.
pub(crate) fn scan(query: &[f32], slots: &[u32], rows: &[f32], nearest: &mut Nearest) {
    let mut sqs = [0.0; CHUNK];
    for (slots, rows) in slots.chunks(CHUNK).zip(rows.chunks(CHUNK * query.len())) {
        let sqs = &mut sqs[..slots.len()];
        sq_distances_into(query, rows, sqs);
        nearest.offer_all(slots, sqs);
    }
}

/// The number of cells that must be scanned to reach [`RECALL`], and the recall reached, measured by searching for
/// some of the vectors among all others.
fn calibrated(rows: &[f32], n: usize, cells: &[u32], centroids: &Centroids) -> (usize, f64) {
    let n_rows = rows.len() / n;
    let n_cells = centroids.rows.len() / n;
    let trials: Vec<usize> =
        (0..TRIALS.min(n_rows)).map(|i| (2 * i + 1) * n_rows / (2 * TRIALS.min(n_rows))).collect();
    let found = exact(rows, n, &trials);
    // For each neighbour of each trial, the number of cells that must be scanned to find it.
    let mut found_from: Vec<usize> = trials
        .par_iter()
        .zip(&found)
        .flat_map_iter(|(trial, hits)| {
            let mut rank = vec![0; n_cells];
            let order = nearest_cells(&rows[trial * n..][..n], centroids, n_cells);
            order.iter().enumerate().for_each(|(i, cell)| rank[*cell as usize] = i + 1);
            let others = hits.iter().filter(|hit| hit.slot as usize != *trial).take(NEIGHBORS);
            others.map(|hit| rank[cells[hit.slot as usize] as usize]).collect::<Vec<_>>()
        })
        .collect();
    found_from.sort_unstable();
    let wanted = (RECALL * found_from.len() as f64).ceil() as usize;
    let probes = found_from.get(wanted.saturating_sub(1)).copied().unwrap_or(n_cells).max(1);
    let within = found_from.partition_point(|from| *from <= probes);
    (probes, within as f64 / found_from.len().max(1) as f64)
}

/// The nearest rows of each query row, itself included.
fn exact(rows: &[f32], n: usize, queries: &[usize]) -> Vec<Vec<Hit>> {
    let start = || vec![Nearest::new(NEIGHBORS + 1); queries.len()];
    let block = 16 * CHUNK;
    let found = rows
        .par_chunks(block * n)
        .enumerate()
        .fold(start, |mut nearest, (i, part)| {
            let first = (i * block) as u32;
            let slots: Vec<u32> = (first..first + (part.len() / n) as u32).collect();
            for (slots, part) in slots.chunks(CHUNK).zip(part.chunks(CHUNK * n)) {
                for (nearest, query) in nearest.iter_mut().zip(queries) {
                    scan(&rows[query * n..][..n], slots, part, nearest);
                }
            }
            nearest
        })
        .reduce(start, |a, b| a.into_iter().zip(b).map(|(a, b)| a.join(b)).collect());
    found.into_iter().map(Nearest::into_sorted).collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{clustered, noise};
    use super::*;

    #[test]
    fn each_vector_is_in_exactly_one_cell() {
        let rows = noise(3000, 16, 2);
        let cells = Cells::with_cells(&rows, 12, 16, 50);
        let mut slots = cells.slots.clone();
        slots.sort_unstable();
        assert!(slots.iter().copied().eq(0..3000));
        assert_eq!(cells.header.sizes.iter().sum::<u32>(), 3000);
        assert_eq!((cells.header.dim, cells.header.n), (12, 3000));
    }

    #[test]
    fn few_vectors_form_one_cell() {
        for rows in [Vec::new(), noise(7, 16, 2)] {
            let cells = Cells::of(&rows, 16, 16);
            assert_eq!(cells.header.sizes, [rows.len() as u32 / 16]);
            assert!(cells.header.is_exact());
        }
    }

    #[test]
    fn the_recall_holds_for_vectors_that_are_not_in_the_index() {
        let (all, _) = clustered(6200, 300, 16, 0.3);
        let (rows, queries) = all.split_at(6000 * 16);
        let cells = Cells::with_cells(rows, 16, 16, 80);
        assert!(cells.header.recall >= RECALL && cells.header.probes < 40, "{:?}", cells.header.probes);
        let of_row = cells.centroids.assign(rows);
        let (mut found, mut wanted) = (0, 0);
        for query in queries.chunks(16) {
            let mut nearest = Nearest::new(10);
            scan(query, &(0..6000).collect::<Vec<_>>(), rows, &mut nearest);
            let probed = nearest_cells(query, &cells.centroids, cells.header.probes);
            for hit in nearest.into_sorted() {
                wanted += 1;
                found += usize::from(probed.contains(&of_row[hit.slot as usize]));
            }
        }
        assert!(found as f64 >= 0.99 * f64::from(wanted), "{found} of {wanted}");
    }

    #[test]
    fn cells_do_not_depend_on_threads() {
        let rows = noise(2000, 16, 9);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Cells::with_cells(&rows, 16, 16, 30))
        };
        assert_eq!(on(1), on(4));
    }
}
