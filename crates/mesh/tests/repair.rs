//! Laws of repair, and each of its errors.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

use canonform_mesh::{
    ComponentPolicy, MeshError, Orient, RepairOptions, Repaired, TriMesh, Weld, repair, shapes, validate,
};
use nalgebra::{Point3, Rotation3, Vector3};
use proptest::prelude::*;
use surface::{VertexId, components_with_links};

fn mesh(points: &[[f64; 3]], faces: &[[u32; 3]]) -> TriMesh {
    TriMesh {
        positions: points.iter().map(|&p| Point3::from(p)).collect(),
        faces: faces.iter().map(|f| f.map(VertexId)).collect(),
    }
}

fn mend(mesh: &TriMesh) -> Repaired {
    repair(mesh, &RepairOptions::default()).unwrap()
}

fn with(components: ComponentPolicy, weld: Weld, orient: Orient) -> RepairOptions {
    RepairOptions { components, weld, orient }
}

fn shifted(mut mesh: TriMesh, by: [f64; 3]) -> TriMesh {
    mesh.positions.iter_mut().for_each(|p| *p += Vector3::from(by));
    mesh
}

/// The vertex that each input vertex became, -1 for none.
fn fates(repaired: &Repaired) -> Vec<i64> {
    repaired.input_to_repaired.iter().map(|to| to.map_or(-1, |v| i64::from(v.0))).collect()
}

/// The same faces, each with vertices of its own.
fn soup(mesh: &TriMesh) -> TriMesh {
    let positions: Vec<_> = (0..mesh.n_faces()).flat_map(|f| mesh.triangle(f)).collect();
    let faces = (0..mesh.n_faces()).map(|f| [3 * f, 3 * f + 1, 3 * f + 2].map(VertexId::from));
    TriMesh { faces: faces.collect(), positions }
}

#[test]
fn a_clean_mesh_is_returned_unchanged() {
    for clean in [shapes::grid(5, 4, 1.0), shapes::torus(9, 7, 2.0, 0.5), shapes::cylinder(9, 3, 1.0, 2.0)] {
        let repaired = mend(&clean);
        assert_eq!(repaired.mesh, clean);
        assert!(repaired.report.summary().is_empty());
        assert!(repaired.report.summary().is_empty());
        assert!(repaired.input_to_repaired.iter().enumerate().all(|(v, to)| *to == Some(VertexId::from(v))));
    }
}

#[test]
fn degenerate_duplicate_and_unused_items_are_removed_and_the_rest_keeps_its_order() {
    let points: Vec<[f64; 3]> = (0..8).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
    let dirty = mesh(&points, &[[5, 3, 1], [1, 1, 3], [3, 1, 5], [3, 5, 6], [7, 7, 7], [6, 5, 3]]);
    let repaired = mend(&dirty);
    let report = &repaired.report;
    assert_eq!((report.degenerate_faces, report.duplicate_faces, report.unreferenced_vertices), (2, 2, 4));
    assert_eq!(fates(&repaired), [-1, 0, -1, 1, -1, 2, 3, -1]);
    assert_eq!(report.dropped_vertices, [0, 2, 4, 7].map(VertexId));
    assert_eq!(repaired.mesh.faces, [[2, 1, 0], [1, 2, 3]].map(|f| f.map(VertexId)));
    let expected = [
        "2 faces with a repeated vertex removed",
        "2 duplicate faces removed",
        "4 vertices without a face dropped",
    ];
    assert_eq!(report.summary(), expected);
    assert!(!report.summary().is_empty());
}

