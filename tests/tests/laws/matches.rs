//! How a changed mesh is related to the original.

use std::collections::BTreeMap;

use canonform::collection::list_shapes;
use canonform::descriptors::Side;
use canonform::relations::{Change, MeshGeometry, Relation, RelationKind};
use canonform::rigid::Handedness;
use datasets::{
    ArticulatedOptions, Damage, Family, MechanicalPart, PartMesh, articulated_body, articulated_shape,
    mechanical_parts,
};
use descriptors::ShapeDistance;
use mesh::{TriMesh, shapes};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::support::pose;

/// Changes after one another, with the kind of relation and the changes that must be told.
type Variant = (&'static [Damage], RelationKind, &'static [Change]);

/// The changes of TOSCA's shapes.
const VARIANTS: [Variant; 9] = [
    (&[Damage::Move], RelationKind::IdenticalGeometry, &[Change::Moved, Change::Rotated]),
    (&[Damage::Scale], RelationKind::Scaled, &[Change::Scaled]),
    (&[Damage::Mirror], RelationKind::Mirrored, &[Change::Mirrored]),
    (&[Damage::Decimate(0.5)], RelationKind::Remeshed, &[Change::Decimated]),
    (&[Damage::Decimate(0.2)], RelationKind::Remeshed, &[Change::Decimated]),
    (&[Damage::Subdivide(1)], RelationKind::Remeshed, &[Change::Subdivided]),
    (&[Damage::Remesh], RelationKind::Remeshed, &[Change::Remeshed]),
    (&[Damage::Noise(0.002)], RelationKind::Noisy, &[Change::Noisy]),
    (&[Damage::Noise(0.005)], RelationKind::Noisy, &[Change::Noisy]),
];

/// More of them, for the built-in shapes.
const MORE: [Variant; 7] = [
    (&[Damage::Subdivide(2)], RelationKind::Remeshed, &[Change::Subdivided]),
    (&[Damage::Noise(0.001)], RelationKind::Noisy, &[Change::Noisy]),
    (&[Damage::Holes(0.01)], RelationKind::Remeshed, &[]),
    (
        &[Damage::Scale, Damage::Mirror, Damage::Move],
        RelationKind::Mirrored,
        &[Change::Scaled, Change::Mirrored],
    ),
    (
        &[Damage::Decimate(0.5), Damage::Mirror, Damage::Scale, Damage::Move],
        RelationKind::Remeshed,
        &[Change::Scaled, Change::Mirrored, Change::Decimated],
    ),
    (&[Damage::Noise(0.002), Damage::Move], RelationKind::Noisy, &[Change::Noisy]),
    (&[Damage::Remesh, Damage::Move], RelationKind::Remeshed, &[Change::Remeshed]),
];

fn geometry(mesh: &TriMesh) -> MeshGeometry {
    MeshGeometry::new(mesh, None).unwrap()
}

/// The relation of two meshes at the distance of two poses. In space it does not depend on the distance.
fn related(a: &MeshGeometry, b: &MeshGeometry) -> Relation {
    let near = ShapeDistance { fused: 0.5, combined: 0.5 };
    Relation::by_distance(near, 1.0, Handedness::Unknown).by_meshes([a, b])
}

/// How often a kind of relation was told.
#[derive(Default)]
struct ToldKinds {
    right: usize,
    all: usize,
    falsely_identical: usize,
    wrong: Vec<String>,
}

