//! Distances of all pairs, in parallel.

use linalg::DistanceMatrix;
use rayon::prelude::*;

use crate::RetrievalError;

/// Evaluates `distance(i, j)` for all pairs `i < j` of `n` shapes in parallel, and calls `done` after each pair,
/// from any thread.
///
/// The result does not depend on the number of threads.
///
/// # Errors
/// The first error of `distance` in the order of the pairs; [`RetrievalError::Linalg`] if a distance is NaN,
/// infinite or negative.
pub fn pairwise_distances<E: From<RetrievalError> + Send>(
    n: usize,
    distance: impl Fn(usize, usize) -> Result<f64, E> + Sync,
    done: impl Fn() + Sync,
) -> Result<DistanceMatrix, E> {
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).collect();
    let values: Vec<Result<f64, E>> = pairs
        .par_iter()
        .map(|&(i, j)| {
            let value = distance(i, j);
            done();
            value
        })
        .collect();
    let values = values.into_iter().collect::<Result<Vec<f64>, E>>()?;
    let mut next = values.into_iter();
    DistanceMatrix::from_pairs(n, |_, _| next.next().unwrap_or(f64::NAN))
        .map_err(|error| E::from(RetrievalError::from(error)))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn each_pair_is_evaluated_once() {
        let calls = AtomicUsize::new(0);
        let matrix = pairwise_distances::<RetrievalError>(
            7,
            |i, j| Ok((10 * i + j) as f64),
            || {
                calls.fetch_add(1, Ordering::Relaxed);
            },
        )
        .unwrap();
        assert_eq!(calls.into_inner(), 21);
        assert_eq!((matrix.get(2, 5), matrix.get(5, 2), matrix.get(3, 3)), (25.0, 25.0, 0.0));
    }

    #[test]
    fn the_first_error_is_returned() {
        let error = |i, j| RetrievalError::BadNeighborCount { k: i, available: j };
        let result = pairwise_distances(5, |i, j| if i > 0 { Err(error(i, j)) } else { Ok(1.0) }, || ());
        assert_eq!(result, Err(error(1, 2)));
        let nan = pairwise_distances::<RetrievalError>(2, |_, _| Ok(f64::NAN), || ());
        assert!(matches!(nan, Err(RetrievalError::Linalg(_))));
    }
}
