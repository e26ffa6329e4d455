//! Laws of repair, and each of its errors.

use canonform_mesh::{
    ComponentPolicy, Orient, RepairOptions, Repaired, TriMesh, Weld, repair, shapes, validate,
};
use nalgebra::{Point3, Rotation3, Vector3};
use proptest::prelude::*;
use surface::{VertexId, components_with_links};
use testkit::{mesh, moved, renumbered, soup};

fn mend(mesh: &TriMesh) -> Repaired {
    repair(mesh, &RepairOptions::default(), &()).unwrap()
}

fn with(components: ComponentPolicy, weld: Weld, orient: Orient) -> RepairOptions {
    RepairOptions { components, weld, orient }
}

fn shifted(mesh: TriMesh, by: [f64; 3]) -> TriMesh {
    moved(&mesh, |p| p + Vector3::from(by))
}

#[test]
fn degenerate_duplicate_and_unused_items_are_removed_and_the_rest_keeps_its_order() {
    let points: Vec<[f64; 3]> = (0..8).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
    let dirty = mesh(&points, &[[5, 3, 1], [1, 1, 3], [3, 1, 5], [3, 5, 6], [7, 7, 7], [6, 5, 3]]);
    let repaired = mend(&dirty);
    let report = &repaired.report;
    assert_eq!((report.degenerate_faces, report.duplicate_faces, report.unreferenced_vertices), (2, 2, 4));
    let fates = [None, Some(0), None, Some(1), None, Some(2), Some(3), None].map(|v| v.map(VertexId));
    assert!(repaired.remap.all_to_new().eq(fates));
    assert_eq!(repaired.mesh.faces, [[2, 1, 0], [1, 2, 3]].map(|f| f.map(VertexId)));
    let expected = [
        "2 faces with a repeated vertex removed",
        "2 duplicate faces removed",
        "4 vertices without a face dropped",
    ];
    assert_eq!(report.summary(), expected);
}