/// Changes all shapes in every way, and counts what is told right.
fn scores(shapes: &[(String, TriMesh)], variants: &[Variant]) -> BTreeMap<String, ToldKinds> {
    let found: Vec<_> = shapes
        .par_iter()
        .flat_map_iter(|(name, mesh)| {
            let own = geometry(mesh);
            let invariants = own.invariants();
            variants.iter().map(move |(damages, kind, changes)| {
                let changed = damages.iter().fold(mesh.clone(), |mesh, damage| damage.apply(&mesh, 7));
                let changed = geometry(&changed);
                let found = related(&own, &changed).named(name, "the copy");
                let label = damages.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
                if kind.is_one_surface() {
                    let of_copy = changed.invariants();
                    assert!(
                        invariants.may_be_copy_of(&of_copy),
                        "{name}, {label}: {invariants:?}, {of_copy:?}"
                    );
                }
                let is_right = found.kind == *kind && changes.iter().all(|change| found.has(*change));
                (label, *kind, is_right, found)
            })
        })
        .collect();
    let mut scores: BTreeMap<String, ToldKinds> = BTreeMap::new();
    for (label, kind, is_right, found) in found {
        let score = scores.entry(label).or_default();
        score.all += 1;
        score.right += usize::from(is_right);
        score.falsely_identical += usize::from(found.kind.is_one_geometry() && kind != found.kind);
        if !is_right {
            score.wrong.push(format!("{found} ({})", found.reason()));
        }
    }
    for (label, score) in &scores {
        println!("{label}: {} of {} right", score.right, score.all);
        score.wrong.iter().take(3).for_each(|wrong| println!("    {wrong}"));
    }
    scores
}

fn bodies(n_vertices: usize, poses: usize) -> Vec<(String, TriMesh)> {
    let options = ArticulatedOptions { n_vertices, ..Default::default() };
    let all: Vec<_> = Family::all().into_iter().flat_map(|f| (0..poses).map(move |pose| (f, pose))).collect();
    all.into_par_iter()
        .map(|(family, pose)| {
            let shape = articulated_shape(family, pose, &options).unwrap();
            (shape.name, shape.mesh)
        })
        .collect()
}

fn check_every_change(n_vertices: usize, bodies: &[(String, TriMesh)]) {
    println!("{n_vertices} vertices");
    for (label, score) in scores(bodies, &[&VARIANTS[..], &MORE].concat()) {
        assert_eq!(score.falsely_identical, 0, "{label}");
        assert_eq!(score.right, score.all, "{n_vertices} vertices, {label}: {:?}", score.wrong);
    }
}

#[test]
fn every_change_of_a_built_in_shape_is_told() {
    check_every_change(1000, &bodies(1000, 1)[..1]);
}

#[test]
#[ignore = "slow: make test-all"]
fn every_change_of_a_finer_built_in_shape_is_told() {
    for (n_vertices, poses) in [(1000, 2), (3400, 2), (10_000, 1)] {
        check_every_change(n_vertices, &bodies(n_vertices, poses));
    }
}

/// What is said of parts with noise, on their own faces and on new ones: how many are noisy or the same of all, and those that are
/// called variants.
fn noisy_parts(n: usize, noise: f64) -> ([usize; 2], Vec<String>) {
    let told = mechanical_parts(0, n).into_par_iter().flat_map_iter(|part| {
        let mesh = part.mesh(&PartMesh::default());
        let refined = mesh::refine(&mesh, mesh.root_of_area() / 12.0, 20_000).mesh;
        let own = geometry(&mesh);
        let told = [&mesh, &refined].map(|copy| {
            let found = related(&own, &geometry(&Damage::Noise(noise).apply(copy, 7)));
            found.named(&part.name(), "the noisy copy")
        });
        told.into_iter()
    });
    let told: Vec<Relation> = told.collect();
    let is_right = |found: &&Relation| matches!(found.kind, RelationKind::Noisy | RelationKind::Remeshed);
    told.iter()
        .filter(|found| !is_right(found))
        .for_each(|found| println!("{noise}: {found} ({})", found.reason()));
    let variants = told.iter().filter(|found| found.kind == RelationKind::Variant).map(Relation::to_string);
    ([told.iter().filter(is_right).count(), told.len()], variants.collect())
}

#[test]
fn parts_with_noise_are_not_called_variants() {
    let (_, variants) = noisy_parts(8, 0.001);
    assert_eq!(variants, Vec::<String>::new());
}

#[test]
#[ignore = "slow: make test-all"]
fn parts_with_noise_are_told_to_be_noisy() {
    for noise in [0.0003, 0.0005, 0.001, 0.002] {
        let ([right, all], variants) = noisy_parts(15, noise);
        println!("{noise}: {right} of {all}");
        assert_eq!(variants, Vec::<String>::new(), "{noise}");
        assert!(right as f64 >= 14.0 / 15.0 * all as f64, "{noise}: {right} of {all}");
    }
}

