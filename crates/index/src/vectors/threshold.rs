//! The threshold of unknown classes, from labelled vectors.

use rayon::prelude::*;

use super::cells::CHUNK;
use super::kernels::sq_distances_into;
use retrieval::UnknownThreshold;

/// Number of shapes used as queries.
const QUERIES: usize = 512;

/// The threshold from labelled vectors, see [`UnknownThreshold::of`]. `rows` have length `n`; `classes` holds the class
/// of each.
pub(crate) fn threshold(rows: &[f32], n: usize, classes: &[u32]) -> Option<UnknownThreshold> {
    let n_queries = QUERIES.min(classes.len());
    let queries: Vec<usize> = (0..n_queries).map(|i| (2 * i + 1) * classes.len() / (2 * n_queries)).collect();
    let start = || vec![[f32::INFINITY; 2]; n_queries];
    let least = |a: [f32; 2], b: [f32; 2]| [a[0].min(b[0]), a[1].min(b[1])];
    // All queries meet one chunk of rows before the next chunk is read.
    let nearest = rows
        .par_chunks(CHUNK * n)
        .zip(classes.par_chunks(CHUNK))
        .enumerate()
        .fold(start, |mut nearest, (i, (part, of))| {
            for (nearest, &query) in nearest.iter_mut().zip(&queries) {
                let found = own_and_foreign(
                    &rows[query * n..][..n],
                    part,
                    of,
                    classes[query],
                    query.checked_sub(i * CHUNK),
                );
                *nearest = least(*nearest, found);
            }
            nearest
        })
        .reduce(start, |a, b| a.into_iter().zip(b).map(|(a, b)| least(a, b)).collect());
    let [own, foreign] = [0, 1].map(|i| {
        let found = nearest.iter().map(|pair| f64::from(pair[i]).sqrt());
        found.filter(|distance| distance.is_finite()).collect::<Vec<_>>()
    });
    UnknownThreshold::of(&own, &foreign)
}

/// Squared distances from `query`, which is in class `own`, to the nearest of `rows` in that class and in any other.
/// Row `itself` does not count.
fn own_and_foreign(
    query: &[f32],
    rows: &[f32],
    classes: &[u32],
    own: u32,
    itself: Option<usize>,
) -> [f32; 2] {
    let mut nearest = [f32::INFINITY; 2];
    let mut sqs = [0.0; CHUNK];
    let sqs = &mut sqs[..classes.len()];
    sq_distances_into(query, rows, sqs);
    for (i, (sq, class)) in sqs.iter().zip(classes).enumerate() {
        let place = &mut nearest[usize::from(*class != own)];
        if *sq < *place && itself != Some(i) {
            *place = *sq;
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matches_the_threshold_from_all_pairs() {
        let positions = [0.0f32, 1.0, 2.5, 10.0, 11.0, 30.0];
        let rows: Vec<f32> = positions.iter().flat_map(|x| [&[*x][..], &[0.0; 15]].concat()).collect();
        let found = threshold(&rows, 16, &[0, 0, 0, 1, 1, 2]).unwrap();
        // Own: 1, 1, 1.5, 1, 1; foreign: 10, 9, 7.5, 7.5, 8.5, 19.
        assert_eq!(found, UnknownThreshold { distance: 4.5, missed: 0.0, mistaken: 0.0 });
        assert_eq!(threshold(&rows, 16, &[0, 1, 2, 3, 4, 5]), None);
        assert_eq!(threshold(&[], 16, &[]), None);
    }
}
