//! A surface, prepared to be mapped to others.

use std::sync::OnceLock;

use linalg::{LandmarkDistances, Matrix};
use mesh::{TriMesh, outward};
use nalgebra::{DVector, Point3};
use rigid::PointSet;

use crate::curvature::{TIMES, bends, fine_curvature, smoothed};
use crate::functional::FunctionalMaps;
use crate::nearest_rows::nearest_in_cells;
use crate::operators::{FITTED, Operators};
use crate::orientation::{FUNCTIONS, Oriented, pairs};
use descriptors::{CanonicalForm, DescriptorError, LaplaceSpectrum, Normalization, wave_kernels};

/// One in so many wave kernels takes part in fitted maps: neighbors are nearly the same. As `ren2018` in `REFERENCES.bib`.
const KERNELS: usize = 5;

/// Less than the length of limbs, more than their width: the end of a limb is farther from the rest than all landmarks within this
/// distance, and a landmark that a map misses by more does not fit it. A safety limit: of the landmarks that fit the mirrored map as
/// well, right maps of built-in men, cats and centaurs miss none by more than .08.
pub(crate) const LIMB: f64 = 0.3;

/// So many ends tell how limbs are exchanged. A limit of effort.
const ENDS: usize = 8;

/// A surface with everything that maps to other surfaces are found by. Lengths are those of the surface at unit area.
#[derive(Debug)]
pub struct MapShape {
    pub(crate) form: PointSet,
    pub(crate) spectrum: LaplaceSpectrum,
    /// Vertices spread evenly over the surface; the landmarks first.
    pub(crate) samples: Vec<usize>,
    /// For every vertex, the position in the list of samples of the nearest one.
    pub(crate) nearest: Vec<usize>,
    /// The vertices nearest to each sample.
    pub(crate) cells: Vec<Vec<usize>>,
    /// What maps of functions are fitted to: with the curvature, which knows inside from outside, if the surface has an
    /// inside; and with the wave kernels, too.
    pub(crate) operators: Vec<Operators>,
    /// The curvature at the samples, smoothed least, if the surface has an inside.
    pub(crate) curvature: Option<Vec<f64>>,
    distances: LandmarkDistances,
    /// The square root of the area, in mesh units.
    pub(crate) size: f64,
    /// `None` if the surface cannot be oriented.
    pub(crate) oriented: Option<Oriented>,
    /// Coefficients of the mean curvature, positive where the surface bulges outwards, in the eigenfunctions; `None` if it has no
    /// outside.
    pub(crate) mean_curvature: Option<DVector<f64>>,
    /// The mean curvature at all vertices, smoothed as little as its noise allows.
    pub(crate) fine_curvature: Option<Vec<f64>>,
    /// The distance of each vertex from the boundary, at unit area; `None` if there is no boundary.
    pub(crate) from_cut: Option<Vec<f64>>,
    /// The area forms of the first eigenfunctions at the samples, if it can.
    pub(crate) area_forms: Option<Matrix>,
    /// Its mirrors, once they were sought.
    pub(crate) found_mirrors: OnceLock<Mirrors>,
}

/// Maps of a surface to itself that reverse its orientation and change distances little: people are nearly alike from left to
/// right, and from back to front.
#[derive(Debug)]
pub(crate) struct Mirrors {
    /// The one that exchanges left and right.
    pub(crate) sides: Option<FunctionalMaps>,
    /// Another one, which may exchange front and back.
    pub(crate) others: Vec<FunctionalMaps>,
}

