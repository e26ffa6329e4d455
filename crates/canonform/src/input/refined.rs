//! The mesh on which a surface is measured for its description.

use mesh::{Refined, refine};

use super::repaired::Surface;

/// Longest edge, relative to the square root of the area. Equilateral triangles of this size have about 1,300 vertices.
///
/// Errors of the spectrum and of distances fall with the square of the edge length. With shorter edges, the usual 3,400
/// vertices would be refined too, and cost more.
const LONGEST: f64 = 0.03;

/// Most vertices that are added. Needles could need any number.
const MOST: usize = 10_000;

impl Surface {
    /// The same surface with its long edges split, on which it is described: coarse meshes are then measured as accurately
    /// as fine ones, and subdivision changes little. The first vertices are those of the repaired mesh, and so are the
    /// links.
    ///
    /// ```
    /// use canonform::{Surface, mesh::shapes};
    ///
    /// let coarse = Surface::new(&shapes::icosphere(2), &Default::default())?;
    /// let fine = coarse.refined();
    /// assert!(fine.mesh().n_vertices() > 1000);
    /// assert!((fine.mesh().area() / coarse.mesh().area() - 1.0).abs() < 1e-12);
    /// # Ok::<(), canonform::Error>(())
    /// ```
    #[must_use]
    pub fn refined(&self) -> Self {
        let mesh = self.mesh();
        // In units, since the area of a surface may be too small for a number although its lengths are not.
        let unit = mesh.unit();
        let area = |face: usize| {
            let [a, b, c] = mesh.triangle(face);
            0.5 * ((b - a) / unit).cross(&((c - a) / unit)).norm()
        };
        let longest = LONGEST * (0..mesh.n_faces()).map(area).sum::<f64>().sqrt() * unit;
        if longest.is_nan() || longest <= 0.0 {
            return self.clone();
        }
        let Refined { mesh: fine, origins } = refine(mesh, longest, mesh.n_vertices() + MOST);
        match origins.is_empty() {
            true => self.clone(),
            false => self.with_mesh(fine, &origins),
        }
    }
}
