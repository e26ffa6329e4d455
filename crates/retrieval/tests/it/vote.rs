use canonform_retrieval::*;

fn neighbors(distances: &[f64]) -> Vec<Neighbor> {
    distances.iter().enumerate().map(|(index, &distance)| Neighbor { index, distance }).collect()
}

#[test]
fn near_neighbors_outvote_many_far_ones() {
    let class = |i: usize| [0, 1, 1, 2, 3][i];
    let distances = [0.2, 1.8, 1.9, 2.0, 2.0];
    let plain = vote(&neighbors(&distances), class, 5, None);
    assert_eq!((plain.class(), plain.tally[0].votes, plain.voters), (Some(1), 2, 5));
    assert!((plain.tally[0].share - 2.0 / 5.0).abs() < 1e-15);
    let weighted = vote(&neighbors(&distances), class, 5, Some(2.0));
    let order = [weighted.tally[0].class, weighted.tally[1].class];
    assert_eq!((order, weighted.tally[0].votes), ([0, 1], 1));
    let weights = distances.map(|d| (1.0 - d * d / 4.0).powi(2));
    assert!((weighted.tally[0].share - weights[0] / weights.iter().sum::<f64>()).abs() < 1e-15);
    // At the limit no vote has any weight, so that all count.
    let tally = vote(&neighbors(&[2.0; 3]), class, 3, Some(2.0)).tally;
    assert!(tally[0].class == 1 && (tally[0].share - 2.0 / 3.0).abs() < 1e-15);
}

#[test]
fn distant_neighbors_have_no_vote_and_the_nearest_breaks_a_tie() {
    let far = vote(&neighbors(&[2.0, 3.0]), |i| i, 2, Some(1.0));
    assert_eq!(far, Vote { voters: 0, tally: Vec::new() });
    assert_eq!(vote(&neighbors(&[2.0, 3.0]), |i| 7 - i, 2, None).class(), Some(7));
    assert_eq!(vote(&neighbors(&[0.0, 0.0]), |i| i, 2, Some(0.0)).class(), Some(0));
    assert_eq!(vote(&[], |i| i, 3, None).class(), None);
}
