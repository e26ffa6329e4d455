//! How a changed mesh is related to the original.

use std::sync::LazyLock;

use canonform::collection::list_shapes;
use canonform::descriptors::Side;
use canonform::relations::{Change, MeshGeometry, Relation, RelationKind};
use canonform::rigid::Handedness;
use datasets::{
    ArticulatedOptions, Damage, Family, MechanicalPart, PartFamily, PartMesh, articulated_body,
    articulated_shape, mechanical_parts,
};
use descriptors::ShapeDistance;
use mesh::{TriMesh, shapes};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::support::{SHAPES, pose};

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
const MORE: [Variant; 5] = [
    (&[Damage::Subdivide(2)], RelationKind::Remeshed, &[Change::Subdivided]),
    (&[Damage::Holes(0.01)], RelationKind::Remeshed, &[]),
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

/// Changes all shapes in every way, and returns what is told wrong, and of how many. No change is called identical.
fn told_wrong(shapes: &[(String, TriMesh)], variants: &[Variant]) -> (Vec<String>, usize) {
    let told = |(name, mesh): &(String, TriMesh)| {
        let own = geometry(mesh);
        let invariants = own.invariants();
        let of_variant = |(damages, kind, changes): &Variant| {
            let changed = damages.iter().fold(mesh.clone(), |mesh, damage| damage.apply(&mesh, 7));
            let changed = geometry(&changed);
            let found = related(&own, &changed).named(name, "the copy");
            let label = damages.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            let told = format!("{label}: {found} ({})", found.reason());
            let may_be_copy = invariants.may_be_copy_of(&changed.invariants());
            assert!(may_be_copy || !kind.is_one_surface(), "{told}");
            assert!(found.kind == *kind || !found.kind.is_one_geometry(), "{told}");
            let is_right = found.kind == *kind && changes.iter().all(|change| found.has(*change));
            (!is_right).then_some(told)
        };
        variants.par_iter().filter_map(of_variant).collect::<Vec<_>>()
    };
    (shapes.par_iter().flat_map_iter(told).collect(), shapes.len() * variants.len())
}

fn check_every_change(bodies: &[(String, TriMesh)]) {
    let (wrong, _) = told_wrong(bodies, &[&VARIANTS[..], &MORE].concat());
    assert_eq!(wrong, Vec::<String>::new());
}

#[test]
fn every_change_of_a_built_in_shape_is_told() {
    check_every_change(&[("cat".to_owned(), pose(Family::Cat, 0))]);
}

#[test]
#[ignore = "slow: make test-all"]
fn every_change_of_a_finer_built_in_shape_is_told() {
    for (n_vertices, n_poses) in [(1000, 2), (3400, 2), (10_000, 1)] {
        let options = ArticulatedOptions { n_vertices, ..Default::default() };
        let poses = Family::all().into_iter().flat_map(|family| (0..n_poses).map(move |pose| (family, pose)));
        let shapes = poses.map(|(family, pose)| articulated_shape(family, pose, &options).unwrap());
        println!("{n_vertices} vertices");
        check_every_change(&shapes.map(|shape| (shape.name, shape.mesh)).collect::<Vec<_>>());
    }
}

/// Asserts what is told of parts with noise, on their own faces and on new ones: none is called a variant, and nearly all are
/// noisy or the same.
fn check_noisy_parts(n: usize, noise: f64) {
    let told = mechanical_parts(0, n).into_par_iter().flat_map_iter(|part| {
        let mesh = part.mesh(&PartMesh::default());
        let refined = mesh::refine(&mesh, mesh.root_of_area() / 12.0, 20_000).mesh;
        let own = geometry(&mesh);
        [mesh, refined].map(|copy| {
            let found = related(&own, &geometry(&Damage::Noise(noise).apply(&copy, 7)));
            found.named(&part.name(), "the noisy copy")
        })
    });
    let told: Vec<Relation> = told.collect();
    let is_right = |found: &&Relation| matches!(found.kind, RelationKind::Noisy | RelationKind::Remeshed);
    let wrong: Vec<_> = told.iter().filter(|found| !is_right(found)).collect();
    assert!(wrong.iter().all(|found| found.kind != RelationKind::Variant), "{noise}: {wrong:#?}");
    assert!(wrong.len() * 15 <= told.len(), "{noise}: {wrong:#?}");
}

#[test]
fn parts_with_noise_are_not_called_variants() {
    check_noisy_parts(8, 0.001);
}

#[test]
#[ignore = "slow: make test-all"]
fn parts_with_noise_are_told_to_be_noisy() {
    [0.0003, 0.0005, 0.001, 0.002].into_iter().for_each(|noise| check_noisy_parts(15, noise));
}

/// Parts of which one dimension is larger by 5 %, with noise, that are called one surface at .9 and more. Walls and rounded corners
/// move so little of a surface by so little that noise hides it.
fn near_parts(n: usize, noise: f64) -> Vec<String> {
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
    mechanical_parts(0, n).par_iter().flat_map_iter(called_one).collect()
}

#[test]
fn near_parts_with_noise_are_not_one_surface() {
    assert_eq!(near_parts(4, 0.001), Vec::<String>::new());
}

#[test]
#[ignore = "slow: make test-all"]
fn near_parts_with_less_and_more_noise_are_not_one_surface() {
    let called_one = [0.0005, 0.001, 0.002].map(|noise| near_parts(8, noise));
    assert_eq!(called_one.concat(), Vec::<String>::new());
}

#[test]
fn variants_of_parts_name_the_dimensions_that_differ_wherever_they_lie() {
    let bracket = &[42.0, 30.0, 20.0, 3.5, 4.0, 1.0][..];
    let (plate, shaft) = (&[40.0, 25.0, 3.0, 3.0, 4.0, 4.0], &[8.0, 12.0, 10.0, 15.0, 32.0, 18.0]);
    let enclosure = &[60.0, 40.0, 20.0, 2.0, 2.0];
    for (family, values, changed, value, words) in [
        (PartFamily::Bracket, bracket, 1, 40.0, "width 30 → 40, step 26.5 → 36.5"),
        (PartFamily::Bracket, bracket, 4, 5.0, "hole diameter 4 → 5"),
        (PartFamily::Bracket, bracket, 5, 2.0, "number of holes 2 → 4"),
        (PartFamily::Plate, plate, 0, 42.0, "length 40 → 42"),
        (PartFamily::Plate, plate, 3, 2.0, "diameter 6 → 4"),
        (PartFamily::Plate, plate, 4, 5.0, "hole diameter 4 → 5"),
        (PartFamily::Shaft, shaft, 1, 13.0, "diameter 12 → 13, width 12 → 13, height 12 → 13"),
        // They share most triangles.
        (PartFamily::Shaft, shaft, 5, 20.0, "length 65 → 67, step 18 → 20"),
        (PartFamily::Enclosure, enclosure, 2, 22.0, "height 20 → 22"),
    ] {
        let own = MechanicalPart::new(family, values).mesh(&PartMesh::default());
        let mut values = values.to_vec();
        values[changed] = value;
        let other = MechanicalPart::new(family, &values).mesh(&PartMesh::default());
        let [own, other] = [geometry(&own), geometry(&Damage::Move.apply(&other, 7))];
        let found = related(&own, &other).named("a", "b").to_string();
        assert_eq!(found, format!("b is a variant of a: {words}"));
    }
}

#[test]
fn near_bodies_with_noise_are_not_one_surface() {
    let ring = |thickness: f64| shapes::torus(60, 30, 20.0, thickness);
    let own = geometry(&ring(5.0));
    for noise in [0.0005, 0.001, 0.002] {
        let found = [5.0, 5.1].map(|x| related(&own, &geometry(&Damage::Noise(noise).apply(&ring(x), 7))));
        assert_eq!(found[0].kind, RelationKind::Noisy);
        assert!(!found[1].kind.is_one_surface(), "{noise}: {}", found[1]);
    }
}

#[test]
fn bodies_with_a_longer_limb_are_hardly_ever_one_surface() {
    let options = ArticulatedOptions { n_vertices: 1000, ..Default::default() };
    let bodies = Family::all().into_par_iter().flat_map_iter(|family| [1, 2, 3].map(|seed| (family, seed)));
    let told = bodies.map(|(family, seed)| {
        let mesh = articulated_shape(family, 0, &options).unwrap().mesh;
        let longer = Damage::Subdivide(1).apply(&Damage::Lengthen(0.1).apply(&mesh, seed), 7);
        related(&geometry(&mesh), &geometry(&longer)).named(family.name(), "longer")
    });
    // A tenth of a short limb is little of a body.
    let is_apart = |found: &Relation| found.evidence.surface_gap.is_some_and(|gap| gap.max > 0.01);
    let apart: Vec<Relation> = told.filter(is_apart).collect();
    let is_one = |found: &&Relation| found.kind.is_one_surface() && found.confidence >= 0.9;
    let one: Vec<_> = apart.iter().filter(is_one).collect();
    // `experiments relations` calls 3 of 27 of 3,400 vertices so.
    assert!(apart.len() > 4 && one.len() < 2, "{} of {}: {one:#?}", one.len(), apart.len());
}

#[test]
fn two_poses_and_two_bodies_are_not_one_surface() {
    // Made before the threads below wait for them, which make them.
    LazyLock::force(&SHAPES);
    let options = ArticulatedOptions { n_vertices: 1000, ..Default::default() };
    let all: Vec<_> = Family::all()
        .into_par_iter()
        .flat_map_iter(|family| {
            let others = (1..3).map(|body| articulated_body(family, body, 0, &options).unwrap().mesh);
            let geometries: Vec<_> =
                (0..4).map(|i| pose(family, i)).chain(others).map(|mesh| geometry(&mesh)).collect();
            let pairs = (0..geometries.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            pairs.map(|(i, j)| related(&geometries[i], &geometries[j])).collect::<Vec<_>>()
        })
        .collect();
    let wrong: Vec<_> = all.iter().filter(|found| !found.kind.is_by_distance()).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
#[ignore = "slow: make test-all"]
fn every_change_of_a_tosca_shape_is_told() {
    let Some(data) = testkit::data("") else { return };
    let files = list_shapes(&data.join("tosca-lowres"), None).unwrap();
    let shapes: Vec<_> =
        files.into_par_iter().filter_map(|file| Some((file.name, mesh_io::read(&file.path).ok()?))).collect();
    let neighbors = shapes.par_windows(2).filter_map(|pair| {
        let found = related(&geometry(&pair[0].1), &geometry(&pair[1].1));
        found.kind.is_one_geometry().then(|| format!("{} {}", pair[0].0, pair[1].0))
    });
    let one: Vec<_> = neighbors.collect();
    // They have the same vertices in another order.
    assert_eq!(one, ["victoria0 victoria1", "victoria20 victoria21"]);
    // One in three: all of them take minutes.
    let some: Vec<_> = shapes.into_iter().step_by(3).collect();
    let (wrong, all) = told_wrong(&some, &VARIANTS);
    assert!(wrong.len() * 50 <= all, "{} of {all}: {wrong:#?}", wrong.len());
}

#[test]
fn copies_on_a_plate_are_counted() {
    let at = |mesh: &TriMesh, x: f64, y: f64| testkit::moved(mesh, |p| p + Vector3::new(x, y, 0.0));
    let [cat, other] = [Family::Cat, Family::Centaur].map(|family| pose(family, 0));
    let single = geometry(&cat);
    let ball = testkit::moved(&shapes::icosphere(2), |p| p * 0.2 * cat.root_of_area());
    let dust = at(&testkit::moved(&ball, |p| p * 0.01), 0.0, 30.0);
    let found = related(&single, &geometry(&shapes::disjoint(&[cat.clone(), dust]))).named("cat", "scan");
    assert!(found.to_string().starts_with("cat is part of scan, its only large component"), "{found}");
    for decimated in [false, true] {
        let copy = if decimated { Damage::Decimate(0.5).apply(&cat, 1) } else { cat.clone() };
        let copies = |n: usize| (0..n).map(|i| at(&Damage::Move.apply(&copy, i as u64), 9.0 * i as f64, 0.0));
        let six = geometry(&shapes::disjoint(&copies(6).collect::<Vec<_>>()));
        for (pair, names, whole) in [
            ([&single, &six], ["cat", "plate"], Side::Second),
            ([&six, &single], ["plate", "cat"], Side::First),
        ] {
            let found = related(pair[0], pair[1]).named(names[0], names[1]);
            assert!(found.to_string().starts_with("plate is six copies of cat"), "{found}");
            assert_eq!((found.kind, found.evidence.parts.unwrap().whole), (RelationKind::Copies, whole));
            assert_eq!(found.has(Change::Remeshed), decimated);
        }
        let mixed: Vec<_> = copies(2).chain([at(&other, 0.0, 30.0), ball.clone()]).collect();
        let mixed = geometry(&shapes::disjoint(&mixed));
        for (mesh, name, told) in [
            (&cat, "cat", "plate has two copies of cat among its four components"),
            (&other, "dog", "dog is part of plate, one of its four components"),
        ] {
            let found = related(&geometry(mesh), &mixed).named(name, "plate");
            assert!(found.kind == RelationKind::PartOf && found.to_string().starts_with(told), "{found}");
        }
        assert_eq!(related(&geometry(&shapes::torus(30, 20, 2.0, 0.5)), &mixed).evidence.parts, None);
    }
}
