use canonform_retrieval::{GraphRankings, LINKS, Neighbor, Rankings, graph_rank, rank};
use linalg::DistanceMatrix;

use crate::scattered;

fn matrix(n: usize, distance: impl Fn(usize, usize) -> f64 + Sync) -> DistanceMatrix {
    DistanceMatrix::from_pairs(n, distance).unwrap()
}

fn apart(points: &[[f64; 2]]) -> DistanceMatrix {
    matrix(points.len(), |i, j| (points[i][0] - points[j][0]).hypot(points[i][1] - points[j][1]))
}

/// The nearest others of a shape.
fn links(distances: &DistanceMatrix, shape: usize) -> Vec<Neighbor> {
    rank(distances, shape).into_iter().take(LINKS).collect()
}

#[test]
fn rank_distances_of_neighbors_and_of_shapes_without_a_common_neighbor_follow_their_definition() {
    let points = scattered(200);
    let distances = apart(&points);
    let plain = rank(&distances, 7);
    let found = graph_rank(7, &plain, |i| links(&distances, i), |i| distances.get(7, i));
    assert_eq!(found.len(), 199);
    assert!(found.windows(2).all(|pair| pair[0].rank_distance <= pair[1].rank_distance));
    assert!(found.iter().all(|near| (0.0..1.0).contains(&near.rank_distance)));
    // The distance counts three fifths, and what neighborhoods do not share two.
    let weights = |shape: usize| {
        let links = links(&distances, shape);
        let scale = links.iter().map(|near| near.distance).sum::<f64>() / LINKS as f64;
        let mut weights = vec![0.0; 200];
        weights[shape] = 1.0;
        links.iter().for_each(|near| weights[near.index] = (-(near.distance / (0.5 * scale)).powi(2)).exp());
        (scale, weights)
    };
    let (scale, own) = weights(7);
    for (at, near) in found.iter().enumerate() {
        let (x, (_, its)) = (near.distance / scale, weights(near.index));
        let sum = |of: fn(f64, f64) -> f64| own.iter().zip(&its).map(|(a, b)| of(*a, *b)).sum::<f64>();
        let apart = match plain[..LINKS].iter().any(|link| link.index == near.index) {
            true => 1.0 - sum(f64::min) / sum(f64::max),
            false if at >= 119 => 1.0,
            false => continue,
        };
        assert!((near.rank_distance - (0.6 * x / (1.0 + x) + 0.4 * apart)).abs() < 1e-12);
    }
}

#[test]
fn a_query_finds_the_same_before_and_after_it_is_added() {
    let points = scattered(150);
    let (all, rest) = (apart(&points), apart(&points[..149]));
    // The query is the last row of the larger matrix.
    let nearest = rank(&all, 149);
    let distance = |i: usize| all.get(149, i);
    let inside = graph_rank(149, &nearest, |i| links(&all, i), distance);
    for few in [LINKS, 40, 149] {
        let outside = graph_rank(999, &nearest[..few], |i| links(&rest, i), distance);
        for near in &outside {
            let same = inside.iter().find(|other| other.index == near.index).unwrap();
            assert!(
                (same.rank_distance - near.rank_distance).abs() < 1e-12 && same.distance == near.distance
            );
        }
        assert!(outside.len() >= few && (few < 149 || outside.len() == 149));
    }
}

#[test]
fn scale_changes_no_ranking_and_equal_shapes_are_nearest() {
    let points = scattered(60);
    let near = apart(&points);
    let far = matrix(60, |i, j| 1e3 * near.get(i, j));
    let order = |distances: &DistanceMatrix| -> Vec<Vec<usize>> {
        let graph = GraphRankings::new(distances);
        (0..60).map(|i| graph.ranking(i).iter().map(|near| near.index).collect()).collect()
    };
    assert_eq!(order(&near), order(&far));
    // Thirty copies of one shape have a scale of 0.
    let copies = matrix(33, |i, j| if i < 30 && j < 30 { 0.0 } else { 1.0 + (i % 7) as f64 });
    let found = GraphRankings::new(&copies).ranking(3);
    assert!(found[..29].iter().all(|near| near.index < 30));
    assert!(found[29..].iter().all(|near| near.distance.is_finite()));
    assert!(GraphRankings::new(&matrix(1, |_, _| 0.0)).ranking(0).is_empty());
}
