//! Whether a surface is the mirror image of another.

use mesh::TriMesh;
use nalgebra::{Point3, Vector3};

use crate::alignment::Alignment;
use crate::canonical_form::CanonicalForm;
use crate::error::DescriptorError;
use crate::matching::Reflections;
use crate::metric::{Handedness, ShapeMetric};
use crate::nearest::NearestPoints;
use crate::outward::outward;
use crate::shape_pair::ShapePair;

/// Normals agree, or disagree, if their mean agreement is beyond this.
const AGREEMENT: f64 = 0.2;

/// The points of a form at unit area, with the faces of the surface turned so that normals point outwards.
struct OutwardForm {
    points: Vec<Point3<f64>>,
    weights: Vec<f64>,
    mesh: TriMesh,
}

impl OutwardForm {
    /// `None` if the surface does not enclose a volume.
    fn new(points: Vec<Point3<f64>>, weights: &[f64], mesh: &TriMesh) -> Option<Self> {
        Some(Self { points, weights: weights.to_vec(), mesh: outward(mesh)? })
    }

    /// Normals at moved points, not normalised.
    fn normals(&self, points: Vec<Point3<f64>>) -> Vec<Vector3<f64>> {
        let moved = TriMesh { positions: points, faces: self.mesh.faces.clone() };
        let mut normals = vec![Vector3::zeros(); moved.n_vertices()];
        for (f, face) in moved.faces.iter().enumerate() {
            let normal = moved.area_vector(f);
            face.iter().for_each(|v| normals[v.index()] += normal);
        }
        normals
    }
}

/// How far the outsides of two forms agree under a motion of the first onto the second: the mean cosine between
/// normals at nearest points, weighted by area, from -1 to 1. `others` are the normals of the second.
///
/// Faces move with their points, so a motion with a reflection reverses normals: this tests whether the map from
/// surface to surface preserves orientation, not whether the motion does.
fn agreement(a: &OutwardForm, nearest: &NearestPoints, others: &[Vector3<f64>], motion: &Alignment) -> f64 {
    let moved: Vec<_> = a.points.iter().map(|p| motion.apply(p)).collect();
    let normals = a.normals(moved.clone());
    let points = moved.iter().zip(&a.weights).zip(&normals);
    let (sum, total) = points.fold((0.0, 0.0), |(sum, total), ((point, weight), normal)| {
        let other = others[nearest.nearest(point).0];
        let lengths = normal.norm() * other.norm();
        if lengths > 0.0 {
            (sum + weight * normal.dot(&other) / lengths, total + weight)
        } else {
            (sum, total)
        }
    });
    if total > 0.0 { sum / total } else { 0.0 }
}

/// Whether the second surface of a pair is the mirror image of the first, from their meshes and the forms of all their
/// vertices.
///
/// Distances on a surface and on its mirror image are the same, and the signs of a form's axes are arbitrary, so
/// forms do not tell. But aligned forms map one surface to the other, by nearest points, and the alignment that maps
/// outside to outside fits a body, the other one its mirror image. This takes surfaces that enclose a volume, and
/// bodies whose left differs from their right.
///
/// # Errors
/// [`DescriptorError::NoExtent`].
pub fn handedness(
    pair: &ShapePair<'_>,
    surfaces: [(&CanonicalForm, &TriMesh); 2],
) -> Result<Handedness, DescriptorError> {
    if !ShapeMetric::fits(pair.best().rms) {
        return Ok(Handedness::Unknown);
    }
    let [a, b] = [0, 1].map(|i| {
        let (form, mesh) = surfaces[i];
        OutwardForm::new(pair.shapes[i].at_unit_area(form), form.weights(), mesh)
    });
    let (Some(a), Some(b)) = (a, b) else { return Ok(Handedness::Unknown) };
    let (nearest, others) = (NearestPoints::new(b.points.clone())?, b.normals(b.points.clone()));
    // The least distance of a map that preserves, and of one that reverses orientation.
    let (mut preserving, mut reversing) = (f64::INFINITY, f64::INFINITY);
    for reflections in [Reflections::Forbid, Reflections::Require] {
        let found = pair.best_with(reflections);
        let agreement = agreement(&a, &nearest, &others, &found.alignment);
        if agreement > AGREEMENT {
            preserving = preserving.min(found.rms);
        } else if agreement < -AGREEMENT {
            reversing = reversing.min(found.rms);
        }
    }
    Ok(ShapeMetric::handedness([preserving, reversing], pair.shapes[1].form().points().len()))
}
