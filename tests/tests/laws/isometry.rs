//! What must change nothing: folding, moving and, up to the unit, scaling.

use datasets::Family;
use linalg::DistanceMatrix;
use mesh::{IntrinsicMesh, VertexId, shapes};
use nalgebra::{Isometry3, Point3, Vector3};
use pipeline::{
    EmbedMethod, EmbedOptions, GeodesicMethod, MatchOptions, Normalization, PreparedForms, Samples,
    form_distances,
};

use crate::support::{all_vertices, body, columns, embedded, form_pairs, gap, marching, moved, surface};

fn few_samples() -> EmbedOptions {
    EmbedOptions {
        samples: Samples::Count(30),
        method: EmbedMethod::Nystrom { rank: Some(8) },
        ..EmbedOptions::default()
    }
}

#[test]
fn a_regular_sheet_folds_as_well() {
    let [flat, folded] = [0.0, 2.2].map(|angle| shapes::folded_sheet(15, 9, 0.7, 6, angle));
    for method in [marching(), GeodesicMethod::Dijkstra] {
        let [a, b] = [&folded, &flat].map(|mesh| columns(mesh, method, &all_vertices(mesh)));
        assert!(gap(a.as_slice(), b.as_slice()) < 1e-12);
    }
}

#[test]
fn a_rigid_motion_changes_no_form() {
    for family in Family::all() {
        let mesh = body(family);
        let motion = Isometry3::new(Vector3::new(300.0, -40.0, 7.0), Vector3::new(0.3, -1.1, 2.0));
        let turned = moved(&mesh, |p| motion * p);
        let mirrored = moved(&mesh, |p| Point3::new(-p.x, p.y, p.z));
        let options = EmbedOptions::default();
        let form = form_pairs(&mesh, &options);
        for other in [turned, mirrored] {
            let gap = gap(form_pairs(&other, &options).as_slice(), form.as_slice());
            println!("{}: forms of the moved and the resting mesh differ by {gap:.1e}", family.name());
            assert!(gap < 1e-9, "{}: {gap:e}", family.name());
        }
    }
}

fn scaled_pairs(pairs: &DistanceMatrix, factor: f64) -> Vec<f64> {
    pairs.as_slice().iter().map(|d| d * factor).collect()
}

#[test]
fn a_change_of_unit_changes_the_unit_alone() {
    let mesh = body(Family::Centaur);
    let options = EmbedOptions::default();
    let (form, stress) =
        (form_pairs(&mesh, &options), embedded(&mesh, &options).report.stress.unwrap().value);
    let solver = marching().prepare(&IntrinsicMesh::from_mesh(&mesh));
    let distances = solver.distances(VertexId(5));
    for factor in [1e-3, 1e3] {
        let scaled = moved(&mesh, |p| p * factor);
        let found = marching().prepare(&IntrinsicMesh::from_mesh(&scaled)).distances(VertexId(5));
        let expected: Vec<f64> = distances.iter().map(|d| d * factor).collect();
        assert!(gap(&found, &expected) < 1e-12);
        let form_gap = gap(form_pairs(&scaled, &options).as_slice(), &scaled_pairs(&form, factor));
        let scaled_stress = embedded(&scaled, &options).report.stress.unwrap().value;
        let stress_gap = (scaled_stress / (stress * factor * factor) - 1.0).abs();
        println!("times {factor}: forms differ by {form_gap:.1e}, stresses by {stress_gap:.1e}");
        assert!(form_gap < 1e-9 && stress_gap < 1e-9, "{form_gap:e} {stress_gap:e}");
    }
}

#[test]
fn normalised_distances_between_forms_know_no_size() {
    let meshes = [body(Family::Cat), body(Family::David)];
    let distances = |factor: f64| {
        let forms = meshes.iter().map(|mesh| {
            let surface = surface(&moved(mesh, |p| p * factor));
            pipeline::embed(&surface, &few_samples(), &()).unwrap().form(&surface).unwrap()
        });
        let forms: Vec<_> = forms.collect();
        let prepared = PreparedForms::new(&forms, Normalization::UnitSpread).unwrap();
        form_distances(&prepared, &MatchOptions::default(), &()).unwrap().get(0, 1)
    };
    let one = distances(1.0);
    for factor in [1e-3, 1e3] {
        assert!((distances(factor) / one - 1.0).abs() < 1e-9, "{factor}");
    }
}
