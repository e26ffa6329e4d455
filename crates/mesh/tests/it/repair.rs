//! Laws of repair, and each of its errors.

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
    repair(mesh, &RepairOptions::default(), &()).unwrap()
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
    repaired.remap.all_to_new().map(|to| to.map_or(-1, |v| i64::from(v.0))).collect()
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
        assert!(repaired.remap.is_identity());
    }
}

#[test]
fn the_surface_measured_during_repair_is_that_of_the_repaired_mesh() {
    let clean = shapes::torus(9, 7, 2.0, 0.5);
    let mut turned = clean.clone();
    turned.faces.iter_mut().step_by(3).for_each(|face| face.swap(0, 1));
    let mut doubled = clean.clone();
    doubled.faces.extend_from_within(3..7);
    let mut unused = clean.clone();
    unused.positions.insert(0, Point3::new(0.1, 0.2, 0.3));
    unused.faces.iter_mut().flatten().for_each(|v| v.0 += 1);
    let pieces = shapes::disjoint(&[clean.clone(), shifted(shapes::cube(1), [5.0, 0.0, 0.0])]);
    for mesh in [soup(&clean), clean, turned, doubled, unused, pieces] {
        for components in [ComponentPolicy::Largest, ComponentPolicy::Bridge] {
            for orient in [Orient::Keep, Orient::Consistent] {
                let options = with(components, Weld::Seams, orient);
                let repaired = repair(&mesh, &options, &()).unwrap();
                let links = repaired.intrinsic.links().to_vec();
                assert_eq!(repaired.intrinsic, repaired.mesh.intrinsic().with_links(links), "{options:?}");
            }
        }
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
    let repaired = repair(&strip, &options, &()).unwrap();
    assert_eq!((repaired.report.collapsed_vertices, repaired.report.zero_length_faces), (1, 2));
    assert_eq!(repaired.remap.to_new(VertexId(5)), repaired.remap.to_new(VertexId(6)));
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

/// A sphere cut along two meridians and the equator: every vertex on a cut has a copy for each part it belongs to.
fn cut_sphere() -> TriMesh {
    let sphere = shapes::icosphere(4);
    let part = |f: usize| {
        let middle = sphere.triangle(f).iter().fold(Vector3::zeros(), |sum, p| sum + p.coords);
        u32::from(middle.z > 0.0) + 2 * u32::from(middle.x > 0.1) + 4 * u32::from(middle.y > 0.0)
    };
    let mut parts = Vec::new();
    for wanted in 0..8 {
        let mut number = vec![None; sphere.n_vertices()];
        let mut piece = TriMesh::default();
        for f in (0..sphere.n_faces()).filter(|&f| part(f) == wanted) {
            piece.faces.push(sphere.faces[f].map(|v| {
                *number[v.index()].get_or_insert_with(|| {
                    piece.positions.push(sphere.positions[v.index()]);
                    VertexId::from(piece.positions.len() - 1)
                })
            }));
        }
        parts.push(piece);
    }
    shapes::disjoint(&parts)
}

/// Moves every vertex by up to `amplitude` along each axis.
fn jittered(mut mesh: TriMesh, amplitude: f64) -> TriMesh {
    let mut random = base::SplitMix(1);
    for p in &mut mesh.positions {
        *p += amplitude * Vector3::from([(); 3].map(|()| random.uniform()));
    }
    mesh
}

/// Mean length of the edges of [`cut_sphere`].
const EDGE: f64 = 0.07;

#[test]
fn seams_whose_sides_nearly_coincide_are_welded() {
    let n_vertices = shapes::icosphere(4).n_vertices();
    for share in [0.0, 1e-9, 1e-6, 1e-4, 1e-3] {
        for scale in [1.0, 1e-100, 1e100, 3e7] {
            let mut mesh = jittered(cut_sphere(), share * EDGE);
            mesh.positions.iter_mut().for_each(|p| *p *= scale);
            let repaired = mend(&mesh);
            let report = &repaired.report;
            assert_eq!((report.components, report.dropped_area_share), (1, 0.0), "{share} {scale}");
            assert_eq!((repaired.mesh.n_vertices(), repaired.mesh.n_faces()), (n_vertices, mesh.n_faces()));
            assert_eq!(validate(&repaired.mesh).genus, Some(0));
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
fn a_soup_of_triangles_is_welded_into_its_surface() {
    for amplitude in [0.0, 1e-5] {
        let repaired = mend(&jittered(soup(&shapes::icosphere(3)), amplitude));
        assert_eq!((repaired.mesh.n_vertices(), validate(&repaired.mesh).genus), (642, Some(0)));
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
    let mut ribbon = shapes::grid(40, 2, 1.0);
    ribbon.positions.iter_mut().for_each(|p| p.y *= 1e-4);
    assert_eq!(mend(&ribbon).mesh, ribbon);
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
fn bridges_run_all_along_a_narrow_gap() {
    // Too wide to weld.
    let mesh = jittered(cut_sphere(), 0.05 * EDGE);
    assert!(mend(&mesh).report.dropped_area_share > 0.5);
    let bridged = repair(&mesh, &with(ComponentPolicy::Bridge, Weld::Seams, Orient::Keep), &()).unwrap();
    assert_eq!((bridged.report.components, bridged.report.dropped_area_share), (8, 0.0));
    let on_boundary = validate(&bridged.mesh).n_boundary_edges;
    assert!(
        bridged.intrinsic.links().len() > on_boundary / 2,
        "{} links, {on_boundary} edges",
        bridged.intrinsic.links().len()
    );
    assert!(bridged.intrinsic.links().iter().all(|link| link.length < EDGE));
}

#[test]
fn scale_changes_no_decision() {
    let mesh = jittered(cut_sphere(), 1e-3 * EDGE);
    let parts = shapes::disjoint(&[mesh, shifted(shapes::grid(20, 20, 0.1), [0.0, 0.0, 1.2])]);
    for options in [
        RepairOptions::default(),
        with(ComponentPolicy::Bridge, Weld::Seams, Orient::Consistent),
        with(ComponentPolicy::Bridge, Weld::None, Orient::Keep),
    ] {
        let expected = repair(&parts, &options, &()).unwrap();
        for exponent in [-497, -300, -30, 3, 200, 496] {
            let scale = 2f64.powi(exponent);
            let mut scaled = parts.clone();
            scaled.positions.iter_mut().for_each(|p| *p *= scale);
            let found = repair(&scaled, &options, &()).unwrap();
            assert_eq!(found.mesh.faces, expected.mesh.faces, "2^{exponent}");
            assert_eq!(found.remap, expected.remap);
            assert_eq!(found.report.dropped_area_share, expected.report.dropped_area_share);
            assert_eq!(found.report.weld_gap, scale * expected.report.weld_gap);
            assert_eq!(found.intrinsic.links().len(), expected.intrinsic.links().len());
            assert!(
                found
                    .intrinsic
                    .links()
                    .iter()
                    .zip(expected.intrinsic.links())
                    .all(|(a, b)| a.length == scale * b.length)
            );
            let lengths = found.intrinsic.edge_lengths().to_vec();
            assert!(lengths.iter().zip(expected.intrinsic.edge_lengths()).all(|(a, b)| *a == scale * b));
            assert_eq!(found.mesh.area(), scale * scale * expected.mesh.area());
            assert_eq!(validate(&found.mesh).area, scale * scale * validate(&expected.mesh).area);
        }
    }
}

#[test]
fn sizes_whose_areas_cannot_be_represented_are_refused() {
    let cube = shapes::cube(2);
    let scaled = |scale: f64| {
        let mut mesh = cube.clone();
        mesh.positions.iter_mut().for_each(|p| *p *= scale);
        repair(&mesh, &RepairOptions::default(), &())
    };
    assert!(scaled(1e-150).is_ok() && scaled(1e150).is_ok());
    for scale in [1e-160, 1e-300, 5e-324, 1e155, 1e307] {
        let error = scaled(scale).unwrap_err();
        let text = error.to_string();
        assert!(matches!(error, MeshError::UnsupportedSize { .. }), "{scale}: {text}");
        assert!(text.contains("sizes from 1e-151 to 1e152 are supported"), "{text}");
    }
    // Coordinates near zero, and edges whose squared lengths vanish beside the others.
    let mut mixed = cube.clone();
    mixed.positions.iter_mut().flat_map(|p| p.iter_mut()).filter(|x| **x == 0.0).for_each(|x| *x = 5e-324);
    assert_eq!(mend(&mixed).mesh, mixed);
    let mut tiny = shapes::grid(4, 3, 1.0);
    tiny.positions[6] = tiny.positions[5];
    tiny.positions[6].x += 0.0;
    tiny.positions[5] = Point3::new(0.0, 0.0, 1e-170);
    tiny.positions[6] = Point3::origin();
    let report = mend(&tiny).report;
    assert_eq!((report.collapsed_vertices, report.zero_length_faces), (2, 4), "{report:?}");
}

#[test]
fn a_mesh_far_from_the_origin_is_reported() {
    let sheet = shapes::grid(9, 9, 1.0);
    assert!(mend(&sheet).report.summary().is_empty());
    assert!(mend(&shifted(sheet.clone(), [1e5, 0.0, 0.0])).report.summary().is_empty());
    let report = mend(&shifted(sheet, [1e8, 0.0, 0.0])).report;
    assert!((1e-8..3e-8).contains(&report.coordinate_rounding), "{}", report.coordinate_rounding);
    assert!(report.summary()[0].contains("only known to 2e-8 of their length"), "{:?}", report.summary());
}

#[test]
fn coordinates_of_32_bits_are_known_to_as_many() {
    let rounded = |mesh: &TriMesh, offset: [f64; 3]| {
        let mut mesh = shifted(mesh.clone(), offset);
        mesh.positions.iter_mut().flat_map(|p| p.iter_mut()).for_each(|x| *x = f64::from(*x as f32));
        mend(&mesh).report
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
    let mut terrain = shapes::grid(9, 9, 1.0);
    terrain.positions.iter_mut().for_each(|p| p.z = 100.0 + (p.x * p.y).sin());
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
fn orientation_is_touched_only_on_request() {
    let mut sphere = shapes::icosphere(1);
    sphere.faces[3].swap(0, 1);
    assert_eq!(mend(&sphere).mesh, sphere);
    let oriented =
        repair(&sphere, &with(ComponentPolicy::Error, Weld::None, Orient::Consistent), &()).unwrap();
    assert_eq!(oriented.report.flipped_faces, 1);
    assert_eq!(validate(&oriented.mesh).inconsistent_edges, 0);
    assert_eq!(oriented.report.summary(), ["1 face flipped"]);
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
    let fails = |change: &dyn Fn(&mut TriMesh)| {
        let mut mesh = cube.clone();
        change(&mut mesh);
        repair(&mesh, &RepairOptions::default(), &()).unwrap_err()
    };
    type Change = fn(&mut TriMesh);
    let cases: [(&str, Change); 7] = [
        ("vertex 3 has a coordinate that is not finite", |m| m.positions[3].z = f64::NEG_INFINITY),
        ("face 2 refers to vertex 99, but the mesh has 8 vertices", |m| m.faces[2][0] = VertexId(99)),
        ("the mesh is 1e200 units across", |m| m.positions[0].x = 1e200),
        ("units across, but sizes from", |m| m.positions[0].x = f64::MAX),
        ("8 different points without faces; a surface needs faces, or at least 12", |m| m.faces.clear()),
        ("none of the 12 faces is usable (12 degenerate)", |m| m.positions.fill(Point3::origin())),
        ("none of the 12 faces is usable (12 degenerate)", |m| m.faces.iter_mut().for_each(|f| f[0] = f[1])),
    ];
    for (expected, change) in cases {
        let text = fails(&change).to_string();
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
        if weld == Weld::All {
            prop_assert_eq!(after.duplicate_vertices, 0);
        }
        if orient == Orient::Consistent && after.orientable {
            prop_assert_eq!(after.inconsistent_edges, 0);
        }
        for (v, to) in repaired.remap.all_to_new().enumerate() {
            if let Some(to) = to {
                prop_assert_eq!(repaired.mesh.positions[to.index()], input.positions[v]);
            }
        }
        let first: Vec<u32> = (0..repaired.mesh.n_vertices())
            .map(|v| fates(&repaired).iter().position(|&to| to == v as i64).unwrap() as u32)
            .collect();
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
        let n = original.n_vertices();
        let to: Vec<usize> = (0..n).rev().collect();
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
        let lengths = [&original, &moved].map(|m| repair(m, &bridge, &()).unwrap().report.bridge_length);
        prop_assert!((lengths[0] - lengths[1]).abs() < 1e-10);
    }
}
