//! Regions of surfaces with rounded edges.

use canonform_mesh::{RegionShape, SmoothRegions, TriMesh, shapes};

#[test]
fn planes_that_go_over_into_fillets_are_planes() {
    let mut rounded = shapes::cube(4);
    for p in &mut rounded.positions {
        let inner = p.map(|x| x.clamp(0.25, 0.75));
        *p = inner + 0.25 * (*p - inner).normalize();
    }
    let found = SmoothRegions::of(&rounded);
    let planes = found.all.iter().filter(|region| matches!(region.shape, RegionShape::Plane { .. }));
    assert_eq!((planes.count(), found.all.len(), found.is_mechanical), (6, 7, true));
    // Its quadrilaterals are as large as their neighbors.
    assert!(!SmoothRegions::of(&shapes::torus(24, 12, 2.0, 0.7)).is_mechanical);
}

#[test]
fn only_what_goes_around_an_axis_is_a_cylinder() {
    let radius = |mesh: &TriMesh| {
        SmoothRegions::of(mesh).all.into_iter().find_map(|region| match region.shape {
            RegionShape::Cylinder { radius, .. } => Some(radius),
            _ => None,
        })
    };
    let pipe = shapes::cylinder(20, 4, 1.5, 3.0);
    assert!((radius(&pipe).unwrap() - 1.5).abs() < 1e-9);
    // A shallow cone.
    let mut cone = shapes::cylinder(20, 4, 1.5, 3.0);
    cone.positions
        .iter_mut()
        .for_each(|p| *p = nalgebra::Point3::new(p.x * (2.0 + p.z), p.y * (2.0 + p.z), 0.02 * p.z));
    assert_eq!(radius(&cone), None);
}
