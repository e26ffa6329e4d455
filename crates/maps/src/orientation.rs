//! Whether a map of surfaces preserves their orientation.

use linalg::Matrix;
use mesh::{TriMesh, oriented_faces};

/// Eigenfunctions whose area forms are compared: 66 pairs of them, all among the [`FITTED`](crate::operators::FITTED) ones. A
/// convention.
pub(crate) const FUNCTIONS: usize = 12;

/// An oriented surface: faces that all turn the same way.
#[derive(Debug)]
pub(crate) struct Oriented {
    faces: Vec<[usize; 3]>,
    /// One over the share of the area around each vertex.
    densities: Vec<f64>,
}

impl Oriented {
    /// `None` if the faces cannot be oriented alike.
    pub(crate) fn new(mesh: &TriMesh, masses: &[f64]) -> Option<Self> {
        let faces = oriented_faces(mesh)?.into_iter().map(|face| face.map(|v| v.index())).collect();
        let densities = masses.iter().map(|mass| if *mass > 0.0 { 1.0 / mass } else { 0.0 }).collect();
        Some(Self { faces, densities })
    }

    /// The area forms `df ∧ dg` of some pairs of functions, as multiples of the oriented area: a row for each of some vertices,
    /// which differ, and a column for each pair.
    pub(crate) fn area_forms(&self, functions: &Matrix, pairs: &[[usize; 2]], vertices: &[usize]) -> Matrix {
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
                // Twice its integral over the face; a third goes to each corner.
                let form = (p[i] * q[j] - q[i] * p[j]) / 6.0;
                at.iter().flatten().for_each(|&row| sums[(k, row)] += form);
            }
        }
        sums.column_iter_mut().zip(vertices).for_each(|(mut column, &v)| column *= self.densities[v]);
        sums.transpose()
    }
}

/// All pairs of the first functions but the constant one, which is the first.
pub(crate) fn pairs(functions: &Matrix) -> Vec<[usize; 2]> {
    (2..functions.ncols().min(FUNCTIONS + 1)).flat_map(|j| (1..j).map(move |i| [i, j])).collect()
}
