//! Laws of boundaries.

use canonform_mesh::{ComponentPolicy, RepairOptions, Surface, shapes};

#[test]
fn boundaries_are_measured_one_by_one() {
    let length = |mesh| Surface::new(&mesh, &Default::default(), &()).unwrap().longest_boundary();
    assert_eq!(length(shapes::icosphere(2)), 0.0);
    let (large, small) = (shapes::grid(11, 6, 0.1), shapes::grid(3, 3, 0.1));
    assert!((length(large.clone()) - 3.0).abs() < 1e-9);
    let bridged = RepairOptions { components: ComponentPolicy::Bridge, ..Default::default() };
    let two = Surface::new(&shapes::disjoint(&[large, small]), &bridged, &()).unwrap();
    assert!((two.longest_boundary() - 3.0).abs() < 1e-9);
}
