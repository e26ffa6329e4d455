//! Invariance to renumbering.

use canonform::embed::{FormOptions, StressChoice};
use datasets::Family;
use geodesics::FirstSample;
use mesh::TriMesh;
use surface::VertexId;

use crate::support::{body, measured};

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
