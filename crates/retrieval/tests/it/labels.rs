use canonform_retrieval::*;

#[test]
fn classes_are_sorted_and_small_ones_have_no_queries() {
    let labels = Labels::new(&["wolf", "cat", "cat", "shark", "cat", "wolf"]);
    assert_eq!(labels.classes(), ["cat", "shark", "wolf"]);
    assert_eq!((0..6).map(|i| labels.class(i)).collect::<Vec<_>>(), [2, 0, 0, 1, 0, 2]);
    assert_eq!(labels.size(0), 3);
    assert!(labels.is_query(1) && !labels.is_query(0) && !labels.is_query(3));
}
