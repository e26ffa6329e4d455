use std::fs::File;

use base::{Budget, Exceeded};
use canonform_linalg::{ColumnStore, LinalgError};

fn stores(n_rows: usize) -> [ColumnStore; 2] {
    [ColumnStore::in_memory(n_rows), ColumnStore::in_file(n_rows, tempfile::tempfile().unwrap())]
}

#[test]
fn both_places_hold_the_same_numbers() {
    // More numbers than are converted at a time, and not a multiple of that.
    let n_rows = (2 << 13) + 17;
    let number = |i: usize, j: usize| ((i * 7 + j * 13) as f64).sin() / 3.0;
    let found = stores(n_rows).map(|mut store| {
        let slots = store.grow(3, &()).unwrap();
        for (j, slot) in slots.into_iter().enumerate().rev() {
            slot.fill(|column| {
                column.iter_mut().enumerate().for_each(|(i, x)| *x = number(i, j));
                Ok(())
            })
            .unwrap();
        }
        store.push(&vec![1.5; n_rows]).unwrap();
        store.truncate(4);
        assert_eq!(store.rows(5..9).unwrap().row(3)[2], number(8, 2));
        assert_eq!(store.column(1).unwrap()[n_rows - 1], number(n_rows - 1, 1));
        assert_eq!(store.first(2).n_columns(), 2);
        store.rows(0..0).unwrap();
        store.rows(0..n_rows).unwrap()
    });
    assert_eq!(found[0], found[1]);
    assert_eq!((found[0].ncols(), found[0][(3, 3)]), (4, 1.5));
}

#[test]
fn a_file_that_cannot_be_written_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("numbers");
    std::fs::write(&path, "").unwrap();
    let mut store = ColumnStore::in_file(2, File::open(&path).unwrap());
    assert!(matches!(store.push(&[1.0, 2.0]), Err(LinalgError::File { .. })));
}

#[test]
fn memory_is_limited_and_files_are_not() {
    let small = Budget::unlimited().with_memory(100);
    let [mut memory, mut file] = stores(10);
    assert!(matches!(memory.grow(2, &small), Err(LinalgError::Exceeded(Exceeded::Memory { .. }))));
    assert_eq!(memory.n_columns(), 0);
    let refused = ColumnStore::in_memory(usize::MAX).reserve(2, &());
    assert!(matches!(refused, Err(LinalgError::Exceeded(Exceeded::Allocation { .. }))));
    assert_eq!(file.grow(2, &small).unwrap().len(), 2);
}
