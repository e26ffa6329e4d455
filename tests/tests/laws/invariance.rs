//! Signatures depend on the surface, not on its triangles.

use canonform::embed::signature;
use canonform::index::Shape;
use canonform::{DescribeOptions, describe};
use datasets::{ArticulatedOptions, Damage, Family, articulated_shape};
use descriptors::{ShapeMetric, ShapePair, SignatureKind};
use mesh::TriMesh;
use rayon::prelude::*;

use crate::support::surface;

/// Largest combined distance of shapes with the same surface, at 250 vertices and more.
const SAME_SURFACE: f64 = 0.4;

/// The same by one signature, in its unit.
const SAME_SIGNATURE: f64 = 0.6;

/// The same by the spectrum of the form, which a coarse mesh changes more when it is subdivided: by up to 0.79 at 250 vertices.
/// The combined distance does not contain it.
const SAME_FORM: f64 = 0.8;

/// Largest combined distance of a shape with 4,000 vertices or more from the damaged one, whose surface is as good as the
/// same.
const SAME_SHAPE: f64 = 1.0;

/// The same with 1,000 vertices. One class is certain up to 3.04.
const SAME_COARSE_SHAPE: f64 = 2.45;

/// Changes that keep the surface.
const SAME: [Damage; 4] = [Damage::Subdivide(1), Damage::Move, Damage::Scale, Damage::Mirror];

fn described(mesh: &TriMesh) -> Shape {
    describe(&surface(mesh), &DescribeOptions::default(), &()).unwrap()
}

/// The change of a signature in its unit.
fn change_of(kind: SignatureKind, [a, b]: [&Shape; 2]) -> f64 {
    let [a, b] = [a, b].map(|shape| signature(shape, kind).unwrap());
    a.distance(&b) / ShapeMetric::unit(kind)
}

/// The largest change of a signature other than the spectrum of the form, and the combined distance.
fn change(a: &Shape, b: &Shape) -> (f64, f64) {
    let kinds = SignatureKind::INTRINSIC.into_iter().filter(|kind| *kind != SignatureKind::FormSpectrum);
    let largest = kinds.map(|kind| change_of(kind, [a, b])).fold(0.0, f64::max);
    let shapes = [a, b].map(|shape| DescribeOptions::default().prepare(shape).unwrap());
    (largest, ShapePair::new([&shapes[0], &shapes[1]]).distance().combined)
}

/// A shape of the built-in families with any number of vertices.
fn body(family: Family, n_vertices: usize) -> TriMesh {
    let options = ArticulatedOptions { n_vertices: n_vertices.max(1000), ..Default::default() };
    let mesh = articulated_shape(family, 2, &options).unwrap().mesh;
    match n_vertices < 1000 {
        true => Damage::Decimate(n_vertices as f64 / 1000.0).apply(&mesh, 1),
        false => mesh,
    }
}

/// Asserts a bound on the changes by each of the damages of bodies with this many vertices.
fn check(n_vertices: usize, damages: &[(Damage, f64)]) {
    let bodies: Vec<_> =
        Family::all().into_par_iter().map(|family| (family, body(family, n_vertices))).collect();
    bodies.par_iter().for_each(|(family, mesh)| {
        let body = format!("{} of {n_vertices} vertices", family.name());
        check_body(mesh, &body, damages);
    });
}

fn check_body(mesh: &TriMesh, body: &str, damages: &[(Damage, f64)]) {
    let before = described(mesh);
    for (damage, most) in damages {
        let after = described(&damage.apply(mesh, 7));
        let (signature, combined) = change(&before, &after);
        let form = change_of(SignatureKind::FormSpectrum, [&before, &after]);
        let what = format!("{body}, {damage}");
        println!("{what}: {combined:.3}, by one signature {signature:.3}, by the form {form:.3}");
        let is_same = signature < SAME_SIGNATURE && form < SAME_FORM;
        assert!(combined < *most && (is_same || *most > SAME_SURFACE), "{what}");
    }
}

#[test]
fn the_same_surface_has_the_same_signatures() {
    assert!(SAME.iter().all(|damage| damage.keeps_surface()));
    check(250, &SAME.map(|damage| (damage, SAME_SURFACE)));
}

#[test]
#[ignore = "slow: make test-all"]
fn another_triangulation_is_the_same_shape() {
    let damages = [Damage::Remesh, Damage::Decimate(0.5), Damage::Decimate(0.2)];
    check(1000, &[damages[0], damages[1]].map(|damage| (damage, SAME_COARSE_SHAPE)));
    check(4000, &damages.map(|damage| (damage, SAME_SHAPE)));
}

#[test]
fn noise_and_small_holes_leave_the_same_shape() {
    let damages = [Damage::Noise(0.002), Damage::Holes(0.01)].map(|damage| (damage, SAME_COARSE_SHAPE));
    // Noise much smaller than the edges cannot be told from shape.
    check(1000, &[&damages[..], &[(Damage::Noise(0.005), 2.87)]].concat());
}

#[test]
#[ignore = "slow: make test-all"]
fn finer_meshes_are_the_same_shape_when_damaged() {
    [1000, 4000].into_iter().for_each(|n| check(n, &SAME.map(|damage| (damage, SAME_SURFACE))));
    check(250, &[(Damage::Subdivide(3), SAME_SURFACE)]);
    let damages = [Damage::Noise(0.002), Damage::Noise(0.005), Damage::Holes(0.01)];
    let damages = damages.map(|damage| (damage, SAME_SHAPE));
    check(4000, &damages);
    check(16_000, &damages[..2]);
}

#[test]
#[ignore = "slow: make test-all"]
fn large_meshes_are_the_same_shape_as_small_and_noisy_ones() {
    let mesh = body(Family::all()[0], 50_000);
    let damages = [Damage::Decimate(0.1), Damage::Noise(0.001)];
    check_body(&mesh, "50,000 vertices", &damages.map(|damage| (damage, SAME_SURFACE)));
}
