//! Small meshes for the tests.

use crate::image::RgbaImage;
use mesh::TriMesh;
use nalgebra::Point3;
use surface::VertexId;

impl RgbaImage {
    /// The pixel in column `x` and row `y`, from the top left.
    pub(crate) fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width() && y < self.height(), "pixel {x}, {y} is outside");
        self.pixels()[y as usize * self.width() as usize + x as usize]
    }
}

pub(crate) fn mesh(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> TriMesh {
    TriMesh {
        positions: positions.iter().map(|p| Point3::from(*p)).collect(),
        faces: faces.iter().map(|f| f.map(VertexId)).collect(),
    }
}

/// A unit sphere around the z axis, `2 n` by `n` quadrilaterals.
pub(crate) fn sphere(n: usize) -> TriMesh {
    let mut positions = Vec::new();
    for ring in 0..=n {
        for slice in 0..2 * n {
            let (polar, azimuth) = (
                ring as f64 / n as f64 * std::f64::consts::PI,
                slice as f64 / n as f64 * std::f64::consts::PI,
            );
            positions.push([polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()]);
        }
    }
    let at = |ring: usize, slice: usize| (ring * 2 * n + slice % (2 * n)) as u32;
    let faces: Vec<[u32; 3]> = (0..n)
        .flat_map(|r| (0..2 * n).map(move |s| (r, s)))
        .flat_map(|(r, s)| {
            [[at(r, s), at(r + 1, s), at(r + 1, s + 1)], [at(r, s), at(r + 1, s + 1), at(r, s + 1)]]
        })
        .collect();
    mesh(&positions, &faces)
}
