//! Dense maps between surfaces: exact cases, invariances, and known partners.

use canonform::maps::{MapKind, SurfaceMap};
use datasets::Family;
use geodesics::Method;
use mesh::{TriMesh, shapes};
use nalgebra::{Point3, Rotation3};
use surface::VertexId;

use crate::rested::{CATS, Rested, of_kind, prepared};

fn maps(a: &TriMesh, b: &TriMesh) -> Vec<SurfaceMap> {
    crate::rested::maps(&prepared(a), &prepared(b))
}

fn images(map: &SurfaceMap) -> Vec<usize> {
    map.vertices.iter().map(|v| v.unwrap().index()).collect()
}

/// The share of vertices with the expected partner.
fn share(found: &[usize], expected: impl Fn(usize) -> usize) -> f64 {
    found.iter().enumerate().filter(|(x, y)| **y == expected(*x)).count() as f64 / found.len() as f64
}

#[test]
fn motions_scale_and_numbering_change_no_map() {
    let ([a, b], usual) = &*CATS;
    let b = &b.mesh;
    let maps = |b: &TriMesh| crate::rested::maps(&a.mapped, &prepared(b));
    let turn = Rotation3::from_euler_angles(0.3, 2.0, -1.0);
    let moved = testkit::moved(b, |p| turn * *p * 7.0 + Point3::new(1.0, 2.0, 3.0).coords);
    let n = b.n_vertices();
    let (moved, renumbered) = (maps(&moved), maps(&testkit::renumbered(b)));
    for kind in [MapKind::Direct, MapKind::Mirrored] {
        let expected = images(of_kind(usual, kind));
        assert!(share(&images(of_kind(&moved, kind)), |x| expected[x]) > 0.99);
        // Other samples: some vertices go to a neighbor.
        let other = images(of_kind(&renumbered, kind));
        let solver = Method::default().prepare(b.intrinsic(), &()).unwrap();
        let gap = |x: usize| {
            solver.distances(VertexId::from(n - 1 - other[x])).unwrap()[expected[x]] / b.area().sqrt()
        };
        let mean = (0..n).step_by(10).map(gap).sum::<f64>() / (n as f64 / 10.0);
        assert!(mean < 0.02, "{kind:?}: {mean}");
    }
}

#[test]
fn a_mirror_image_is_matched_by_the_mirrored_map() {
    // A hand: without symmetry, so that only one map is good.
    let hand = shapes::grid(41, 31, 0.1);
    let mut hand = shapes::fold(&hand, 0.8, 1.2);
    // Cut a corner, so that the sheet has no symmetry.
    hand.faces.retain(|face| {
        let p = face.map(|v| hand.positions[v.index()]);
        p.iter().map(|p| p.x + 1.6 * p.y).fold(f64::INFINITY, f64::min) > 1.9
    });
    let mut other = hand.clone();
    other.positions.iter_mut().for_each(|p| p.x = -p.x);
    let found = maps(&hand, &other);
    assert_eq!(found[0].kind, MapKind::Mirrored, "{}", found[0].distortion);
}

#[test]
fn maps_do_not_depend_on_threads() {
    let a = shapes::jittered_grid(25, 19, 0.1, 0.2, 3);
    let b = shapes::subdivide(&shapes::grid(13, 10, 0.2));
    let [one, three] = [1, 3].map(|n| testkit::on_threads(n, || maps(&a, &b)));
    assert_eq!(one, three);
}

#[test]
fn poses_are_mapped_to_their_true_partners() {
    let (cats, maps) = &*CATS;
    are_true(cats, maps);
}

#[test]
#[ignore = "slow: make test-all"]
fn more_poses_are_mapped_to_their_true_partners() {
    let pairs = [
        (Family::Cat, [0, 3]),
        (Family::Centaur, [1, 2]),
        // The mirror of the second man that distorts least exchanges front and back.
        (Family::David, [5, 6]),
        // A map that mixes the direct and the mirrored one distorts least.
        (Family::Centaur, [2, 4]),
        (Family::David, [2, 5]),
        // Most starts turn this man back to front.
        (Family::David, [0, 5]),
    ];
    for (family, poses) in pairs {
        let pair = poses.map(|pose| Rested::pose(family, pose, 1500));
        println!("{}", family.name());
        are_true(&pair, &pair[0].maps_to(&pair[1]));
    }
}

/// Asserts that both maps of two poses are near the true ones.
fn are_true([a, b]: &[Rested; 2], found: &[SurfaceMap]) {
    for kind in [MapKind::Direct, MapKind::Mirrored] {
        let map = of_kind(found, kind);
        let mean = a.error(b, map, b.mesh.area().sqrt());
        println!("{kind:?}: {mean:.4}, confidence {:.2}", map.confidence);
        assert!(mean < 0.035, "{kind:?}: {mean}");
        assert_eq!(map.alternative.is_none(), map.is_certain());
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn wrong_maps_are_uncertain_and_at_least_half_of_the_right_ones_are_not() {
    let (mut right, mut doubted) = (0, 0);
    for (family, poses) in [(Family::David, 3..8), (Family::Cat, 1..4)] {
        let shapes: Vec<_> = poses.map(|pose| Rested::pose(family, pose, 1500)).collect();
        for (a, b) in shapes.iter().zip(&shapes[1..]) {
            for map in a.maps_to(b) {
                let mean = a.error(b, &map, b.mesh.area().sqrt());
                let name = family.name();
                println!("{name} {:?}: {mean:.4}, confidence {:.2}", map.kind, map.confidence);
                if mean < 0.1 {
                    right += 1;
                    doubted += usize::from(!map.is_certain());
                } else {
                    assert!(!map.is_certain(), "{name} {:?}: {mean}, {}", map.kind, map.confidence);
                }
            }
        }
    }
    // Men of so few vertices are often doubted; with 3,400, one of 39 is.
    assert!(right >= 10 && doubted * 2 <= right, "{doubted} of {right} right maps are doubted");
}

#[test]
fn a_sheet_that_fits_in_two_ways_is_uncertain_and_both_are_returned() {
    let flat = shapes::grid(25, 19, 0.1);
    let found = maps(&flat, &shapes::fold(&flat, 0.9, 1.2));
    let n = flat.n_vertices();
    for map in &found {
        assert!(!map.is_certain(), "{:?}: {}", map.kind, map.confidence);
        let other = map.alternative.as_ref().expect("the other way");
        // They differ by half a turn.
        let turned = images(other);
        let gap = |(x, y): (usize, &usize)| {
            (flat.positions[*y] - flat.positions[turned[n - 1 - x]]).norm() / flat.area().sqrt()
        };
        let mean = images(map).iter().enumerate().map(gap).sum::<f64>() / n as f64;
        assert!(mean < 0.05, "{:?}: {mean}", map.kind);
    }
}