#[test]
fn slivers_stay_and_edges_of_length_zero_collapse_without_a_slit() {
    let flat = mesh(&[[0., 0., 0.], [1., 0., 0.], [2., 0., 0.], [1., 1., 0.]], &[[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mend(&flat).mesh, flat);

    // A strip whose middle edge has length zero and ends inside the boundary.
    let mut strip = shapes::grid(4, 3, 1.0);
    strip.positions[6] = strip.positions[5];
    let options = with(ComponentPolicy::Error, Weld::None, Orient::Keep);
    let repaired = repair(&strip, &options, &()).unwrap();
    assert_eq!((repaired.report.collapsed_vertices, repaired.report.zero_length_faces), (1, 2));
    assert_eq!(repaired.remap.to_new(VertexId(5)), repaired.remap.to_new(VertexId(6)));
    let after = validate(&repaired.mesh);
    assert_eq!((after.n_boundary_loops, after.duplicate_vertices, after.n_components), (1, 0, 1));
}

#[test]
fn welding_follows_its_policy() {
    // Two adjacent sheets whose common boundary has the same positions but separate vertices.
    let left = shapes::grid(3, 3, 1.0);
    let halves = shapes::disjoint(&[left.clone(), shifted(left.clone(), [2.0, 0.0, 0.0])]);
    let joined = mend(&halves);
    assert_eq!((joined.report.welded_vertices, joined.report.dropped_components), (3, 0));
    let after = validate(&joined.mesh);
    assert_eq!((after.n_components, after.n_boundary_loops, after.duplicate_vertices), (1, 1, 0));
    let apart = repair(&halves, &with(ComponentPolicy::Bridge, Weld::None, Orient::Keep), &()).unwrap();
    assert_eq!((apart.mesh.n_vertices(), apart.report.bridge_length), (18, 0.0));

    // Two closed surfaces that touch in a point stay separate, unless all vertices are welded.
    let cubes = shapes::disjoint(&[shapes::cube(0), shifted(shapes::cube(0), [1.0, 1.0, 1.0])]);
    assert_eq!(mend(&cubes).report.dropped_components, 1);
    let all = repair(&cubes, &with(ComponentPolicy::Error, Weld::All, Orient::Keep), &()).unwrap();
    assert_eq!((all.report.welded_vertices, all.mesh.n_vertices()), (1, 15));
    // Minus zero is zero.
    let mut negative = shapes::disjoint(&[left.clone(), shifted(left, [-2.0, 0.0, 0.0])]);
    negative.positions[0].x = -0.0;
    assert_eq!(mend(&negative).report.welded_vertices, 3);
}

/// Moves every vertex by up to `amplitude` along each axis.
fn jittered(mesh: &TriMesh, amplitude: f64) -> TriMesh {
    let mut random = base::SplitMix(1);
    moved(mesh, |p| p + amplitude * Vector3::from([(); 3].map(|()| random.uniform())))
}

/// Mean length of the edges of `shapes::icosphere(3)`.
const EDGE: f64 = 0.14;

#[test]
fn seams_whose_sides_nearly_coincide_are_welded() {
    let sphere = shapes::icosphere(3);
    for share in [0.0, 1e-9, 1e-6, 1e-4, 1e-3] {
        for scale in [1.0, 1e-100, 1e100, 3e7] {
            let mesh = moved(&jittered(&soup(&sphere), share * EDGE), |p| p * scale);
            let repaired = mend(&mesh);
            let report = &repaired.report;
            assert_eq!((report.components, report.dropped_area_share), (1, 0.0), "{share} {scale}");
            let sizes = [repaired.mesh.n_vertices(), repaired.mesh.n_faces()];
            assert_eq!((sizes, validate(&repaired.mesh).genus), ([642, 1280], Some(0)));
            if share > 0.0 {
                assert!(report.near_welded_vertices > 300, "{report:?}");
                assert!(report.weld_gap > 0.0 && report.weld_gap <= report.weld_tolerance);
                assert!(report.weld_gap < 4.0 * share * EDGE * scale);
                assert!(report.summary()[0].contains("merged with another across a gap of up to"));
            }
            // A second repair changes nothing.
            assert_eq!(mend(&repaired.mesh).mesh, repaired.mesh);
        }
    }
}

#[test]
fn gaps_of_a_fifth_of_an_edge_stay_open() {
    let sheet = shapes::grid(9, 9, 1.0);
    // Side by side with a gap, stacked, and a sheet that crosses another.
    for shift in [[8.2, 0.0, 0.0], [0.0, 0.0, 0.2], [8.05, 0.05, 0.0], [4.5, 0.5, 0.01]] {
        let both = shapes::disjoint(&[sheet.clone(), shifted(sheet.clone(), shift)]);
        let report = mend(&both).report;
        assert_eq!((report.near_welded_vertices, report.dropped_components), (0, 1), "{shift:?}");
    }
    // A slit along the middle of a sheet, and needles whose long sides are close together.
    let mut slit = shapes::disjoint(&[sheet.clone(), shifted(sheet.clone(), [8.0, 0.0, 0.0])]);
    for (v, p) in slit.positions.iter_mut().enumerate() {
        let is_right = v >= 81;
        if p.x == 8.0 && p.y > 0.5 && p.y < 7.5 {
            p.x += if is_right { 0.1 } else { -0.1 };
        }
    }
    let open = mend(&slit);
    assert_eq!((open.report.welded_vertices, open.report.near_welded_vertices), (2, 0));
    assert_eq!(validate(&open.mesh).n_boundary_loops, 2);
    let ribbon = moved(&shapes::grid(40, 2, 1.0), |p| Point3::new(p.x, 1e-4 * p.y, p.z));
    let kept = mend(&ribbon);
    assert!(kept.mesh == ribbon && kept.remap.is_identity() && kept.report.summary().is_empty());
}

#[test]
fn welding_within_a_tolerance_closes_wider_gaps_and_collapses_no_edge() {
    let sheet = shapes::grid(9, 9, 1.0);
    let both = shapes::disjoint(&[sheet.clone(), shifted(sheet.clone(), [8.2, 0.0, 0.0])]);
    let within = |mesh: &TriMesh, tolerance| {
        repair(mesh, &with(ComponentPolicy::Largest, Weld::Within(tolerance), Orient::Keep), &()).unwrap()
    };
    assert_eq!(within(&both, 0.19).report.near_welded_vertices, 0);
    let closed = within(&both, 0.21).report;
    assert_eq!((closed.near_welded_vertices, closed.components, closed.weld_tolerance), (9, 1, 0.21));
    // A tolerance beyond all edges merges what it can, but no two vertices of one edge.
    for tolerance in [1.0, 3.0, 100.0] {
        let report = within(&both, tolerance).report;
        assert_eq!((report.zero_length_faces, report.collapsed_vertices), (0, 0), "{tolerance}");
        assert!(report.output_faces > 0 && report.near_welded_vertices >= 9);
    }
}

#[test]
fn scale_changes_no_decision() {
    let mesh = jittered(&soup(&shapes::icosphere(2)), 1e-3 * EDGE);
    let parts = shapes::disjoint(&[mesh, shifted(shapes::grid(20, 20, 0.1), [0.0, 0.0, 1.2])]);
    let lengths = |Repaired { intrinsic, .. }: &Repaired, unit: f64| -> Vec<f64> {
        let links = intrinsic.links().iter().map(|link| link.length);
        intrinsic.edge_lengths().iter().copied().chain(links).map(|length| unit * length).collect()
    };
    for options in [
        RepairOptions::default(),
        with(ComponentPolicy::Bridge, Weld::Seams, Orient::Consistent),
        with(ComponentPolicy::Bridge, Weld::None, Orient::Keep),
    ] {
        let expected = repair(&parts, &options, &()).unwrap();
        for exponent in [-497, -300, -30, 3, 200, 496] {
            let scale = 2f64.powi(exponent);
            let found = repair(&moved(&parts, |p| p * scale), &options, &()).unwrap();
            assert_eq!(found.mesh.faces, expected.mesh.faces, "2^{exponent}");
            assert_eq!(found.remap, expected.remap);
            assert_eq!(found.report.dropped_area_share, expected.report.dropped_area_share);
            assert_eq!(found.report.weld_gap, scale * expected.report.weld_gap);
            assert_eq!(lengths(&found, 1.0), lengths(&expected, scale));
            assert_eq!(found.mesh.area(), scale * scale * expected.mesh.area());
            assert_eq!(validate(&found.mesh).area, scale * scale * validate(&expected.mesh).area);
        }
    }
}

#[test]
fn sizes_whose_areas_can_be_represented_are_supported() {
    let cube = shapes::cube(2);
    let scaled = |scale: f64| repair(&moved(&cube, |p| p * scale), &RepairOptions::default(), &());
    assert!(scaled(1e-150).is_ok() && scaled(1e150).is_ok());
    // Coordinates near zero, and edges whose squared lengths vanish beside the others.
    let mixed = moved(&cube, |p| p.map(|x| if x == 0.0 { 5e-324 } else { x }));
    assert_eq!(mend(&mixed).mesh, mixed);
    let mut tiny = shapes::grid(4, 3, 1.0);
    tiny.positions[5] = Point3::new(0.0, 0.0, 1e-170);
    tiny.positions[6] = Point3::origin();
    let report = mend(&tiny).report;
    assert_eq!((report.collapsed_vertices, report.zero_length_faces), (2, 4), "{report:?}");
}

#[test]
fn coordinates_of_32_bits_are_known_to_as_many() {
    let rounded = |mesh: &TriMesh, offset: [f64; 3]| {
        mend(&moved(&shifted(mesh.clone(), offset), |p| p.map(|x| f64::from(x as f32)))).report
    };
    let torus = shapes::torus(48, 24, 20.0, 5.0);
    let at_origin = rounded(&torus, [0.0; 3]);
    assert!((1e-7..1e-5).contains(&at_origin.coordinate_rounding), "{}", at_origin.coordinate_rounding);
    assert!(at_origin.summary().is_empty());
    // Where numbers are half a unit apart, and edges two units long.
    let far = rounded(&torus, [5e5, 5.4e6, 100.0]);
    assert!((0.1..0.5).contains(&far.coordinate_rounding), "{}", far.coordinate_rounding);
    let note = far.uncertainty().unwrap();
    assert!(note.contains("32 bits") && note.ends_with("or with 64 bits"), "{note}");
    assert_eq!(far.summary(), [note]);
    assert!(mend(&shifted(torus, [5e5, 5.4e6, 100.0])).report.summary().is_empty());
    // Whole numbers are exact; the heights above them are not.
    let terrain = moved(&shapes::grid(9, 9, 1.0), |p| Point3::new(p.x, p.y, 100.0 + (p.x * p.y).sin()));
    let terrain = rounded(&terrain, [5e5, 5.4e6, 0.0]);
    assert!((1e-6..1e-4).contains(&terrain.coordinate_rounding), "{}", terrain.coordinate_rounding);
    assert!(terrain.summary().is_empty(), "{:?}", terrain.summary());
}

#[test]
fn pages_of_a_book_stay_apart() {
    // Each page nearly touches the next, and all together span 3 degrees.
    let points = [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]].map(Point3::from);
    let pages = (0..60).map(|i| f64::from(i) * 1e-3).map(|angle| Point3::new(angle.cos(), angle.sin(), 0.0));
    let book = TriMesh {
        positions: points.into_iter().chain(pages).collect(),
        faces: (0..60).map(|i| [0, 1, i + 2].map(VertexId)).collect(),
    };
    assert_eq!(mend(&book).mesh, book);
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
    let share = fine_but_small.area() / both.area();
    assert!((report.dropped_area_share - share).abs() < 1e-12);
    let summary = report.summary().remove(0);
    assert!(summary.starts_with("1 of 2 components dropped, 1280 faces and 642 vertices with "), "{summary}");
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
    let repaired = repair(&sheets, &with(ComponentPolicy::Bridge, Weld::Seams, Orient::Keep), &()).unwrap();
    let mut lengths: Vec<f64> = repaired.intrinsic.links().iter().map(|link| link.length).collect();
    lengths.sort_by(f64::total_cmp);
    // Three links across each of the two narrow gaps, one across the wide gap.
    assert_eq!(lengths, [0.5, 0.5, 0.5, 0.75, 0.75, 0.75, 4.5]);
    assert_eq!(repaired.report.bridge_length, 8.25);
    for (link, in_input) in repaired.intrinsic.links().iter().zip(&repaired.report.bridges) {
        assert_eq!(link.ends.map(|v| v.0 + 1), in_input.ends.map(|v| v.0));
        let [p, q] = link.ends.map(|v| repaired.mesh.positions[v.index()]);
        assert_eq!((q - p).norm(), link.length);
    }
    assert_eq!(repaired.mesh.faces.len(), sheets.faces.len());
    let summary = repaired.report.summary();
    assert_eq!(summary[1], "4 components joined by 7 links of total length 8.250000");
}

#[test]
fn unusable_meshes_are_errors() {
    let cube = shapes::cube(0);
    let two = shapes::disjoint(&[shapes::tetrahedron(0), shifted(cube.clone(), [9.0, 0.0, 0.0])]);
    let error = repair(&two, &with(ComponentPolicy::Error, Weld::None, Orient::Keep), &()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the mesh is disconnected: 4 of 12 vertices lie outside the largest component"
    );
    type Change = fn(&mut TriMesh);
    let cases: [(&str, Change); 7] = [
        ("vertex 3 has a coordinate that is not finite", |m| m.positions[3].z = f64::NEG_INFINITY),
        ("face 2 refers to vertex 99, but the mesh has 8 vertices", |m| m.faces[2][0] = VertexId(99)),
        ("sizes from 1e-151 to 1e152 are supported", |m| m.positions.iter_mut().for_each(|p| *p *= 1e-160)),
        ("the mesh is 1e200 units across", |m| m.positions[0].x = 1e200),
        ("units across, but sizes from", |m| m.positions[0].x = f64::MAX),
        ("8 different points without faces; a surface needs faces, or at least 12", |m| m.faces.clear()),
        ("none of the 12 faces is usable (12 degenerate)", |m| m.positions.fill(Point3::origin())),
    ];
    for (expected, change) in cases {
        let mut mesh = cube.clone();
        change(&mut mesh);
        let text = repair(&mesh, &RepairOptions::default(), &()).unwrap_err().to_string();
        assert!(text.contains(expected), "{text}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Meshes on a small lattice have many coincident points, duplicate and degenerate faces.
    #[test]
    fn any_mesh_is_repaired_or_an_error(
        points in prop::collection::vec(prop::array::uniform3(0i8..3), 1..25),
        // Without a face they are a point cloud, which is tested elsewhere.
        corners in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 1..60),
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
        let Ok(repaired) = repair(&input, &options, &()) else {
            let distinct = |f: usize| { let [a, b, c] = input.triangle(f); a != b && b != c && c != a };
            prop_assert!((0..input.n_faces()).all(|f| !distinct(f)) || weld != Weld::None);
            return Ok(());
        };
        let after = validate(&repaired.mesh);
        prop_assert_eq!(after.degenerate_faces + after.duplicate_faces + after.unreferenced_vertices, 0);
        prop_assert!(after.min_edge_length > 0.0);
        prop_assert!(after.n_components <= repaired.intrinsic.links().len() + 1);
        prop_assert_eq!(components_with_links(&repaired.intrinsic).count, 1);
        let links = repaired.intrinsic.links().to_vec();
        prop_assert_eq!(&repaired.intrinsic, &repaired.mesh.intrinsic().with_links(links));
        if weld == Weld::All {
            prop_assert_eq!(after.duplicate_vertices, 0);
        }
        match orient {
            Orient::Keep => prop_assert_eq!(repaired.report.flipped_faces, 0),
            Orient::Consistent => prop_assert!(!after.orientable || after.inconsistent_edges == 0),
        }
        for (v, to) in repaired.remap.all_to_new().enumerate() {
            if let Some(to) = to {
                prop_assert_eq!(repaired.mesh.positions[to.index()], input.positions[v]);
            }
        }
        let dropped = (0..n).map(VertexId::from).filter(|v| repaired.remap.to_new(*v).is_none());
        prop_assert_eq!(&repaired.report.dropped_vertices, &dropped.collect::<Vec<_>>());
        let first: Vec<VertexId> =
            (0..repaired.mesh.n_vertices()).map(|v| repaired.remap.to_old(VertexId::from(v))).collect();
        prop_assert!(first.is_sorted());
        // Repair is deterministic, and its result is a fixed point.
        prop_assert_eq!(&repair(&input, &options, &()).unwrap(), &repaired);
        prop_assert_eq!(repair(&repaired.mesh, &options, &()).unwrap().mesh, repaired.mesh);
    }

    /// Counts and measures do not depend on rigid motions and on the numbering of vertices.
    #[test]
    fn reports_are_invariant(angle in 0.0..6.0, shift in -10.0..10.0) {
        let parts = [shapes::torus(6, 5, 2.0, 0.5), shifted(shapes::cylinder(5, 3, 1.0, 1.0), [6.0, 1.0, 2.0])];
        let original = shapes::disjoint(&parts);
        let rotation = Rotation3::from_euler_angles(angle, 2.0 * angle, 0.3);
        let moved = renumbered(&moved(&original, |p| rotation * p + Vector3::repeat(shift)));
        let (before, after) = (validate(&original), validate(&moved));
        prop_assert_eq!(before.n_edges, after.n_edges);
        prop_assert_eq!(before.n_boundary_loops, after.n_boundary_loops);
        prop_assert_eq!(before.euler_characteristic, after.euler_characteristic);
        prop_assert_eq!(before.inconsistent_edges, after.inconsistent_edges);
        prop_assert!((before.area - after.area).abs() < 1e-10);
        let bridge = with(ComponentPolicy::Bridge, Weld::Seams, Orient::Keep);
        let lengths = [&original, &moved].map(|m| repair(m, &bridge, &()).unwrap().report.bridge_length);
        prop_assert!((lengths[0] - lengths[1]).abs() < 1e-10);
    }
}