/// Parts of which one dimension is larger by 5 %, with noise, that are called one surface at .9 and more. Walls and rounded corners
/// move so little of a surface by so little that noise hides it.
fn near_parts(noise: f64) -> Vec<String> {
    let is_wide =
        |name: &str| ["length", "width", "height", "thickness", "diameter"].iter().any(|x| name.contains(x));
    let mesh = |part: &MechanicalPart| Damage::Subdivide(2).apply(&part.mesh(&PartMesh::default()), 7);
    let called_one = |part: &MechanicalPart| {
        let (own, parameters) = (geometry(&mesh(part)), part.parameters());
        let near = (0..parameters.len()).filter(|&i| is_wide(parameters[i].0)).map(|changed| {
            let value = |(i, (_, x)): (usize, &(&str, f64))| if i == changed { 1.05 * x } else { *x };
            MechanicalPart::new(part.family(), &parameters.iter().enumerate().map(value).collect::<Vec<_>>())
        });
        let told = near.map(|near| {
            let noisy = Damage::Move.apply(&Damage::Noise(noise).apply(&mesh(&near), 7), 7);
            related(&own, &geometry(&noisy)).named(&part.name(), &near.name())
        });
        let one = told.filter(|found| found.kind.is_one_surface() && found.confidence >= 0.9);
        one.map(|found| format!("{noise}: {found} ({})", found.reason())).collect::<Vec<_>>()
    };
    mechanical_parts(0, 8).par_iter().flat_map_iter(called_one).collect()
}

#[test]
fn near_parts_with_noise_are_not_one_surface() {
    assert_eq!(near_parts(0.001), Vec::<String>::new());
}

#[test]
#[ignore = "slow: make test-all"]
fn near_parts_with_less_and_more_noise_are_not_one_surface() {
    assert_eq!([0.0005, 0.002].map(near_parts).concat(), Vec::<String>::new());
}

/// A ring with noise.
fn noisy_ring(thickness: f64, noise: f64) -> MeshGeometry {
    geometry(&Damage::Noise(noise).apply(&shapes::torus(60, 30, 20.0, thickness), 7))
}

#[test]
fn near_bodies_with_noise_are_not_one_surface() {
    let own = geometry(&shapes::torus(60, 30, 20.0, 5.0));
    for noise in [0.0005, 0.001, 0.002] {
        assert_eq!(related(&own, &noisy_ring(5.0, noise)).kind, RelationKind::Noisy);
        let found = related(&own, &noisy_ring(5.1, noise));
        assert!(!found.kind.is_one_surface(), "{noise}: {found}");
    }
}

