//! Division of vectors into cells.

use serde::{Deserialize, Serialize};

use super::kernels::sq_distances_into;
use super::kmeans::Centroids;
use super::nearest::{Hit, Nearest};
use retrieval::UnknownThreshold;

/// Up to this many vectors a search measures all of them, which is exact and takes less than two milliseconds.
pub(crate) const EXACT_LIMIT: usize = 50_000;

/// Sampled points per cell for k-means.
const SAMPLE: usize = 96;

/// Rows measured together.
const CHUNK: usize = 256;

/// What is known about the cells of an index, stored with them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct CellsHeader {
    /// Length of a vector.
    pub(crate) dim: usize,
    /// Number of vectors.
    pub(crate) n: usize,
    /// Number of cells.
    pub(crate) n_cells: usize,
    /// Number of vectors when the centres were chosen.
    pub(crate) n_trained: usize,
    /// Which cells a search scans.
    pub(crate) reach: Reach,
    /// Measured share of the ten nearest that such a search finds; 1 if it scans all cells.
    pub(crate) recall: f64,
    /// Distance beyond which a query belongs to no class of the index.
    pub(crate) threshold: Option<UnknownThreshold>,
}

impl CellsHeader {
    /// Whether a search scans all cells.
    pub(crate) fn is_exact(&self) -> bool {
        self.n_cells == 1
    }

    /// Whether the centres still serve an index of `n` vectors of this length. New ones are chosen whenever it has
    /// grown or shrunk by half, so the time this takes is proportional to the number of changes.
    pub(crate) fn serves(&self, n: usize, dim: usize) -> bool {
        let is_near = 2 * n <= 3 * self.n_trained && 3 * n >= 2 * self.n_trained;
        self.dim == dim && if n <= EXACT_LIMIT { self.n_cells == 1 } else { self.n_cells > 1 && is_near }
    }
}

/// The number of cells for `n` vectors.
pub(crate) fn n_cells(n: usize) -> usize {
    if n <= EXACT_LIMIT { 1 } else { 2 * n.isqrt() }
}

/// Centres of `n_cells` cells for `rows`, vectors padded to `n`, and the cell of each row. The result does not depend on
/// the number of threads.
pub(crate) fn divided(rows: &[f32], n: usize, n_cells: usize) -> (Centroids, Vec<u32>) {
    let n_rows = rows.len() / n;
    if n_cells < 2 || n_rows < n_cells {
        return (Centroids::new(vec![0.0; n], n), vec![0; n_rows]);
    }
    let n_sampled = (SAMPLE * n_cells).min(n_rows);
    let sample: Vec<f32> =
        (0..n_sampled).flat_map(|i| &rows[i * n_rows / n_sampled * n..][..n]).copied().collect();
    let centroids = Centroids::of(&sample, n_cells, n);
    drop(sample);
    let cells = centroids.assign(rows);
    (centroids, cells)
}

/// Which cells a search scans: of the nearest ones, those whose border is near enough.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reach {
    /// The most cells.
    pub(crate) probes: usize,
    /// How far a border may be, in distances of the tenth neighbour so far. Nothing is missed beyond 1, and little beyond
    /// a half, because few vectors are where the border is nearest.
    pub(crate) margin: f32,
}

impl Reach {
    /// Everything.
    pub(crate) const ALL: Self = Self { probes: u32::MAX as usize, margin: f32::INFINITY };
}

/// A cell near a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NearCell {
    pub(crate) cell: u32,
    /// Distance from the query to the border between this cell and the nearest one.
    pub(crate) border: f32,
}

/// The `most` cells nearest to `query`, nearest first.
pub(crate) fn nearest_cells(query: &[f32], centroids: &Centroids, most: usize) -> Vec<NearCell> {
    let mut gaps = vec![0.0; centroids.rows.len() / query.len()];
    sq_distances_into(query, &centroids.rows, &mut gaps);
    let mut nearest = Nearest::new(most.min(gaps.len()));
    nearest.offer_all(0, &gaps);
    let mut order: Vec<Hit> = nearest.into_hits().collect();
    order.sort_unstable();
    order.truncate(most);
    let centre = |hit: &Hit| &centroids.rows[hit.slot as usize * query.len()..][..query.len()];
    let Some(first) = order.first().copied() else { return Vec::new() };
    let border = |hit: &Hit| {
        let mut apart = [0.0];
        sq_distances_into(centre(&first), centre(hit), &mut apart);
        if apart[0] > 0.0 { 0.5 * (hit.sq - first.sq) / apart[0].sqrt() } else { 0.0 }
    };
    order.iter().map(|hit| NearCell { cell: hit.slot, border: border(hit) }).collect()
}

