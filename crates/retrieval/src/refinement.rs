//! The nearest by a distance that is expensive, found through one that is cheap.

use rayon::prelude::*;

/// A shape that may be among the nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Which shape.
    pub index: usize,
    /// What its distance is at least.
    pub bound: f64,
}

/// A shape with its distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbor {
    /// Which shape.
    pub index: usize,
    /// How far it is.
    pub distance: f64,
}

/// The nearest shapes, and what it took to find them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Refinement {
    /// Up to k of them, nearest first; ties by index.
    pub nearest: Vec<Neighbor>,
    /// Candidates whose distance was asked for.
    pub asked: usize,
    /// Those among them that were given up as farther than the k nearest known then.
    pub abandoned: usize,
}

/// Candidates that are asked for at once.
const BATCH: usize = 8;

/// The `k` candidates of least distance, asking for as few distances as bounds allow (Seidl and Kriegel 1998,
/// `seidl1998` in `REFERENCES.bib`).
///
/// Candidates come in ascending order of their bounds. Once the bound of the next one is larger than the k-th
/// distance known, none that follows can be among the nearest, and the search ends. `distance(index, limit)`
/// gives the distance of a candidate, or `None` if that is larger than `limit`.
///
/// * Exact if bounds and `None` are true: the result is then that of asking for all distances.
/// * Candidates are asked for in parallel, in batches of fixed size: what is asked for does not depend on the
///   number of threads.
///
/// # Errors
/// Whatever `distance` returns, the first in the order of the candidates.
pub fn refine_nearest<E: Send>(
    candidates: impl IntoIterator<Item = Candidate>,
    k: usize,
    distance: impl Fn(Candidate, f64) -> Result<Option<f64>, E> + Sync,
) -> Result<Refinement, E> {
    let mut found = Refinement::default();
    let mut candidates = candidates.into_iter().peekable();
    if k == 0 {
        return Ok(found);
    }
    loop {
        let limit = match found.nearest.get(k - 1) {
            Some(last) => last.distance,
            None => f64::INFINITY,
        };
        let mut batch = Vec::with_capacity(BATCH);
        while batch.len() < BATCH
            && let Some(next) = candidates.next_if(|candidate| candidate.bound <= limit)
        {
            batch.push(next);
        }
        if batch.is_empty() {
            break;
        }
        let distances: Vec<_> =
            batch.par_iter().map(|candidate| distance(*candidate, limit)).collect::<Result<_, E>>()?;
        found.asked += batch.len();
        for (candidate, distance) in batch.iter().zip(distances) {
            match distance {
                Some(distance) => found.nearest.push(Neighbor { index: candidate.index, distance }),
                None => found.abandoned += 1,
            }
        }
        found.nearest.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.index.cmp(&b.index)));
        found.nearest.truncate(k);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a plane; the first coordinate bounds the distance from the origin.
    fn points() -> Vec<[f64; 2]> {
        (0..200).map(f64::from).map(|i| [(i * 0.618).fract() * 9.0, (i * 0.414).fract() * 4.0]).collect()
    }

    fn candidates(points: &[[f64; 2]]) -> Vec<Candidate> {
        let mut all: Vec<_> =
            points.iter().enumerate().map(|(index, p)| Candidate { index, bound: p[0] }).collect();
        all.sort_by(|a, b| a.bound.total_cmp(&b.bound));
        all
    }

    #[test]
    fn it_finds_what_asking_for_all_finds_and_asks_for_fewer() {
        let points = points();
        let true_distance = |i: usize| points[i][0].hypot(points[i][1]);
        let mut all: Vec<_> =
            (0..points.len()).map(|index| Neighbor { index, distance: true_distance(index) }).collect();
        all.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.index.cmp(&b.index)));
        for k in [1, 3, 10, 200, 500] {
            let whole = refine_nearest::<()>(candidates(&points), k, |c, _| Ok(Some(true_distance(c.index))));
            let abandoning = refine_nearest::<()>(candidates(&points), k, |c, limit| {
                Ok(Some(true_distance(c.index)).filter(|d| *d <= limit))
            });
            let (whole, abandoning) = (whole.unwrap(), abandoning.unwrap());
            assert_eq!(whole.nearest, all[..k.min(all.len())]);
            assert_eq!(abandoning.nearest, whole.nearest);
            assert_eq!((whole.abandoned, abandoning.asked), (0, whole.asked));
            assert!(k >= 200 || whole.asked < 200, "{k}: {}", whole.asked);
        }
    }

    #[test]
    fn nothing_is_asked_for_nothing_and_faults_come_through() {
        let none = refine_nearest::<()>(candidates(&points()), 0, |_, _| Ok(None)).unwrap();
        assert_eq!(none, Refinement::default());
        assert_eq!(refine_nearest(candidates(&points()), 3, |c, _| Err(c.bound)).unwrap_err(), {
            candidates(&points())[0].bound
        });
    }
}