impl MapShape {
    /// Prepares a surface.
    ///
    /// * `form` is the canonical form of its vertices; if it has a unit of length, it is scaled to unit area.
    /// * `distances` are those from landmarks to all vertices. The landmarks are the first of `samples`, vertices spread
    ///   evenly over the surface; `nearest` is the position in `samples` of the one nearest to each vertex.
    /// * `mesh` gives the orientation: outwards if it encloses a volume, else as most faces turn.
    /// * `from_cut` is the distance of each vertex from the boundary, in mesh units, where a cut may have left the surface of
    ///   another one; `None` without a boundary.
    ///
    /// # Errors
    /// [`DescriptorError::SizeMismatch`] if the parts differ in their numbers of vertices; [`DescriptorError::NoExtent`];
    /// [`DescriptorError::Linalg`].
    ///
    /// # Panics
    /// If `samples` do not begin with the landmarks, or `nearest` names a sample that does not exist.
    pub fn new(
        form: &CanonicalForm,
        mesh: &TriMesh,
        spectrum: LaplaceSpectrum,
        distances: LandmarkDistances,
        samples: Vec<usize>,
        nearest: Vec<usize>,
        from_cut: Option<Vec<f64>>,
    ) -> Result<Self, DescriptorError> {
        let (n_vertices, size) = (mesh.n_vertices(), spectrum.area.sqrt());
        let counts = [form.points().len(), spectrum.masses.len(), distances.n_points(), nearest.len()];
        for n_points in counts.into_iter().chain(from_cut.as_ref().map(Vec::len)) {
            if n_points != n_vertices {
                return Err(DescriptorError::SizeMismatch { n_points, n_vertices });
            }
        }
        assert!(samples.starts_with(distances.landmarks()), "samples begin with the landmarks");
        let form = form.normalized(Normalization::UnitArea).prepared()?;
        let mut cells = vec![Vec::new(); samples.len()];
        for (vertex, &sample) in nearest.iter().enumerate() {
            cells[sample].push(vertex);
        }
        let oriented = Oriented::new(mesh, &spectrum.masses);
        let outward = outward(mesh);
        let bends = outward.as_ref().map(bends);
        let both = outward.as_ref().zip(bends.as_ref());
        let fine_curvature = both.map(|(outward, bends)| fine_curvature(outward, bends)).transpose()?;
        let mean_curvature = bends.map(|bends| spectrum.vectors.transpose() * bends);
        let smooth = |curvature| smoothed(curvature, &spectrum.values, &spectrum.vectors, 1.0);
        let curvatures = mean_curvature.as_ref().map(smooth);
        let curvature = curvatures.as_ref().map(|columns| samples.iter().map(|&v| columns[(v, 0)]).collect());
        let operators = operators(curvatures, &spectrum, oriented.as_ref());
        Ok(Self {
            fine_curvature,
            mean_curvature,
            from_cut: from_cut.map(|from_cut| from_cut.iter().map(|d| d / size).collect()),
            area_forms: oriented
                .as_ref()
                .map(|oriented| oriented.area_forms(&spectrum.vectors, &pairs(&spectrum.vectors), &samples)),
            found_mirrors: OnceLock::new(),
            oriented,
            operators,
            curvature,
            size,
            spectrum,
            form,
            samples,
            nearest,
            cells,
            distances,
        })
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.nearest.len()
    }

    /// The eigenvalues and eigenfunctions in which maps of functions are written.
    pub fn spectrum(&self) -> &LaplaceSpectrum {
        &self.spectrum
    }

    /// The form of all vertices in its principal axes, at unit area.
    pub fn form_points(&self) -> &[Point3<f64>] {
        self.form.points()
    }

    /// The vertices from which distances are known.
    pub(crate) fn landmarks(&self) -> &[usize] {
        self.distances.landmarks()
    }

    /// Distances from all landmarks to some vertices, one row for each landmark, at unit area.
    pub(crate) fn distances_to(&self, vertices: &[usize]) -> Result<Matrix, DescriptorError> {
        let mut found = Matrix::zeros(self.distances.n_landmarks(), vertices.len());
        for i in 0..found.nrows() {
            let column = self.distances.column(i)?;
            vertices.iter().enumerate().for_each(|(j, &v)| found[(i, j)] = column[v] / self.size);
        }
        Ok(found)
    }

    /// The same to all vertices.
    pub(crate) fn all_distances(&self) -> Result<Matrix, DescriptorError> {
        self.distances_to(&(0..self.n_vertices()).collect::<Vec<_>>())
    }

