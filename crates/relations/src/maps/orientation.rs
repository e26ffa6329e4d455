//! Whether a map of surfaces preserves their orientation.

use linalg::Matrix;
use mesh::TriMesh;

use crate::outward::oriented_faces;

/// Eigenfunctions whose area forms are compared.
pub(super) const FUNCTIONS: usize = 12;

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

    /// The area forms `df ∧ dg` of all pairs of the first functions, without the constant one in column 0: a row for each of
    /// some vertices, which differ, and a column for each pair.
    pub(super) fn area_forms(&self, functions: &Matrix, vertices: &[usize]) -> Matrix {
        let last = functions.ncols().min(FUNCTIONS + 1);
        let pairs: Vec<[usize; 2]> = (2..last).flat_map(|j| (1..j).map(move |i| [i, j])).collect();
        let mut rows = vec![None; self.densities.len()];
        vertices.iter().enumerate().for_each(|(row, &v)| rows[v] = Some(row));
        // A column for each vertex, so that what is summed is together in memory.
        let mut sums = Matrix::zeros(pairs.len(), vertices.len());
        for face in &self.faces {
            let at = face.map(|v| rows[v]);
            if at.iter().all(Option::is_none) {
                continue;
            }
            let [a, b, c] = face.map(|v| functions.row(v));
            let [p, q] = [b - a, c - a];
            for (k, &[i, j]) in pairs.iter().enumerate() {
                let form = (p[i] * q[j] - q[i] * p[j]) / 6.0;
                at.iter().flatten().for_each(|&row| sums[(k, row)] += form);
            }
        }
        sums.column_iter_mut().zip(vertices).for_each(|(mut column, &v)| column *= self.densities[v]);
        sums.transpose()
    }
}

/// How far a map preserves orientation, from -1 for one that reverses it to 1.
///
/// The pull-back of the area form `df ∧ dg` of two functions is the area form of the functions pulled back, times the sign of
/// the map. This is the correlation of both over pairs of corresponding vertices: `pulled` has the forms of functions of the
/// second surface, pulled back, at vertices of the first, and `forms` those of the functions themselves at vertices of the
/// second, of which `partners` names a row for each row of `pulled`.
pub(super) fn agreement(pulled: &Matrix, forms: &Matrix, partners: &[usize]) -> f64 {
    let (mut both, mut sq_a, mut sq_b) = (0.0, 0.0, 0.0);
    for j in 0..pulled.ncols().min(forms.ncols()) {
        for (x, &row) in pulled.column(j).iter().zip(partners) {
            let y = forms[(row, j)];
            both += x * y;
            sq_a += x * x;
            sq_b += y * y;
        }
    }
    let scale = (sq_a * sq_b).sqrt();
    if scale > 0.0 { both / scale } else { 0.0 }
}
