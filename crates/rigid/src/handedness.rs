//! Whether a body is the mirror image of another.

use mesh::{TriMesh, outward};
use nalgebra::{Point3, Vector3};
use serde::Serialize;

use crate::icp::Alignment;
use crate::nearest::{NearestPoints, NoExtent};
use crate::similarity::Similarity;

/// Whether the second body is the mirror image of the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Handedness {
    /// It is not.
    Same,
    /// It is.
    Mirrored,
    /// Both fit, as for a body whose left and right are alike.
    Either,
    /// Unknown: a surface does not enclose a volume, or the bodies do not fit well enough to compare normals.
    #[default]
    Unknown,
}

/// One of two maps fits and the other does not if its distance is larger by this factor. A safety limit.
const DECISIVE: f64 = 1.25;

/// Normals agree, or disagree, if their mean agreement is beyond this. A safety limit: it is 1 for a perfect map, -1 for the
/// mirrored one, and about 0 if nothing corresponds.
const AGREEMENT: f64 = 0.2;

/// Whether a map with this root mean square distance fits and another does not: whether its distance is larger by more than
/// [`DECISIVE`] and by more than what distances are uncertain by. The only place where a reflection is decided.
pub(crate) fn is_decisive(better: f64, worse: f64, uncertainty: f64) -> bool {
    worse > (DECISIVE * better).hypot(uncertainty)
}

/// Points of a surface that encloses a volume, with the normals there, not normalized, and the share of the surface around each.
#[derive(Debug)]
pub struct OrientedPoints<'a> {
    points: Vec<Point3<f64>>,
    normals: Vec<Vector3<f64>>,
    weights: &'a [f64],
}

impl<'a> OrientedPoints<'a> {
    /// The vertices of `mesh` at other `points`, with its faces turned so that normals point outwards. `None` of a surface that
    /// encloses no volume.
    pub fn new(mesh: &TriMesh, points: Vec<Point3<f64>>, weights: &'a [f64]) -> Option<Self> {
        let mesh = TriMesh { positions: points, ..outward(mesh)? };
        let mut normals = vec![Vector3::zeros(); mesh.n_vertices()];
        for (f, face) in mesh.faces.iter().enumerate() {
            let normal = mesh.area_vector(f);
            face.iter().for_each(|v| normals[v.index()] += normal);
        }
        Some(Self { points: mesh.positions, normals, weights })
    }

    /// How far the outsides of two bodies agree under a motion of this one onto the other: the mean cosine between
    /// normals at nearest points, weighted by area, from -1 to 1.
    ///
    /// Faces move with their points, so a motion with a reflection reverses normals: this tests whether the map from
    /// surface to surface preserves orientation, not whether the motion does.
    fn agreement(&self, other: &Self, nearest: &NearestPoints, motion: &Similarity) -> f64 {
        let turn = if motion.reflected { -motion.rotation } else { motion.rotation };
        let (mut sum, mut total) = (0.0, 0.0);
        for ((point, normal), weight) in self.points.iter().zip(&self.normals).zip(self.weights) {
            let there = other.normals[nearest.nearest(&motion.apply(point)).0];
            let lengths = normal.norm() * there.norm();
            if lengths > 0.0 {
                sum += weight * (turn * normal).dot(&there) / lengths;
                total += weight;
            }
        }
        if total > 0.0 { sum / total } else { 0.0 }
    }
}

impl Handedness {
    /// Whether the second body is the mirror image of the first, from the best alignments without and with a reflection, whose
    /// distances are uncertain by `uncertainty`.
    ///
    /// Distances on a surface and on its mirror image are the same, and the signs of principal axes are arbitrary, so
    /// canonical forms do not tell. But an alignment maps one surface to the other, by nearest points, and the alignment that
    /// maps outside to outside fits a body, the other one its mirror image. This takes surfaces that enclose a volume, and
    /// bodies whose left differs from their right.
    ///
    /// # Errors
    /// [`NoExtent`].
    pub fn from_alignments(
        alignments: [Alignment; 2],
        [a, b]: [&OrientedPoints<'_>; 2],
        uncertainty: f64,
    ) -> Result<Self, NoExtent> {
        let nearest = NearestPoints::new(b.points.clone())?;
        // The least distance of a map that preserves, and of one that reverses orientation.
        let (mut preserving, mut reversing) = (f64::INFINITY, f64::INFINITY);
        for Alignment { map, gap } in alignments {
            let agreement = a.agreement(b, &nearest, &map);
            if agreement > AGREEMENT {
                preserving = preserving.min(gap.rms);
            } else if agreement < -AGREEMENT {
                reversing = reversing.min(gap.rms);
            }
        }
        Ok(match preserving.is_finite() || reversing.is_finite() {
            false => Self::Unknown,
            _ if is_decisive(preserving, reversing, uncertainty) => Self::Same,
            _ if is_decisive(reversing, preserving, uncertainty) => Self::Mirrored,
            _ => Self::Either,
        })
    }
}