#[test]
fn two_poses_and_two_bodies_are_not_one_surface() {
    let options = ArticulatedOptions { n_vertices: 1000, ..Default::default() };
    let all: Vec<_> = Family::all()
        .into_par_iter()
        .flat_map_iter(|family| {
            let others = (1..4).map(|body| articulated_body(family, body, 0, &options).unwrap().mesh);
            let geometries: Vec<_> =
                (0..6).map(|i| pose(family, i)).chain(others).map(|mesh| geometry(&mesh)).collect();
            let pairs = (0..geometries.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            pairs.map(|(i, j)| related(&geometries[i], &geometries[j])).collect::<Vec<_>>()
        })
        .collect();
    let wrong: Vec<_> = all.iter().filter(|found| !found.kind.is_by_distance()).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Whether two meshes have the same vertices without any motion, in any order.
fn same_positions(a: &TriMesh, b: &TriMesh) -> bool {
    let sorted = |mesh: &TriMesh| {
        let mut points: Vec<[f64; 3]> = mesh.positions.iter().map(|p| [p.x, p.y, p.z]).collect();
        points.sort_by(|p, q| p.partial_cmp(q).unwrap());
        points
    };
    let is_near = |(p, q): ([f64; 3], [f64; 3])| p.iter().zip(q).all(|(x, y)| (x - y).abs() < 1e-5);
    a.n_vertices() == b.n_vertices() && sorted(a).into_iter().zip(sorted(b)).all(is_near)
}

#[test]
#[ignore = "slow: make test-all"]
fn every_change_of_a_tosca_shape_is_told() {
    let Some(data) = testkit::data("") else { return };
    let files = list_shapes(&data.join("tosca-lowres"), None).unwrap();
    let shapes: Vec<_> =
        files.into_par_iter().filter_map(|file| Some((file.name, mesh_io::read(&file.path).ok()?))).collect();
    let neighbors = shapes.par_windows(2).map(|pair| {
        let found = related(&geometry(&pair[0].1), &geometry(&pair[1].1)).named(&pair[0].0, &pair[1].0);
        // Two pairs of victorias have the same vertices in another order.
        let is_copy = same_positions(&pair[0].1, &pair[1].1);
        assert_eq!(found.kind.is_one_geometry(), is_copy, "{found}");
        (!found.kind.is_by_distance()).then(|| format!("{found} ({})", found.reason()))
    });
    let one: Vec<_> = neighbors.collect::<Vec<_>>().into_iter().flatten().collect();
    println!(
        "{} of {} pairs of different shapes are called one surface: {one:?}",
        one.len(),
        shapes.len() - 1
    );
    // One in three: all of them take minutes.
    let some: Vec<_> = shapes.iter().step_by(3).cloned().collect();
    let scores = scores(&some, &VARIANTS);
    let total = |of: fn(&ToldKinds) -> usize| scores.values().map(of).sum::<usize>();
    let (right, all) = (total(|s| s.right), total(|s| s.all));
    println!("{} shapes: {right} of {all} right, {:.2} %", some.len(), 100.0 * right as f64 / all as f64);
    assert_eq!(total(|s| s.falsely_identical), 0);
    assert!(right as f64 >= 0.98 * all as f64, "{right} of {all}");
}

/// The mesh at a place.
fn at(mesh: &TriMesh, x: f64, y: f64) -> TriMesh {
    testkit::moved(mesh, |p| p + Vector3::new(x, y, 0.0))
}

#[test]
fn copies_on_a_plate_are_counted() {
    let bodies = bodies(1000, 1);
    let [cat, other] = [&bodies[0].1, &bodies[1].1];
    let single = geometry(cat);
    let mut ball = shapes::icosphere(2);
    ball.positions.iter_mut().for_each(|p| *p *= 0.2 * cat.root_of_area());
    for decimated in [false, true] {
        let copy = if decimated { Damage::Decimate(0.5).apply(cat, 1) } else { cat.clone() };
        let copies = |n: usize| (0..n).map(|i| at(&Damage::Move.apply(&copy, i as u64), 9.0 * i as f64, 0.0));
        let six = geometry(&shapes::disjoint(&copies(6).collect::<Vec<_>>()));
        let found = related(&single, &six).named("cat", "plate");
        assert_eq!(
            (found.kind, found.to_string().starts_with("plate is six copies of cat")),
            (RelationKind::Copies, true),
            "{found}"
        );
        assert_eq!(found.has(Change::Remeshed), decimated);
        let back = related(&six, &single).named("plate", "cat");
        assert_eq!(back.evidence.parts.unwrap().whole, Side::First);
        assert!(back.to_string().starts_with("plate is six copies of cat"), "{back}");
        let mixed: Vec<_> = copies(2).chain([at(other, 0.0, 30.0), ball.clone()]).collect();
        let mixed = geometry(&shapes::disjoint(&mixed));
        let found = related(&single, &mixed).named("cat", "plate");
        assert_eq!(found.kind, RelationKind::PartOf, "{found}");
        assert!(
            found.to_string().starts_with("plate has two copies of cat among its four components"),
            "{found}"
        );
        let found = related(&geometry(other), &mixed).named("dog", "plate");
        assert_eq!(found.kind, RelationKind::PartOf);
        assert_eq!(found.to_string(), "dog is part of plate, one of its four components");
        assert_eq!(related(&geometry(&shapes::torus(30, 20, 2.0, 0.5)), &mixed).evidence.parts, None);
    }
}
