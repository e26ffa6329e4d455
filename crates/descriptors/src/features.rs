//! Forms that keep the features of their surface.

use base::Observer;
use linalg::{EliminationOrder, LinalgError, SparseCholesky, SparseSymmetric};
use mesh::TriMesh;
use nalgebra::{Matrix3, Point3, Vector3};
use rayon::prelude::*;
use surface::Rows;
use surface::laplacian::Laplacian;

use crate::canonical_form::CanonicalForm;
use crate::error::DescriptorError;
use rigid::nearest_rotation;

/// Rounds of rotations and points. A limit of time.
const ROUNDS: usize = 8;

impl CanonicalForm {
    /// The surface itself, bent as rigidly as possible towards this form: a canonical form that keeps features.
    ///
    /// Scaling in three dimensions flattens what needs more of them: limbs become thin, ears vanish. Lian et al. 2013
    /// (`lian2013form` in `REFERENCES.bib`) move the rigid parts of a surface to where the form has them. Here every one-ring is
    /// such a part (Sorkine and Alexa 2007, `sorkine2007`): with `v` the vertices of the mesh, `z` those of the form, at unit
    /// area, and `a` the shares of the area, the points `x` and rotations `R` minimize
    ///
    /// `½ Σ_ij w_ij |x_i - x_j - R_i (v_i - v_j)|² + Σ_i a_i |x_i - z_i|²`,
    ///
    /// where `w` are the cotangent weights of the intrinsic Delaunay triangulation. Rotations and points are improved in
    /// turn, from `x = z`. Both sums weigh alike: on 120 built-in shapes of 24 bodies, with .1, .3, 1, 3, 10 and 30 times the second one
    /// the spectrum of the bent surface has an mAP of .797, .800, .799, .798, .765 and .693.
    ///
    /// * The form is as good as its mirror image, the result is not: of both, the one nearer to the surface is taken, so that
    ///   results need no reflection to be aligned. Mirror images have mirrored results.
    /// * A form without a unit of length is scaled first, until its energy `Σ_ij w_ij |z_i - z_j|²` is that of the surface.
    /// * Cost: one sparse factorization, and 16 solutions with three right-hand sides.
    ///
    /// # Errors
    /// [`DescriptorError::SizeMismatch`] unless the form has a point for every vertex; [`DescriptorError::NoExtent`];
    /// [`DescriptorError::Linalg`], also if the budget of the observer is exceeded.
    ///
    /// ```
    /// use canonform_descriptors::CanonicalForm;
    /// use mesh::shapes;
    ///
    /// // The form of a folded sheet is flat, and so is nearly the sheet bent towards it: its crease is a feature.
    /// let sheet = shapes::grid(21, 11, 0.1);
    /// let form = CanonicalForm::from_points(sheet.positions.clone(), sheet.vertex_areas())?;
    /// let bent = form.with_features(&shapes::fold(&sheet, 0.8, 1.2), &())?;
    /// let error = bent.points().iter().zip(form.points()).map(|(x, z)| (x - z).norm()).fold(0.0, f64::max);
    /// assert!(error < 0.2, "{error}");
    /// # Ok::<(), canonform_descriptors::DescriptorError>(())
    /// ```
    pub fn with_features(&self, mesh: &TriMesh, observer: &dyn Observer) -> Result<Self, DescriptorError> {
        let (n_points, n_vertices) = (self.points().len(), mesh.n_vertices());
        if n_points != n_vertices {
            return Err(DescriptorError::SizeMismatch { n_points, n_vertices });
        }
        let unit = mesh.root_of_area();
        if unit <= 0.0 || !unit.is_finite() {
            return Err(DescriptorError::NoExtent { n_points });
        }
        let bending = Bending::new(mesh, unit, observer)?;
        let scale = match self.area() {
            Some(_) => 1.0 / unit,
            None => (bending.energy(&bending.rest) / bending.energy(self.points())).sqrt(),
        };
        let mirrored = |sign: f64| move |p: &Point3<f64>| Point3::new(p.x, p.y, sign * p.z) * scale;
        let start = |sign: f64| {
            let target: Vec<Point3<f64>> = self.points().iter().map(mirrored(sign)).collect();
            Bent { points: target.clone(), target, misfit: f64::INFINITY }
        };
        let mut tried = [start(1.0), start(-1.0)];
        for _ in 0..ROUNDS {
            tried.iter_mut().for_each(|bent| bending.improve(bent));
            observer.budget().check().map_err(LinalgError::from)?;
        }
        let [own, mirror] = tried;
        let best = if own.misfit <= mirror.misfit { own } else { mirror };
        let points = best.points.iter().map(|p| p * unit).collect();
        let bent = Self::from_points(points, mesh.vertex_areas())?;
        Self::from_parts(bent.points().to_vec(), bent.weights().to_vec(), Some(unit * unit))
    }
}

