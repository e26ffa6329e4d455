//! Spheres, tori, polyhedra, and the open cylinder.

use std::f64::consts::TAU;

use nalgebra::Point3;
use surface::VertexId;

use super::flat::triangles;
use super::subdivide;
use crate::tri_mesh::TriMesh;

fn from_arrays(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> TriMesh {
    TriMesh {
        positions: positions.iter().map(|&p| Point3::from(p)).collect(),
        faces: faces.iter().map(|f| f.map(VertexId)).collect(),
    }
}

fn subdivided(mesh: TriMesh, level: u32) -> TriMesh {
    (0..level).fold(mesh, |mesh, _| subdivide(&mesh))
}

/// A regular tetrahedron with corners at (+-1, +-1, +-1), each face split into `4^level`.
pub fn tetrahedron(level: u32) -> TriMesh {
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    subdivided(from_arrays(&corners, &[[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]), level)
}

/// The unit cube [0, 1]^3, each of its twelve triangles split into `4^level`.
pub fn cube(level: u32) -> TriMesh {
    let corners: Vec<[f64; 3]> =
        (0..8).map(|i| [f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)]).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    subdivided(from_arrays(&corners, &faces), level)
}

/// A unit sphere: an icosahedron subdivided `level` times with all vertices on the sphere, `10 * 4^level + 2`
/// of them.
pub fn icosphere(level: u32) -> TriMesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    // Three rectangles at right angles, with sides in the golden ratio.
    let rectangle = [[-1.0, g, 0.0], [1.0, g, 0.0], [-1.0, -g, 0.0], [1.0, -g, 0.0]];
    let turned = |turns: usize| {
        rectangle.map(|mut corner| {
            corner.rotate_right(turns);
            corner
        })
    };
    let corners = [turned(0), turned(1), turned(2)].concat();
    #[rustfmt::skip]
    let faces = [
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
        [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
        [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
        [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ];
    let on_sphere = |mut mesh: TriMesh| {
        mesh.positions.iter_mut().for_each(|p| *p = Point3::from(p.coords.normalize()));
        mesh
    };
    (0..level).fold(on_sphere(from_arrays(&corners, &faces)), |mesh, _| on_sphere(subdivide(&mesh)))
}

/// The side of a cylinder around the z axis, open at both ends: `n_around` x `n_along` vertices, ring by ring
/// from z = 0 to z = `height`.
///
/// # Panics
/// If `n_around` is below three or `n_along` below two.
pub fn cylinder(n_around: usize, n_along: usize, radius: f64, height: f64) -> TriMesh {
    assert!(n_around >= 3 && n_along >= 2, "a cylinder needs 3 x 2 vertices, not {n_around} x {n_along}");
    let positions = (0..n_along * n_around)
        .map(|v| {
            let (sin, cos) = (TAU * (v % n_around) as f64 / n_around as f64).sin_cos();
            let z = height * (v / n_around) as f64 / (n_along - 1) as f64;
            Point3::new(radius * cos, radius * sin, z)
        })
        .collect();
    TriMesh { positions, faces: triangles(n_around, n_along - 1, |i, j| j * n_around + i % n_around) }
}

/// A torus around the z axis with the radii `major` of the ring and `minor` of the tube: `n_major` x
/// `n_minor` vertices.
///
/// # Panics
/// If `n_major` or `n_minor` is below three.
pub fn torus(n_major: usize, n_minor: usize, major: f64, minor: f64) -> TriMesh {
    assert!(n_major >= 3 && n_minor >= 3, "a torus needs 3 x 3 vertices, not {n_major} x {n_minor}");
    let positions = (0..n_major * n_minor)
        .map(|v| {
            let (sin_u, cos_u) = (TAU * (v % n_major) as f64 / n_major as f64).sin_cos();
            let (sin_v, cos_v) = (TAU * (v / n_major) as f64 / n_minor as f64).sin_cos();
            let r = major + minor * cos_v;
            Point3::new(r * cos_u, r * sin_u, minor * sin_v)
        })
        .collect();
    let vertex = |i, j| (j % n_minor) * n_major + i % n_major;
    TriMesh { positions, faces: triangles(n_major, n_minor, vertex) }
}

/// A torus of 40 x 20 vertices with a bump: no symmetry.
pub fn lopsided_torus() -> TriMesh {
    let mut mesh = torus(40, 20, 2.0, 0.7);
    for p in &mut mesh.positions {
        let bump = (-(*p - Point3::new(2.4, 0.5, 0.3)).norm_squared()).exp();
        p.coords *= 1.0 + 0.5 * bump + 0.1 * p.y;
    }
    mesh
}