    /// Landmarks at the ends of limbs: farther from all others, on average, than those around them.
    pub(crate) fn ends_of_limbs(&self) -> Result<Vec<usize>, DescriptorError> {
        let landmarks = self.landmarks();
        let between = self.distances_to(landmarks)?;
        let mean: Vec<f64> = between.column_iter().map(|column| column.mean()).collect();
        let all = || 0..landmarks.len();
        let mut ends: Vec<usize> =
            all().filter(|&i| all().all(|j| between[(i, j)] > LIMB || mean[j] <= mean[i])).collect();
        ends.sort_by(|i, j| mean[*j].total_cmp(&mean[*i]));
        ends.truncate(ENDS);
        Ok(ends.into_iter().map(|i| landmarks[i]).collect())
    }

    /// Heat that was placed at a vertex, a column for each of the [times](TIMES).
    pub(crate) fn heat(&self, vertex: usize) -> Matrix {
        let at = self.spectrum.vectors.row(vertex).transpose();
        smoothed(&at, &self.spectrum.values, &self.spectrum.vectors, 1.0)
    }

    /// Heat that was placed at some vertices, as functions to fit maps to: the last of the times.
    pub(crate) fn heat_operators(&self, vertices: &[usize]) -> Operators {
        let spectrum = &self.spectrum;
        let columns: Vec<_> =
            vertices.iter().map(|v| self.heat(*v).column(TIMES.len() - 1).into_owned()).collect();
        Operators::new(spectrum, Matrix::from_columns(&columns), self.oriented.as_ref())
    }

    /// The nearest vertex to each of some places; `rows` are the places of all vertices by maps of functions. The nearest samples are
    /// found by twice as many eigenfunctions as fitted maps have.
    pub(crate) fn nearest_vertices(&self, rows: &Matrix, places: &Matrix) -> Vec<usize> {
        let k = rows.ncols() / 2;
        let coarse: Vec<usize> = (0..k.min(2 * FITTED)).flat_map(|j| [j, k + j]).collect();
        nearest_in_cells(places, rows, (&self.samples, &self.cells), &coarse)
    }

    /// How far a map preserves orientation, from -1 for one that reverses it to 1; `None` if a surface cannot be oriented.
    ///
    /// The pull-back of the area form `df ∧ dg` of two functions is the area form of the functions pulled back, times the sign of
    /// the map. This is the correlation of both over pairs of corresponding samples: `map` takes eigenfunctions of the second surface to
    /// functions of the first, and `partners` names a sample of the second for each of the first ones.
    pub(crate) fn agreement(&self, other: &Self, map: &Matrix, partners: &[usize]) -> Option<f64> {
        let (oriented, forms) = (self.oriented.as_ref()?, other.area_forms.as_ref()?);
        let own = self.spectrum.vectors.columns(0, map.nrows());
        let pulled: Matrix = own * map.columns(0, map.ncols().min(FUNCTIONS + 1));
        let pulled = oriented.area_forms(&pulled, &pairs(&pulled), &self.samples[..partners.len()]);
        let (mut both, mut sq_a, mut sq_b) = (0.0, 0.0, 0.0);
        for (pulled, forms) in pulled.column_iter().zip(forms.column_iter()) {
            for (x, &row) in pulled.iter().zip(partners) {
                let y = forms[row];
                both += x * y;
                sq_a += x * x;
                sq_b += y * y;
            }
        }
        let scale = (sq_a * sq_b).sqrt();
        Some(if scale > 0.0 { both / scale } else { 0.0 })
    }
}

fn operators(
    curvatures: Option<Matrix>,
    spectrum: &LaplaceSpectrum,
    oriented: Option<&Oriented>,
) -> Vec<Operators> {
    let kernels = wave_kernels(spectrum);
    let some: Vec<usize> = (0..kernels.ncols()).step_by(KERNELS).collect();
    let kernels = kernels.select_columns(&some);
    let Some(curvatures) = curvatures else { return vec![Operators::new(spectrum, kernels, oriented)] };
    let columns: Vec<_> = kernels.column_iter().chain(curvatures.column_iter()).collect();
    let both = Matrix::from_columns(&columns);
    vec![Operators::new(spectrum, curvatures, oriented), Operators::new(spectrum, both, oriented)]
}
