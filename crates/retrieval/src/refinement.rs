//! Nearest neighbors by an expensive distance with a cheap lower bound.

use rayon::prelude::*;

use crate::Neighbor;

/// The nearest shapes, and the work done to find them.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement<T> {
    /// At most k shapes, nearest first; ties by index. With each is what its evaluation found beside the distance.
    pub nearest: Vec<(Neighbor, T)>,
    /// Number of candidates whose distance was evaluated.
    pub evaluated: usize,
    /// Number of evaluations that were abandoned because the candidate was farther than the k nearest so far.
    pub abandoned: usize,
}

/// Candidates evaluated in parallel.
const BATCH: usize = 8;

/// The `k` candidates of smallest distance, evaluating as few distances as the bounds allow (Seidl and Kriegel
/// 1998, `seidl1998` in `REFERENCES.bib`).
///
/// `candidates` have lower bounds for distances and are in ascending order of them. The search ends at the first candidate whose bound exceeds
/// the k-th smallest distance so far. `distance(candidate, limit)` returns the distance and anything else that was found
/// with it, or `None` if it exceeds `limit`.
///
/// * Exact if the bounds are true lower bounds and `None` is only returned above the limit.
/// * Evaluates candidates in parallel batches of fixed size, so the evaluated set does not depend on the number of
///   threads.
///
/// # Errors
/// The first error of `distance` in the order of the candidates.
pub fn refine_nearest<T: Send, E: Send>(
    candidates: impl IntoIterator<Item = Neighbor>,
    k: usize,
    distance: impl Fn(Neighbor, f64) -> Result<Option<(f64, T)>, E> + Sync,
) -> Result<Refinement<T>, E> {
    let mut found = Refinement { nearest: Vec::new(), evaluated: 0, abandoned: 0 };
    let mut candidates = candidates.into_iter().peekable();
    if k == 0 {
        return Ok(found);
    }
    loop {
        let limit = match found.nearest.get(k - 1) {
            Some((last, _)) => last.distance,
            None => f64::INFINITY,
        };
        let mut batch = Vec::with_capacity(BATCH);
        while batch.len() < BATCH
            && let Some(next) = candidates.next_if(|candidate| candidate.distance <= limit)
        {
            batch.push(next);
        }
        if batch.is_empty() {
            break;
        }
        let distances: Vec<_> =
            batch.par_iter().map(|candidate| distance(*candidate, limit)).collect::<Result<_, E>>()?;
        found.evaluated += batch.len();
        for (candidate, distance) in batch.iter().zip(distances) {
            match distance {
                Some((distance, with)) => {
                    found.nearest.push((Neighbor { index: candidate.index, distance }, with));
                }
                None => found.abandoned += 1,
            }
        }
        found.nearest.sort_by(|(a, _), (b, _)| a.by_distance(b));
        found.nearest.truncate(k);
    }
    Ok(found)
}
