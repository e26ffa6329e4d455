//! Invariance to folding, motions and renumbering.

use canonform::compare::form_alignments;
use canonform::embed::{EmbedMethod, FormOptions, Samples, StressChoice};
use datasets::Family;
use descriptors::Normalization;
use geodesics::{FirstSample, Method};
use mesh::{TriMesh, shapes};
use nalgebra::{Isometry3, Point3, Vector3};
use surface::VertexId;

use crate::support::{
    all_vertices, body, columns, form_pairs, gap, marching, measured, moved, permutation, surface,
};

fn few_samples() -> FormOptions {
    FormOptions { samples: Samples::Count(30), method: EmbedMethod::low_rank(8), ..FormOptions::default() }
}

/// A sheet of irregular triangles with a straight column of vertices along which it can be folded.
fn creased_sheet() -> (TriMesh, f64) {
    let (nx, ny, step, column) = (19, 14, 0.3, 7);
    let mut sheet = shapes::jittered_grid(nx, ny, step, 0.2, 5);
    let crease = step * column as f64;
    for j in 0..ny {
        sheet.positions[j * nx + column].x = crease;
    }
    (sheet, crease)
}

#[test]
fn folding_along_a_mesh_line_changes_no_distance_and_no_embedding() {
    let (sheet, crease) = creased_sheet();
    let sources = all_vertices(&sheet);
    let flat_form = form_pairs(&sheet, &few_samples());
    for angle in [0.4, 1.6, 2.9] {
        let folded = shapes::fold(&sheet, crease, angle);
        for method in [marching(), Method::Dijkstra] {
            let [a, b] = [&folded, &sheet].map(|mesh| columns(mesh, method, &sources));
            let gap = gap(a.as_slice(), b.as_slice());
            println!("folded by {angle}: {} distances differ by {gap:.1e}", method.name());
            assert!(gap < 1e-12, "{} {angle}: {gap:e}", method.name());
        }
        let form = form_pairs(&folded, &few_samples());
        let gap = gap(form.as_slice(), flat_form.as_slice());
        println!("folded by {angle}: embeddings differ by {gap:.1e}");
        assert!(gap < 1e-12, "{angle}: {gap:e}");
    }
}

#[test]
fn a_rigid_motion_changes_no_form() {
    for family in Family::all() {
        let mesh = body(family);
        let motion = Isometry3::new(Vector3::new(300.0, -40.0, 7.0), Vector3::new(0.3, -1.1, 2.0));
        let turned = moved(&mesh, |p| motion * p);
        let mirrored = moved(&mesh, |p| Point3::new(-p.x, p.y, p.z));
        let options = FormOptions::default();
        let form = form_pairs(&mesh, &options);
        for other in [turned, mirrored] {
            let gap = gap(form_pairs(&other, &options).as_slice(), form.as_slice());
            println!("{}: forms of the moved and the original mesh differ by {gap:.1e}", family.name());
            assert!(gap < 1e-9, "{}: {gap:e}", family.name());
        }
    }
}

/// The mesh with vertex `v` renumbered to `number[v]` and its faces in another order and rotation.
fn renumbered(mesh: &TriMesh) -> (TriMesh, Vec<usize>) {
    let number = permutation(mesh.n_vertices());
    let mut positions = mesh.positions.clone();
    for (v, p) in mesh.positions.iter().enumerate() {
        positions[number[v]] = *p;
    }
    let faces = permutation(mesh.n_faces()).into_iter().map(|f| {
        let mut face = mesh.faces[f].map(|v| VertexId::from(number[v.index()]));
        face.rotate_left(f % 3);
        face
    });
    (TriMesh { positions, faces: faces.collect() }, number)
}

#[test]
fn renumbering_permutes_distances_and_form() {
    for family in [Family::Cat, Family::David] {
        let mesh = body(family);
        let (other, number) = renumbered(&mesh);
        let sources: Vec<VertexId> = (0..1000).map(VertexId).collect();
        let targets: Vec<VertexId> = sources.iter().map(|v| VertexId::from(number[v.index()])).collect();
        for method in [marching(), Method::Dijkstra, Method::BreadthFirst] {
            let here = columns(&mesh, method, &sources);
            let there = columns(&other, method, &targets);
            let back = linalg::Matrix::from_fn(here.nrows(), here.ncols(), |v, s| there[(number[v], s)]);
            let gap = gap(back.as_slice(), here.as_slice());
            println!("{}: {} distances differ by {gap:.1e}", family.name(), method.name());
            assert!(gap < 1e-9, "{}: {gap:e}", method.name());
        }

        let first =
            |vertex| FormOptions { first_sample: FirstSample::Vertex(vertex), ..FormOptions::default() };
        let [here, there] = [(&mesh, 0), (&other, number[0])]
            .map(|(mesh, vertex)| measured(mesh, &first(VertexId::from(vertex)), StressChoice::Auto));
        let samples: Vec<u32> = here.report.samples.iter().map(|&v| number[v as usize] as u32).collect();
        assert_eq!(samples, there.report.samples);
        let [a, b] = [here, there].map(|e| e.report.stress.unwrap().value);
        println!("{}: stresses differ by {:.1e}", family.name(), (a / b - 1.0).abs());
        assert!((a / b - 1.0).abs() < 1e-9);
    }
}

#[test]
fn normalised_form_distances_do_not_depend_on_size() {
    let meshes = [body(Family::Cat), body(Family::David)];
    let distances = |factor: f64| {
        let forms = meshes.iter().map(|mesh| {
            let surface = surface(&moved(mesh, |p| p * factor));
            canonform::embed::embed(&surface, &few_samples(), &()).unwrap().form(&surface).unwrap()
        });
        let forms: Vec<_> = forms.collect();
        let found = form_alignments(&forms, Normalization::UnitArea, &()).unwrap();
        found.distances.get(0, 1)
    };
    let one = distances(1.0);
    for factor in [1e-3, 1e3] {
        assert!((distances(factor) / one - 1.0).abs() < 1e-9, "{factor}");
    }
}