/// The `k` nearest in the cells within `reach`, each of which `scan` offers to what was found so far.
pub(crate) fn search_cells<E>(
    query: &[f32],
    centroids: &Centroids,
    reach: Reach,
    k: usize,
    mut scan: impl FnMut(u32, &mut Nearest) -> Result<(), E>,
) -> Result<Nearest, E> {
    let mut nearest = Nearest::new(k);
    for near in nearest_cells(query, centroids, reach.probes) {
        if near.border <= 0.0 || near.border <= reach.margin * nearest.bound().sqrt() {
            scan(near.cell, &mut nearest)?;
        }
    }
    Ok(nearest)
}

/// Offers `rows`, numbered from `first`, to `nearest`.
pub(crate) fn scan(query: &[f32], first: u32, rows: &[f32], nearest: &mut Nearest) {
    let mut sqs = [0.0; CHUNK];
    for (first, rows) in (first..).step_by(CHUNK).zip(rows.chunks(CHUNK * query.len())) {
        let sqs = &mut sqs[..rows.len() / query.len()];
        sq_distances_into(query, rows, sqs);
        nearest.offer_all(first, sqs);
    }
}

#[cfg(test)]
mod tests {
    use super::super::part::Part;
    use super::super::testing::{clustered, noise};
    use super::super::trials::Trials;
    use super::*;

    #[test]
    fn few_vectors_form_one_cell() {
        for n in [0, 7] {
            let (centroids, cells) = divided(&noise(n, 16, 2), 16, n_cells(n));
            assert_eq!((centroids.rows.len(), cells), (16, vec![0; n]));
        }
        assert_eq!((n_cells(EXACT_LIMIT), n_cells(1_000_000)), (1, 2000));
    }

    #[test]
    fn centres_serve_until_the_index_has_grown_or_shrunk_by_half() {
        let header = |n_cells, n_trained| CellsHeader {
            dim: 3,
            n: n_trained,
            n_cells,
            n_trained,
            reach: Reach::ALL,
            recall: 1.0,
            threshold: None,
        };
        let large = header(632, 100_000);
        let serves = [66_666, 66_667, 150_000, 150_001].map(|n| large.serves(n, 3));
        assert_eq!(serves, [false, true, true, false]);
        assert!(!large.serves(100_000, 4) && !large.serves(EXACT_LIMIT, 3));
        let small = header(1, 10);
        assert!(small.serves(0, 3) && small.serves(EXACT_LIMIT, 3) && !small.serves(EXACT_LIMIT + 1, 3));
    }

    #[test]
    fn the_recall_holds_for_vectors_that_are_not_in_the_index() {
        let (all, _) = clustered(6200, 300, 16, 0.3);
        let (rows, queries) = all.split_at(6000 * 16);
        let (centroids, of_row) = divided(rows, 16, 80);
        let mut shapes = Part::default();
        rows.chunks(16).enumerate().for_each(|(i, row)| shapes.push(&i.to_string(), "", row));
        let trials = Trials::of(&shapes, &of_row, 80);
        let (reach, recall) = trials.calibrated(&centroids);
        assert!(recall >= 0.99, "{recall} with {reach:?}");
        let (mut found, mut wanted, mut scanned) = (0, 0, 0);
        for query in queries.chunks(16) {
            let mut truth = Nearest::new(10);
            scan(query, 0, rows, &mut truth);
            let Ok(nearest) = search_cells(query, &centroids, reach, 10, |cell, nearest| {
                scanned += 1;
                for i in (0..6000).filter(|i| of_row[*i] == cell) {
                    scan(query, i as u32, &rows[i * 16..][..16], nearest);
                }
                Ok::<_, std::convert::Infallible>(())
            });
            let [truth, nearest] = [truth, nearest].map(|hits| hits.into_hits().collect::<Vec<_>>());
            wanted += truth.len();
            found += truth.iter().filter(|hit| nearest.contains(hit)).count();
        }
        assert!(found as f64 >= 0.985 * wanted as f64, "{found} of {wanted}");
        assert!(scanned < 200 * 40, "{scanned} cells for 200 queries");
    }

    #[test]
    fn borders_are_half_way_between_centres() {
        let row = |x: f32| [&[x][..], &[0.0; 15]].concat();
        let centroids = Centroids::new([row(0.0), row(4.0), row(-6.0), row(0.0)].concat(), 16);
        let found: Vec<(u32, f32)> =
            nearest_cells(&row(1.0), &centroids, 4).iter().map(|near| (near.cell, near.border)).collect();
        assert_eq!(found, [(0, 0.0), (3, 0.0), (1, 1.0), (2, 4.0)]);
        assert_eq!(nearest_cells(&row(1.0), &centroids, 3).len(), 3);
    }

    #[test]
    fn cells_do_not_depend_on_threads() {
        let rows = noise(2000, 16, 9);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| divided(&rows, 16, 30))
        };
        assert_eq!(on(1), on(4));
    }
}
