//! Invariance to folding, motions and renumbering.

use canonform::embed::{EmbedMethod, FormOptions, Samples, StressChoice};
use datasets::Family;
use geodesics::FirstSample;
use mesh::{TriMesh, shapes};
use surface::VertexId;

use crate::support::{body, form_pairs, gap, measured};

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
fn folding_along_a_mesh_line_changes_no_embedding() {
    let (sheet, crease) = creased_sheet();
    let flat_form = form_pairs(&sheet, &few_samples());
    for angle in [0.4, 1.6, 2.9] {
        let form = form_pairs(&shapes::fold(&sheet, crease, angle), &few_samples());
        let gap = gap(form.as_slice(), flat_form.as_slice());
        println!("folded by {angle}: embeddings differ by {gap:.1e}");
        assert!(gap < 1e-12, "{angle}: {gap:e}");
    }
}

/// The mesh with vertex `v` renumbered to `number[v]` and its faces in another order and rotation.
fn renumbered(mesh: &TriMesh) -> (TriMesh, Vec<usize>) {
    let permuted = |n: usize| -> Vec<usize> { (0..n).map(|i| (101 * i + 7) % n).collect() };
    let number = permuted(mesh.n_vertices());
    let mut positions = mesh.positions.clone();
    for (v, p) in mesh.positions.iter().enumerate() {
        positions[number[v]] = *p;
    }
    let faces = permuted(mesh.n_faces()).into_iter().map(|f| {
        let mut face = mesh.faces[f].map(|v| VertexId::from(number[v.index()]));
        face.rotate_left(f % 3);
        face
    });
    (TriMesh { positions, faces: faces.collect() }, number)
}

#[test]
fn renumbering_permutes_samples_and_changes_no_stress() {
    let mesh = body(Family::Cat);
    let (other, number) = renumbered(&mesh);
    let first = |vertex| FormOptions { first_sample: FirstSample::Vertex(vertex), ..FormOptions::default() };
    let [here, there] = [(&mesh, 0), (&other, number[0])]
        .map(|(mesh, vertex)| measured(mesh, &first(VertexId::from(vertex)), StressChoice::Auto).report);
    let samples: Vec<u32> = here.samples.iter().map(|&v| number[v as usize] as u32).collect();
    assert_eq!(samples, there.samples);
    let [a, b] = [here, there].map(|report| report.stress.unwrap().value);
    assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
}
