//! Polygons of any shape, read from OBJ files.

use std::fmt::Write as _;

use canonform_mesh_io::ReadLimits;
use mesh::TriMesh;
use nalgebra::Point3;
use surface::VertexId;

use crate::made::{one, read_all};

/// The triangles of a polygon in space, and whether it counts as bent and as crossing itself.
fn cut(points: &[Point3<f64>]) -> (TriMesh, [bool; 2]) {
    let mut text: String = points.iter().map(|p| format!("v {:e} {:e} {:e}\n", p.x, p.y, p.z)).collect();
    text += "f";
    (1..=points.len()).for_each(|corner| write!(text, " {corner}").unwrap());
    let file = read_all(&one("m.obj", text), &ReadLimits::default()).unwrap();
    let notes = ["polygons that are not flat", "polygons that cross themselves"];
    (file.mesh, notes.map(|note| file.facts.notes.iter().any(|found| found.starts_with(note))))
}

fn flat(points: &[[f64; 2]]) -> Vec<Point3<f64>> {
    points.iter().map(|p| Point3::new(p[0], p[1], 0.0)).collect()
}

#[test]
fn quads_are_split_along_the_inner_or_the_shorter_diagonal() {
    for (points, expected) in [
        ([[0., 0.], [1., 0.], [1., 1.], [0., 1.]], [[0, 1, 2], [0, 2, 3]]),
        ([[0., 0.], [1., 0.], [4., 1.], [0., 1.]], [[0, 1, 3], [1, 2, 3]]),
        // An arrow head with its notch at corner 1: only the diagonal from the notch stays inside.
        ([[0., 0.], [1., 1.], [2., 0.], [1., 3.]], [[0, 1, 3], [1, 2, 3]]),
        ([[1., 1.], [2., 0.], [1., 3.], [0., 0.]], [[0, 1, 2], [0, 2, 3]]),
    ] {
        let faces = cut(&flat(&points)).0.faces;
        assert_eq!(faces, expected.map(|face| face.map(VertexId)), "{points:?}");
    }
}

/// A polygon turned in space, far away and large, which changes no coordinate to an integer.
fn turned(points: &[[f64; 2]]) -> Vec<Point3<f64>> {
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, 1.1, -0.7);
    let place = |p: &[f64; 2]| turn * Point3::new(700.0 * p[0] + 3e4, 700.0 * p[1], -2e4);
    points.iter().map(place).collect()
}

fn twice_enclosed(points: &[[f64; 2]]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|([a, b], [c, d])| a * d - b * c).sum()
}

#[test]
fn polygons_of_any_shape_are_covered_once_with_all_corners() {
    let comb = |teeth: i32| {
        let teeth_of = |i: i32| [[f64::from(i), 0.1], [f64::from(i) + 0.5, 3.0]];
        let mut comb: Vec<[f64; 2]> = (0..teeth).flat_map(teeth_of).collect();
        comb.extend([[f64::from(teeth), 0.0], [0.0, 0.0]]);
        comb.reverse();
        comb
    };
    let round = |n: u32, radius: fn(u32) -> f64| -> Vec<[f64; 2]> {
        let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
        (0..n).map(|i| [radius(i) * angle(i).cos(), radius(i) * angle(i).sin()]).collect()
    };
    let polygons: Vec<Vec<[f64; 2]>> = vec![
        // Concave, its notch near an edge.
        vec![[0., 0.], [4., 0.], [4., 4.], [2., 1.], [0., 4.]],
        // Corners in a row, on one edge and on all.
        vec![[0., 0.], [1., 0.], [2., 0.], [4., 0.], [4., 4.], [0., 4.]],
        vec![[0., 0.], [2., 0.], [4., 0.], [3., 2.], [2., 4.], [1., 2.]],
        vec![[0., 0.], [1., 0.], [2., 0.], [2., 1.], [2., 2.], [1., 2.], [0., 2.], [0., 1.]],
        // An L and a U of squares, whose diagonals run along edges.
        vec![[0., 0.], [1., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.], [0., 1.]],
        vec![[0., 0.], [3., 0.], [3., 2.], [2., 2.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]],
        comb(40),
        round(64, |_| 1.0),
        round(200, |i| if i % 2 == 0 { 1.0 } else { 0.2 }),
    ];
    for polygon in &polygons {
        let n = polygon.len();
        for first in 0..n {
            let rolled: Vec<[f64; 2]> = polygon.iter().cycle().skip(first).take(n).copied().collect();
            let mirrored: Vec<[f64; 2]> = rolled.iter().rev().copied().collect();
            for (points, scale) in
                [&rolled, &mirrored].into_iter().flat_map(|p| [(flat(p), 1.0), (turned(p), 700.0 * 700.0)])
            {
                let (mesh, uncertain) = cut(&points);
                assert_eq!(uncertain, [false; 2], "{points:?}");
                assert_eq!(mesh.n_faces(), n - 2);
                let expected = twice_enclosed(polygon).abs() / 2.0 * scale;
                assert!((mesh.area() / expected - 1.0).abs() < 1e-9, "{} {expected} {points:?}", mesh.area());
                let least = mesh.face_areas().fold(f64::INFINITY, f64::min);
                assert!(least > 1e-6 * expected, "a face of {least}: {:?} of {points:?}", mesh.faces);
                // A disc, whose boundary is the polygon.
                let report = mesh::validate(&mesh);
                assert_eq!((report.euler_characteristic, report.n_boundary_edges), (1, n));
                assert_eq!((report.n_boundary_loops, report.flipped_faces), (1, 0));
            }
        }
    }
}

#[test]
fn polygons_whose_surface_is_uncertain_are_counted() {
    let star: Vec<[f64; 2]> = (0..5).map(|i| (f64::from(i) * 4.0 * 0.628_318_53).sin_cos().into()).collect();
    let noise = |i: u32| f64::from(i.wrapping_mul(2_654_435_761).rotate_left(11).wrapping_mul(40_503) >> 8);
    let everywhere = (0..2_000).map(|i| [noise(2 * i), noise(2 * i + 1)]).collect();
    for crossing in [star, everywhere] {
        let (mesh, uncertain) = cut(&turned(&crossing));
        assert_eq!((mesh.n_faces(), uncertain), (crossing.len() - 2, [false, true]));
    }
    let square = |height: f64| {
        [[0., 0., height], [1., 0., -height], [1., 1., height], [0., 1., -height]].map(Point3::from)
    };
    assert_eq!(cut(&square(0.009)).1, [false; 2]);
    assert_eq!(cut(&square(0.011)).1, [true, false]);
    let roof = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0.5, 1.5, 0.4], [0., 1., 0.]].map(Point3::from);
    assert_eq!(cut(&roof).1, [true, false]);
    // Corners in one position, in one line, or beyond all numbers.
    for corners in [[[1., 2., 3.]; 6], [0., 1., 2., 3., 2., 1.].map(|x| [x, x, 0.]), [[1e308, -1e308, 0.]; 6]]
    {
        assert_eq!(cut(&corners.map(Point3::from)).0.n_faces(), 4);
    }
}