#[test]
fn slivers_stay_and_edges_of_length_zero_collapse_without_a_slit() {
    let flat = mesh(&[[0., 0., 0.], [1., 0., 0.], [2., 0., 0.], [1., 1., 0.]], &[[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mend(&flat).mesh, flat);

    // A strip whose middle edge has length zero and ends inside the boundary.
    let mut strip = shapes::grid(4, 3, 1.0);
    strip.positions[6] = strip.positions[5];
    let options = with(ComponentPolicy::Error, Weld::None, Orient::Keep);
    let repaired = repair(&strip, &options).unwrap();
    assert_eq!((repaired.report.collapsed_vertices, repaired.report.zero_length_faces), (1, 2));
    assert_eq!(repaired.input_to_repaired[5], repaired.input_to_repaired[6]);
    let after = validate(&repaired.mesh);
    assert_eq!((after.n_boundary_loops, after.duplicate_vertices, after.n_components), (1, 0, 1));
    assert!(after.min_edge_length > 0.0);
}

#[test]
fn welding_follows_its_policy() {
    // Two adjacent sheets whose common boundary has the same positions but separate vertices.
    let left = shapes::grid(3, 3, 1.0);
    let halves = shapes::disjoint(&[left.clone(), shifted(left.clone(), [2.0, 0.0, 0.0])]);
    let joined = mend(&halves);
    assert_eq!((joined.report.welded_vertices, joined.report.dropped_components), (3, 0));
    assert_eq!(joined.mesh.n_vertices(), 15);
    let after = validate(&joined.mesh);
    assert_eq!((after.n_components, after.n_boundary_loops, after.duplicate_vertices), (1, 1, 0));
    let apart = repair(&halves, &with(ComponentPolicy::Bridge, Weld::None, Orient::Keep)).unwrap();
    assert_eq!((apart.mesh.n_vertices(), apart.report.bridge_length), (18, 0.0));

    // Two closed surfaces that touch in a point stay separate, unless all vertices are welded.
    let cubes = shapes::disjoint(&[shapes::cube(0), shifted(shapes::cube(0), [1.0, 1.0, 1.0])]);
    assert_eq!(mend(&cubes).report.dropped_components, 1);
    let all = repair(&cubes, &with(ComponentPolicy::Error, Weld::All, Orient::Keep)).unwrap();
    assert_eq!((all.report.welded_vertices, all.mesh.n_vertices()), (1, 15));
    // Minus zero is zero.
    let mut negative = shapes::disjoint(&[left.clone(), shifted(left, [-2.0, 0.0, 0.0])]);
    negative.positions[0].x = -0.0;
    assert_eq!(mend(&negative).report.welded_vertices, 3);
}

#[test]
fn a_triangle_soup_is_welded_into_its_surface() {
    let sphere = shapes::icosphere(2);
    let stitched = mend(&soup(&sphere));
    assert_eq!(validate(&stitched.mesh).genus, Some(0));
    assert_eq!(stitched.mesh.n_vertices(), sphere.n_vertices());
}

#[test]
fn the_largest_component_is_the_one_of_the_largest_area() {
    let fine_but_small = shifted(shapes::icosphere(3), [9.0, 0.0, 0.0]);
    let coarse_but_large = shapes::grid(3, 3, 5.0);
    let both = shapes::disjoint(&[fine_but_small.clone(), coarse_but_large.clone()]);
    let repaired = mend(&both);
    assert_eq!(repaired.mesh, coarse_but_large);
    let report = &repaired.report;
    assert_eq!((report.components, report.dropped_components), (2, 1));
    assert_eq!(report.dropped_component_faces, fine_but_small.n_faces());
    assert_eq!(report.dropped_component_vertices, fine_but_small.n_vertices());
    assert_eq!(report.dropped_vertices.len(), fine_but_small.n_vertices());
    let share = fine_but_small.area() / both.area();
    assert!((report.dropped_area_share - share).abs() < 1e-12);
    let summary = report.summary().remove(0);
    assert!(summary.starts_with("1 of 2 components dropped, 1280 faces and 642 vertices with "), "{summary}");
    let speck = TriMesh { faces: coarse_but_large.faces[..1].to_vec(), ..coarse_but_large.clone() };
    let summary = mend(&shapes::disjoint(&[shapes::icosphere(5), speck])).report.summary();
    assert!(summary.iter().any(|line| line.contains("dropped, 1 face and 3 vertices with")), "{summary:?}");
    // The first one in case of a tie.
    let twins = shapes::disjoint(&[shapes::cube(1), shifted(shapes::cube(1), [3.0, 0.0, 0.0])]);
    assert_eq!(mend(&twins).mesh.positions, shapes::cube(1).positions);
}

#[test]
fn bridges_are_the_shortest_links_and_part_of_the_intrinsic_mesh() {
    let sheet = shapes::grid(3, 3, 1.0);
    let places = [[0.0, 0.0, 0.0], [2.5, 0.0, 0.0], [0.0, 2.0, 0.75], [9.0, 0.0, 0.0]];
    let loose = Point3::new(4.0, 4.0, 4.0);
    let mut sheets = shapes::disjoint(&places.map(|by| shifted(sheet.clone(), by)));
    sheets.positions.insert(0, loose);
    sheets.faces.iter_mut().flatten().for_each(|v| v.0 += 1);
    let repaired = repair(&sheets, &with(ComponentPolicy::Bridge, Weld::Seams, Orient::Keep)).unwrap();
    let mut lengths: Vec<f64> = repaired.links.iter().map(|link| link.length).collect();
    lengths.sort_by(f64::total_cmp);
    // Three links across each of the two narrow gaps, one across the wide gap.
    assert_eq!(lengths, [0.5, 0.5, 0.5, 0.75, 0.75, 0.75, 4.5]);
    assert_eq!(repaired.report.bridge_length, 8.25);
    for (link, in_input) in repaired.links.iter().zip(&repaired.report.bridges) {
        assert_eq!(link.ends.map(|v| v.0 + 1), in_input.ends.map(|v| v.0));
        let [p, q] = link.ends.map(|v| repaired.mesh.positions[v.index()]);
        assert_eq!((q - p).norm(), link.length);
    }
    assert_eq!(repaired.mesh.faces.len(), sheets.faces.len());
    assert_eq!(repaired.intrinsic().links(), repaired.links);
    let summary = repaired.report.summary();
    assert_eq!(summary[1], "4 components joined by 7 links of total length 8.250000");
}

#[test]
fn orientation_is_touched_only_on_request() {
    let mut sphere = shapes::icosphere(1);
    sphere.faces[3].swap(0, 1);
    assert_eq!(mend(&sphere).mesh, sphere);
    let oriented = repair(&sphere, &with(ComponentPolicy::Error, Weld::None, Orient::Consistent)).unwrap();
    assert_eq!(oriented.report.flipped_faces, 1);
    assert_eq!(validate(&oriented.mesh).inconsistent_edges, 0);
    assert_eq!(oriented.report.summary(), ["1 face flipped"]);
}

#[test]
fn unusable_meshes_are_errors() {
    let cube = shapes::cube(0);
    let two = shapes::disjoint(&[shapes::tetrahedron(0), shifted(cube.clone(), [9.0, 0.0, 0.0])]);
    let error = repair(&two, &with(ComponentPolicy::Error, Weld::None, Orient::Keep)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the mesh is disconnected: 4 of 12 vertices lie outside the largest component"
    );
    let fails = |change: &dyn Fn(&mut TriMesh)| {
        let mut mesh = cube.clone();
        change(&mut mesh);
        repair(&mesh, &RepairOptions::default()).unwrap_err()
    };
    let infinite = fails(&|m| m.positions[3].z = f64::NEG_INFINITY);
    assert!(matches!(infinite, MeshError::NonFinitePosition { vertex: VertexId(3) }));
    let out = fails(&|m| m.faces[2][0] = VertexId(99));
    assert!(matches!(out, MeshError::FaceOutOfRange { face: 2, vertex: VertexId(99), n_vertices: 8 }));
    assert!(matches!(fails(&|m| m.positions[0].x = 1e200), MeshError::OutOfRange { .. }));
    assert!(matches!(fails(&|m| m.positions[0].x = f64::MAX), MeshError::OutOfRange { .. }));
    assert!(matches!(fails(&|m| m.faces.clear()), MeshError::NoUsableFace { n_faces: 0, degenerate: 0 }));
    let pointlike = fails(&|m| m.positions.iter_mut().for_each(|p| *p = Point3::origin()));
    assert!(matches!(pointlike, MeshError::NoUsableFace { n_faces: 12, degenerate: 12 }));
    let named_twice = fails(&|m| m.faces.iter_mut().for_each(|f| f[0] = f[1]));
    assert!(matches!(named_twice, MeshError::NoUsableFace { n_faces: 12, degenerate: 12 }));
}

#[test]
fn the_report_serialises() {
    let json = serde_json::to_value(mend(&shapes::grid(2, 2, 1.0)).report).unwrap();
    assert_eq!(json["output_vertices"], 4);
    assert_eq!(json["dropped_vertices"], serde_json::json!([]));
    let options: RepairOptions = serde_json::from_str(r#"{"components": "bridge", "weld": "all"}"#).unwrap();
    assert_eq!(options, with(ComponentPolicy::Bridge, Weld::All, Orient::Keep));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Meshes on a small lattice have many coincident points, duplicate and degenerate faces.
    #[test]
    fn any_mesh_is_repaired_or_an_error(
        points in prop::collection::vec(prop::array::uniform3(0i8..3), 1..25),
        corners in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 0..60),
        policy in prop::sample::select(vec![ComponentPolicy::Largest, ComponentPolicy::Bridge]),
        weld in prop::sample::select(vec![Weld::None, Weld::Seams, Weld::All]),
        orient in prop::sample::select(vec![Orient::Keep, Orient::Consistent]),
    ) {
        let n = points.len();
        let input = TriMesh {
            positions: points.iter().map(|p| Point3::from(p.map(f64::from))).collect(),
            faces: corners.iter().map(|f| f.map(|i| VertexId::from(i.index(n)))).collect(),
        };
        let before = validate(&input);
        prop_assert_eq!(before.n_faces, input.n_faces());
        let options = with(policy, weld, orient);
        let Ok(repaired) = repair(&input, &options) else {
            let distinct = |f: usize| { let [a, b, c] = input.triangle(f); a != b && b != c && c != a };
            prop_assert!((0..input.n_faces()).all(|f| !distinct(f)) || weld != Weld::None);
            return Ok(());
        };
        let after = validate(&repaired.mesh);
        prop_assert_eq!(after.degenerate_faces + after.duplicate_faces + after.unreferenced_vertices, 0);
        prop_assert!(after.min_edge_length > 0.0);
        prop_assert!(after.n_components <= repaired.links.len() + 1);
        prop_assert_eq!(components_with_links(&repaired.intrinsic()).count, 1);
        if weld == Weld::All {
            prop_assert_eq!(after.duplicate_vertices, 0);
        }
        if orient == Orient::Consistent && after.orientable {
            prop_assert_eq!(after.inconsistent_edges, 0);
        }
        for (v, to) in repaired.input_to_repaired.iter().enumerate() {
            if let Some(to) = to {
                prop_assert_eq!(repaired.mesh.positions[to.index()], input.positions[v]);
            }
        }
        let first: Vec<u32> = (0..repaired.mesh.n_vertices())
            .map(|v| fates(&repaired).iter().position(|&to| to == v as i64).unwrap() as u32)
            .collect();
        prop_assert!(first.is_sorted());
        // Repair is deterministic, and its result is a fixed point.
        prop_assert_eq!(&repair(&input, &options).unwrap(), &repaired);
        prop_assert_eq!(repair(&repaired.mesh, &options).unwrap().mesh, repaired.mesh);
    }

    /// Counts and measures do not depend on rigid motions and on the numbering of vertices.
    #[test]
    fn reports_are_invariant(seed in any::<u32>(), angle in 0.0..6.0, shift in -10.0..10.0) {
        let parts = [shapes::torus(6, 5, 2.0, 0.5), shifted(shapes::cylinder(5, 3, 1.0, 1.0), [6.0, 1.0, 2.0])];
        let original = shapes::disjoint(&parts);
        let n = original.n_vertices();
        let step = (0..).map(|i| 1 + (seed as usize + i) % n).find(|s| gcd(*s, n) == 1).unwrap();
        let to: Vec<usize> = (0..n).map(|v| v * step % n).collect();
        let rotation = Rotation3::from_euler_angles(angle, 2.0 * angle, 0.3);
        let mut moved = original.clone();
        for (p, &v) in original.positions.iter().zip(&to) {
            moved.positions[v] = rotation * p + Vector3::repeat(shift);
        }
        moved.faces.iter_mut().flatten().for_each(|v| *v = VertexId::from(to[v.index()]));
        let (before, after) = (validate(&original), validate(&moved));
        prop_assert_eq!(before.n_edges, after.n_edges);
        prop_assert_eq!(before.n_boundary_loops, after.n_boundary_loops);
        prop_assert_eq!(before.euler_characteristic, after.euler_characteristic);
        prop_assert_eq!(before.inconsistent_edges, after.inconsistent_edges);
        prop_assert!((before.area - after.area).abs() < 1e-10);
        let bridge = with(ComponentPolicy::Bridge, Weld::Seams, Orient::Keep);
        let lengths = [&original, &moved].map(|m| repair(m, &bridge).unwrap().report.bridge_length);
        prop_assert!((lengths[0] - lengths[1]).abs() < 1e-10);
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}
