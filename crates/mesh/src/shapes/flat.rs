//! Flat sheets, and sheets folded along a mesh line.

use base::SplitMix;
use nalgebra::Point3;
use surface::VertexId;

use crate::tri_mesh::TriMesh;

/// A flat sheet of `nx` x `ny` vertices with spacing `step` in the plane z = 0. The first vertex is the
/// origin, vertex `(i, j)` has the index `j * nx + i`, and all diagonals are parallel.
///
/// # Panics
/// If `nx` or `ny` is below two.
pub fn grid(nx: usize, ny: usize, step: f64) -> TriMesh {
    sheared_grid(nx, ny, step, 0.0)
}

/// A [`grid`] whose rows are shifted along x by `shear` steps each. From 1 on every triangle is obtuse; at
/// `-0.5` triangles are nearly equilateral.
///
/// # Panics
/// If `nx` or `ny` is below two.
pub fn sheared_grid(nx: usize, ny: usize, step: f64, shear: f64) -> TriMesh {
    assert!(nx >= 2 && ny >= 2, "a grid needs two vertices per side, not {nx} x {ny}");
    let positions = (0..nx * ny)
        .map(|v| {
            let (x, y) = ((v % nx) as f64, (v / nx) as f64);
            Point3::new(step * (x + shear * y), step * y, 0.0)
        })
        .collect();
    TriMesh { positions, faces: triangles(nx - 1, ny - 1, |i, j| j * nx + i) }
}

/// A [`grid`] whose inner vertices are moved within the plane by up to `jitter` steps along each axis,
/// determined by `seed`. Below 0.25 no triangle is inverted.
///
/// # Panics
/// If `nx` or `ny` is below two.
pub fn jittered_grid(nx: usize, ny: usize, step: f64, jitter: f64, seed: u64) -> TriMesh {
    let mut mesh = grid(nx, ny, step);
    let mut random = SplitMix(seed);
    for (j, i) in (1..ny - 1).flat_map(|j| (1..nx - 1).map(move |i| (j, i))) {
        let p = &mut mesh.positions[j * nx + i];
        p.x += step * jitter * random.uniform();
        p.y += step * jitter * random.uniform();
    }
    mesh
}

/// Two triangles for each of `nx` x `ny` quads, row by row; `vertex(i, j)` is the vertex at a lattice point.
pub(super) fn triangles(nx: usize, ny: usize, vertex: impl Fn(usize, usize) -> usize) -> Vec<[VertexId; 3]> {
    let quad = |q: usize| {
        let (i, j) = (q % nx, q / nx);
        [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)].map(VertexId::from)
    };
    (0..nx * ny).map(quad).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

/// Rotates everything beyond the line `x = crease, z = 0` around that line by `angle` radians.
///
/// This is an isometry of a sheet in the plane z = 0 if no edge crosses the line.
pub fn fold(sheet: &TriMesh, crease: f64, angle: f64) -> TriMesh {
    let mut folded = sheet.clone();
    let (sin, cos) = angle.sin_cos();
    for p in folded.positions.iter_mut().filter(|p| p.x > crease) {
        let (x, z) = (p.x - crease, p.z);
        p.x = crease + cos * x - sin * z;
        p.z = sin * x + cos * z;
    }
    folded
}
