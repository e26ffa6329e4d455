//! Whether a map of surfaces preserves their orientation.

use linalg::Matrix;
use mesh::TriMesh;

use crate::outward::oriented_faces;

/// Eigenfunctions whose area forms are compared.
const FUNCTIONS: usize = 12;

/// An oriented surface: faces that all turn the same way.
#[derive(Debug)]
pub(super) struct Oriented {
    faces: Vec<[usize; 3]>,
    /// One over the share of the area around each vertex.
    densities: Vec<f64>,
}

impl Oriented {
    /// `None` if the faces cannot be oriented alike.
    pub(super) fn new(mesh: &TriMesh, masses: &[f64]) -> Option<Self> {
        let faces = oriented_faces(mesh)?.into_iter().map(|face| face.map(|v| v.index())).collect();
        let densities = masses.iter().map(|mass| if *mass > 0.0 { 1.0 / mass } else { 0.0 }).collect();
        Some(Self { faces, densities })
    }

    /// The area form `df ∧ dg` at all vertices, as a multiple of the oriented area.
    pub(super) fn area_form(&self, f: &[f64], g: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.densities.len()];
        for face in &self.faces {
            let [a, b, c] = *face;
            // Twice its integral over the face; a third goes to each corner.
            let form = (f[b] - f[a]) * (g[c] - g[a]) - (f[c] - f[a]) * (g[b] - g[a]);
            face.iter().for_each(|v| sums[*v] += form / 6.0);
        }
        sums.iter_mut().zip(&self.densities).for_each(|(sum, density)| *sum *= density);
        sums
    }
}

/// How far a map preserves orientation, from -1 for one that reverses it to 1.
///
/// The pull-back of the area form `df ∧ dg` of two functions is the area form of the functions pulled back, times the sign of
/// the map. This is the correlation of both over the first eigenfunctions `psi` of the second surface and over pairs of
/// corresponding vertices. `pulled` are these functions, pulled back to the first surface.
pub(super) fn agreement(
    [a, b]: [&Oriented; 2],
    pulled: &Matrix,
    psi: &Matrix,
    pairs: &[(usize, usize)],
) -> f64 {
    let last = pulled.ncols().min(psi.ncols()).min(FUNCTIONS + 1);
    let (mut both, mut sq_a, mut sq_b) = (0.0, 0.0, 0.0);
    // Column 0 is constant.
    for i in 1..last {
        for j in i + 1..last {
            let column = |x: &Matrix, j: usize| -> Vec<f64> { x.column(j).iter().copied().collect() };
            let on_a = a.area_form(&column(pulled, i), &column(pulled, j));
            let on_b = b.area_form(&column(psi, i), &column(psi, j));
            for &(x, y) in pairs {
                both += on_a[x] * on_b[y];
                sq_a += on_a[x] * on_a[x];
                sq_b += on_b[y] * on_b[y];
            }
        }
    }
    let scale = (sq_a * sq_b).sqrt();
    if scale > 0.0 { both / scale } else { 0.0 }
}
