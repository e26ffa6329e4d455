use canonform_retrieval::*;

fn neighbors(distances: &[f64]) -> Vec<Neighbor> {
    distances.iter().enumerate().map(|(index, &distance)| Neighbor { index, distance }).collect()
}

#[test]
fn near_neighbors_outvote_many_far_ones() {
    let class = |i: usize| usize::from(i > 0);
    let near = neighbors(&[0.1, 0.9, 0.95]);
    let plain = vote(&near, class, 3, None);
    assert_eq!((plain.class(), plain.tally[0].votes, plain.voters), (Some(1), 2, 3));
    assert!((plain.tally[0].share - 2.0 / 3.0).abs() < 1e-15);
    let weighted = vote(&near, class, 3, Some(1.0));
    assert_eq!((weighted.class(), weighted.tally[0].votes), (Some(0), 1));
    assert!(weighted.tally[0].share > 0.9 && weighted.tally[1].class == 1, "the winner comes first");
}

#[test]
fn distant_neighbors_have_no_vote_and_the_nearest_breaks_a_tie() {
    let far = vote(&neighbors(&[2.0, 3.0]), |i| i, 2, Some(1.0));
    assert_eq!(far, Vote { voters: 0, tally: Vec::new() });
    assert_eq!(vote(&neighbors(&[2.0, 3.0]), |i| 7 - i, 2, None).class(), Some(7));
    assert_eq!(vote(&neighbors(&[0.0, 0.0]), |i| i, 2, Some(0.0)).class(), Some(0));
    assert_eq!(vote(&[], |i| i, 3, None).class(), None);
}
