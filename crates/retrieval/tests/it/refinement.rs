use canonform_retrieval::{Neighbor, Refinement, refine_nearest};

use crate::scattered;

/// The first coordinate is a lower bound of the distance from the origin.
fn candidates(points: &[[f64; 2]]) -> Vec<Neighbor> {
    let mut all: Vec<_> =
        points.iter().enumerate().map(|(index, p)| Neighbor { index, distance: p[0] }).collect();
    all.sort_by(Neighbor::by_distance);
    all
}

#[test]
fn finds_what_evaluating_all_finds_with_fewer_evaluations() {
    let points = scattered(200);
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
        assert!(k != 10 || abandoning.abandoned > 0);
    }
    // Bounds that are distances leave one batch.
    let tight = refine_nearest::<_, ()>(all, 1, |c, _| Ok(Some((c.distance, ())))).unwrap();
    assert_eq!(tight.evaluated, 8);
}

#[test]
fn zero_neighbors_need_no_evaluation_and_errors_are_returned() {
    let none = refine_nearest::<(), ()>(candidates(&scattered(200)), 0, |_, _| Ok(None)).unwrap();
    assert_eq!(none, Refinement { nearest: Vec::new(), evaluated: 0, abandoned: 0 });
    let first = candidates(&scattered(200))[0].distance;
    let failed = refine_nearest::<(), _>(candidates(&scattered(200)), 3, |c, _| Err(c.distance));
    assert_eq!(failed.unwrap_err(), first);
}
