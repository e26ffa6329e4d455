//! Canonical forms.

use mesh::TriMesh;
use nalgebra::{Point3, Vector3};
use nmds::Embedding;
use serde::{Deserialize, Serialize};
use surface::VertexId;

use crate::error::DescriptorError;
use rigid::{PointSet, farthest_points};

/// How forms of different size are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Normalization {
    /// Size counts: a small cat and a large cat differ.
    #[default]
    Raw,
    /// Size does not count: forms are scaled to unit area of the surface, which bending does not change. Forms
    /// without a unit of length are not scaled.
    UnitArea,
}

/// A surface embedded so that straight-line distances equal its surface distances: its shape regardless of pose.
///
/// It is centered at its area-weighted centroid. It is invariant to bending of the surface and, with
/// [`Normalization::UnitArea`], to scale. It is defined up to a rigid motion *and a reflection*: distances do not
/// distinguish a left hand from a right one.
#[derive(Debug, Clone, PartialEq)]
pub struct CanonicalForm {
    points: Vec<Point3<f64>>,
    weights: Vec<f64>,
    area: Option<f64>,
}

impl CanonicalForm {
    /// The form of `mesh` from an embedding of its vertices, weighted by the areas around the vertices.
    ///
    /// # Errors
    /// [`DescriptorError::NotThreeDimensional`], [`DescriptorError::SizeMismatch`], [`DescriptorError::NoExtent`].
    pub fn new(embedding: &Embedding, mesh: &TriMesh) -> Result<Self, DescriptorError> {
        if embedding.dim() != 3 {
            return Err(DescriptorError::NotThreeDimensional { dim: embedding.dim() });
        }
        if embedding.n_points() != mesh.n_vertices() {
            return Err(DescriptorError::SizeMismatch {
                n_points: embedding.n_points(),
                n_vertices: mesh.n_vertices(),
            });
        }
        let points = embedding.coords.row_iter().map(|row| Point3::new(row[0], row[1], row[2])).collect();
        let form = Self::from_points(points, mesh.vertex_areas())?;
        Ok(Self { area: Some(mesh.area()).filter(|area| *area > 0.0), ..form })
    }

    /// The form without a unit of length, for coordinates such as those of a kernel: its size is then not that of the
    /// surface.
    #[must_use]
    pub fn without_unit(self) -> Self {
        Self { area: None, ..self }
    }

    /// A form of bare points without a unit of length. Weights are nonnegative; if they sum to zero, all points have the
    /// same weight.
    ///
    /// # Errors
    /// [`DescriptorError::NoExtent`], [`DescriptorError::SizeMismatch`].
    pub fn from_points(mut points: Vec<Point3<f64>>, weights: Vec<f64>) -> Result<Self, DescriptorError> {
        let weights = shares(weights);
        let centroid = points.iter().zip(&weights).fold(Vector3::zeros(), |sum, (p, w)| sum + p.coords * *w);
        points.iter_mut().for_each(|p| *p -= centroid);
        Self::from_parts(points, weights, None)
    }

    /// A form from exactly these points, weights and area: nothing is centered or normalized.
    ///
    /// # Errors
    /// [`DescriptorError::SizeMismatch`] unless there is one weight per point; [`DescriptorError::NoExtent`] if a
    /// number is not finite, a weight is negative, the area is not positive, or all points coincide.
    pub fn from_parts(
        points: Vec<Point3<f64>>,
        weights: Vec<f64>,
        area: Option<f64>,
    ) -> Result<Self, DescriptorError> {
        let n_points = points.len();
        if weights.len() != n_points {
            return Err(DescriptorError::SizeMismatch { n_points, n_vertices: weights.len() });
        }
        let sound = weights.iter().all(|w| w.is_finite() && *w >= 0.0)
            && area.is_none_or(|area| area.is_finite() && area > 0.0);
        let spread = spread(&points, &weights);
        match sound && spread.is_finite() && spread > 0.0 {
            true => Ok(Self { points, weights, area }),
            false => Err(DescriptorError::NoExtent { n_points }),
        }
    }

    /// The form at up to `n` evenly spread points, each with the weight of all points nearest to it. It keeps its
    /// coordinates; any leading part of the points is evenly spread too. Cost `O(p n)`.
    pub fn reduced(&self, n: usize) -> Self {
        let spread = farthest_points(&self.points, n);
        let mut weights = vec![0.0; spread.samples.len()];
        spread.nearest.iter().zip(&self.weights).for_each(|(&owner, w)| weights[owner] += w);
        let points = spread.samples.iter().map(|&i| self.points[i]).collect();
        Self { points, weights, area: self.area }
    }

    /// The form at some of its points, with a new weight for each; coordinates and area stay.
    ///
    /// # Errors
    /// [`DescriptorError::SizeMismatch`] unless there are as many weights as vertices, of points that exist;
    /// [`DescriptorError::NoExtent`] if a weight is negative or the points coincide.
    pub fn at(&self, vertices: &[VertexId], weights: Vec<f64>) -> Result<Self, DescriptorError> {
        let fault = DescriptorError::SizeMismatch { n_points: self.points.len(), n_vertices: weights.len() };
        if vertices.len() != weights.len() {
            return Err(fault);
        }
        let points = vertices.iter().map(|v| self.points.get(v.index()).copied());
        let points = points.collect::<Option<Vec<_>>>().ok_or(fault)?;
        Self::from_parts(points, shares(weights), self.area)
    }

    /// The centered points, one per vertex, in the unit of the distances.
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// The share of the surface around each point; the shares sum to one.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The area of the surface in squared units of the form; `None` if coordinates are not lengths.
    pub fn area(&self) -> Option<f64> {
        self.area
    }

    /// Root mean square distance from the centroid.
    pub fn spread(&self) -> f64 {
        spread(&self.points, &self.weights)
    }

    /// Its points, ready to be aligned. Area-weighted principal axes do not depend on the triangulation.
    ///
    /// # Errors
    /// [`DescriptorError::NoExtent`].
    pub fn prepared(&self) -> Result<PointSet, DescriptorError> {
        Ok(PointSet::new(&self.points, &self.weights)?)
    }

    /// The form, scaled as `normalization` says.
    pub fn normalized(&self, normalization: Normalization) -> Self {
        match (normalization, self.area) {
            (Normalization::UnitArea, Some(area)) => Self {
                points: self.points.iter().map(|p| p / area.sqrt()).collect(),
                weights: self.weights.clone(),
                area: Some(1.0),
            },
            _ => self.clone(),
        }
    }

    /// The form as a mesh: its points with the faces of the mesh it was made from.
    pub fn to_mesh(&self, mesh: &TriMesh) -> TriMesh {
        TriMesh { positions: self.points.clone(), faces: mesh.faces.clone() }
    }
}

/// Weights as shares of their sum; equal ones if there is none.
fn shares(mut weights: Vec<f64>) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    let even = 1.0 / weights.len().max(1) as f64;
    weights.iter_mut().for_each(|w| *w = if total > 0.0 { *w / total } else { even });
    weights
}

/// Root of the weighted mean squared distance from the origin.
fn spread(points: &[Point3<f64>], weights: &[f64]) -> f64 {
    points.iter().zip(weights).map(|(p, w)| w * p.coords.norm_squared()).sum::<f64>().sqrt()
}
