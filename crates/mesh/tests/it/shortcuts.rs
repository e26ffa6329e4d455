//! Laws of shortcuts that are cut.

use canonform_mesh::{CutSurface, ShortcutKind, TriMesh, cut_shortcuts, fill_holes, shapes, validate};
use nalgebra::Point3;
use surface::{VertexId, components_of_faces};

fn cut(mesh: &TriMesh) -> CutSurface {
    cut_shortcuts(mesh, &mesh.topology(), &()).unwrap()
}

fn nearest(mesh: &TriMesh, to: [f64; 3]) -> VertexId {
    let gap = |v: usize| (mesh.positions[v] - Point3::from(to)).norm();
    VertexId::from((0..mesh.n_vertices()).min_by(|&a, &b| gap(a).total_cmp(&gap(b))).unwrap())
}

fn welded(mut mesh: TriMesh, [a, b]: [VertexId; 2]) -> TriMesh {
    mesh.faces.iter_mut().flatten().filter(|v| **v == b).for_each(|v| *v = a);
    mesh
}

#[test]
fn a_welded_vertex_is_split_and_goes_back_into_its_surface() {
    let ball = shapes::icosphere(4);
    let ends = [nearest(&ball, [0.0, 0.0, 1.0]), nearest(&ball, [1.0, 0.0, 0.0])];
    let weld = welded(ball.clone(), ends);
    let opened = cut(&weld);
    let [shortcut] = opened.shortcuts[..] else { panic!("{:?}", opened.shortcuts) };
    assert_eq!((shortcut.kind, shortcut.vertex), (ShortcutKind::Pinch, ends[0]));
    assert!((shortcut.detour - 1.57).abs() < 1.0, "{}", shortcut.detour);
    let near = welded(ball.clone(), [ends[0], nearest(&ball, [0.0, 0.5, 1.0])]);
    assert!(cut(&near).cut.mesh == near, "few distances change");
    let mesh = opened.cut.mesh;
    let report = validate(&mesh);
    assert_eq!((report.non_manifold_vertices, report.genus), (0, Some(0)));
    assert_eq!((report.n_boundary_edges, report.n_components), (0, 1));
    assert!((mesh.area() / ball.area() - 1.0).abs() < 1e-3, "{}", mesh.area());
    let radius = |v: usize| (mesh.positions[v].coords.norm() - 1.0).abs();
    assert!((0..mesh.n_vertices()).all(|v| radius(v) < 0.01), "a spike is left");
}

#[test]
fn surfaces_that_only_a_vertex_connects_stay_connected() {
    let two = shapes::disjoint(&[shapes::icosphere(2), shapes::icosphere(2)]);
    let n = shapes::icosphere(2).n_vertices();
    let once = welded(two.clone(), [VertexId(3), VertexId::from(n + 5)]);
    let opened = cut(&once);
    assert!(opened.shortcuts.is_empty());
    assert_eq!(opened.cut.mesh, once);
    // A second shared vertex is a shortcut.
    let twice = welded(once, [VertexId(100), VertexId::from(n + 70)]);
    let opened = cut(&twice);
    assert_eq!(opened.shortcuts.len(), 1);
    let connected = components_of_faces(opened.cut.mesh.n_vertices(), &opened.cut.mesh.faces);
    assert_eq!(connected.count, 1);
}

#[test]
fn surfaces_welded_along_an_edge_are_separated_and_fins_are_not() {
    let ball = shapes::icosphere(3);
    let face = |to| {
        let v = nearest(&ball, to);
        *ball.faces.iter().find(|face| face.contains(&v)).unwrap()
    };
    let ([a, b, _], [c, d, _]) = (face([0.0, 0.0, 1.0]), face([0.0, 1.0, 0.0]));
    let seam = welded(welded(ball.clone(), [a, d]), [b, c]);
    assert!(validate(&seam).non_manifold_edges > 0);
    let opened = cut(&seam);
    let report = validate(&opened.cut.mesh);
    assert_eq!((report.non_manifold_edges, report.n_boundary_edges, opened.shortcuts.len()), (0, 0, 2));
    let mut fin = shapes::grid(5, 5, 1.0);
    let tip = VertexId::from(fin.n_vertices());
    fin.positions.push(Point3::new(2.0, 2.0, 1.0));
    fin.faces.push([VertexId(12), VertexId(13), tip]);
    assert_eq!(cut(&fin).cut.mesh, fin);
}

/// A ball with a tube from one of its faces to the mirror image of that face.
fn bridged(level: u32) -> TriMesh {
    let mut mesh = shapes::icosphere(level);
    let height = |f: &usize| mesh.triangle(*f).iter().map(|p| p.z).sum::<f64>();
    let top = (0..mesh.n_faces()).max_by(|f, g| height(f).total_cmp(&height(g))).unwrap();
    let below = |v: VertexId| {
        let mut image = mesh.positions[v.index()];
        image.z = -image.z;
        VertexId::from(mesh.positions.iter().position(|p| (p - image).norm() < 1e-9).unwrap())
    };
    let rims = [mesh.faces[top], mesh.faces[top].map(below)];
    mesh.faces.retain(|face| !rims.iter().any(|rim| face.iter().all(|v| rim.contains(v))));
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        mesh.faces.push([rims[0][i], rims[0][j], rims[1][i]]);
        mesh.faces.push([rims[0][j], rims[1][j], rims[1][i]]);
    }
    mesh
}

#[test]
fn a_narrow_handle_is_cut_and_its_holes_can_be_filled() {
    let mesh = bridged(3);
    assert_eq!(validate(&mesh).genus, Some(1));
    let opened = cut(&mesh);
    let [shortcut] = opened.shortcuts[..] else { panic!("{:?}", opened.shortcuts) };
    assert_eq!(shortcut.kind, ShortcutKind::Handle);
    assert!(shortcut.girth < 0.8 && shortcut.detour > 2.5, "{shortcut:?}");
    let filled = fill_holes(&opened.cut.mesh, &opened.cut.mesh.topology(), 1.0).mesh;
    let report = validate(&filled);
    assert_eq!((report.genus, report.n_boundary_edges, report.n_components), (Some(0), 0, 1));
    assert_eq!(opened.cut.mesh.positions[..mesh.n_vertices()], mesh.positions);
}

#[test]
fn handles_by_design_stay() {
    for mesh in [
        shapes::torus(120, 12, 2.0, 0.15),
        shapes::torus(60, 20, 2.0, 0.3),
        shapes::torus(60, 20, 2.0, 0.7),
        shapes::icosphere(3),
    ] {
        assert_eq!(cut(&mesh).cut.mesh, mesh);
    }
}
