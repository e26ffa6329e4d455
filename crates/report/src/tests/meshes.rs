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
    let mut sphere = mesh::shapes::cylinder(2 * n, n + 1, 1.0, std::f64::consts::PI);
    for p in &mut sphere.positions {
        let (sine, cosine) = p.z.sin_cos();
        *p = Point3::new(sine * p.x, sine * p.y, -cosine);
    }
    sphere
}