/// A surface of unit area, and what it takes to bend it.
struct Bending {
    /// The vertices of the surface.
    rest: Vec<Point3<f64>>,
    /// For each vertex, its neighbors and their cotangent weights.
    neighbors: Rows<(u32, f64)>,
    /// Shares of the area.
    pull: Vec<f64>,
    /// The factor of the stiffness with the pull on its diagonal.
    factor: SparseCholesky,
}

/// A state of the iteration.
struct Bent {
    points: Vec<Point3<f64>>,
    target: Vec<Point3<f64>>,
    /// What was left of the energy before the last step.
    misfit: f64,
}

impl Bending {
    fn new(mesh: &TriMesh, unit: f64, observer: &dyn Observer) -> Result<Self, DescriptorError> {
        let n = mesh.n_vertices();
        let laplacian = Laplacian::new(&mesh.intrinsic());
        let masses = laplacian.masses();
        let total: f64 = masses.iter().sum();
        let mut stiffness = SparseSymmetric::from_entries(n, laplacian.stiffness_entries());
        let sides = stiffness.entries().filter(|(i, j, _)| i != j);
        let sides: Vec<(u32, u32, f64)> = sides.map(|(i, j, w)| (i as u32, j as u32, -w)).collect();
        let both = sides.iter().flat_map(|&(i, j, w)| [(i as usize, (j, w)), (j as usize, (i, w))]);
        let neighbors = Rows::collect(n, both);
        // A vertex without faces has neither weights nor area and stays in the form.
        let least = f64::EPSILON / n as f64;
        let pull: Vec<f64> = masses.iter().map(|mass| (mass / total).max(least)).collect();
        stiffness.add_to_diagonal(pull.iter().copied());
        let factor =
            SparseCholesky::new(&EliminationOrder::new(&stiffness, observer)?, &stiffness, observer)?;
        let rest = mesh.positions.iter().map(|p| p / unit).collect();
        Ok(Self { rest, neighbors, pull, factor })
    }

    /// `Σ_ij w_ij |p_i - p_j|²`
    fn energy(&self, points: &[Point3<f64>]) -> f64 {
        let of = |(i, p): (usize, &Point3<f64>)| {
            let sides =
                self.neighbors.row(i).iter().map(|&(j, w)| w * (p - points[j as usize]).norm_squared());
            sides.sum::<f64>()
        };
        points.iter().enumerate().map(of).sum()
    }

    /// The rotation of each one-ring, then the points for these rotations.
    fn improve(&self, bent: &mut Bent) {
        let points = &bent.points;
        let turned: Vec<(Matrix3<f64>, f64)> = (0..points.len())
            .into_par_iter()
            .map(|i| {
                let sides =
                    self.neighbors.row(i).iter().map(|&(j, w)| {
                        (w, self.rest[i] - self.rest[j as usize], points[i] - points[j as usize])
                    });
                let covariance: Matrix3<f64> = sides.clone().map(|(w, v, x)| v * x.transpose() * w).sum();
                let rotation = nearest_rotation(&covariance, false).unwrap_or_else(Matrix3::identity);
                let left = sides.map(|(w, v, x)| w * (x - rotation * v).norm_squared()).sum::<f64>();
                let pull = self.pull[i] * (points[i] - bent.target[i]).norm_squared();
                (rotation, 0.5 * left + pull)
            })
            .collect();
        bent.misfit = turned.iter().map(|(_, misfit)| misfit).sum();
        let wanted = |&i: &usize| {
            let sides = self.neighbors.row(i).iter().map(|&(j, w)| {
                let j = j as usize;
                (turned[i].0 + turned[j].0) * (self.rest[i] - self.rest[j]) * (0.5 * w)
            });
            let sum: Vector3<f64> = sides.sum::<Vector3<f64>>() + bent.target[i].coords * self.pull[i];
            [sum.x, sum.y, sum.z]
        };
        let rows = self.factor.order().rows();
        let mut ordered: Vec<[f64; 3]> = rows.par_iter().map(wanted).collect();
        self.factor.solve_ordered(&mut ordered);
        rows.iter().zip(ordered).for_each(|(&row, x)| bent.points[row] = Point3::from(x));
    }
}
