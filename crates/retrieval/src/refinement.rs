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

#[cfg(test)]
mod tests {
    use super::*;

    /// Points in the plane; the first coordinate is a lower bound of the distance from the origin.
    fn points() -> Vec<[f64; 2]> {
        (0..200).map(f64::from).map(|i| [(i * 0.618).fract() * 9.0, (i * 0.414).fract() * 4.0]).collect()
    }

    fn candidates(points: &[[f64; 2]]) -> Vec<Neighbor> {
        let mut all: Vec<_> =
            points.iter().enumerate().map(|(index, p)| Neighbor { index, distance: p[0] }).collect();
        all.sort_by(Neighbor::by_distance);
        all
    }

    #[test]
    fn finds_what_evaluating_all_finds_with_fewer_evaluations() {
        let points = points();
        let true_distance = |i: usize| points[i][0].hypot(points[i][1]);
        let mut all: Vec<_> =
            (0..points.len()).map(|index| Neighbor { index, distance: true_distance(index) }).collect();
        all.sort_by(Neighbor::by_distance);
        for k in [1, 3, 10, 200, 500] {
            let whole = refine_nearest::<_, ()>(candidates(&points), k, |c, _| {
                Ok(Some((true_distance(c.index), c.index)))
            });
            let abandoning = refine_nearest::<_, ()>(candidates(&points), k, |c, limit| {
                Ok(Some((true_distance(c.index), c.index)).filter(|(d, _)| *d <= limit))
            });
            let (whole, abandoning) = (whole.unwrap(), abandoning.unwrap());
            let expected = all.iter().take(k).map(|near| (*near, near.index));
            assert!(whole.nearest.iter().copied().eq(expected));
            assert_eq!(abandoning.nearest, whole.nearest);
            assert_eq!((whole.abandoned, abandoning.evaluated), (0, whole.evaluated));
            assert!(k >= 200 || whole.evaluated < 200, "{k}: {}", whole.evaluated);
        }
    }

    #[test]
    fn zero_neighbors_need_no_evaluation_and_errors_are_returned() {
        let none = refine_nearest::<(), ()>(candidates(&points()), 0, |_, _| Ok(None)).unwrap();
        assert_eq!(none, Refinement { nearest: Vec::new(), evaluated: 0, abandoned: 0 });
        let first = candidates(&points())[0].distance;
        let failed = refine_nearest::<(), _>(candidates(&points()), 3, |c, _| Err(c.distance));
        assert_eq!(failed.unwrap_err(), first);
    }
}
