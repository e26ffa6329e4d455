//! Whether a surface is the mirror image of another.

use descriptors::{Alignment, CanonicalForm, DescriptorError, NearestPoints, Reflections, ShapePair};
use mesh::{TriMesh, outward};
use nalgebra::Vector3;
use serde::Serialize;

/// Whether the second surface is the mirror image of the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Handedness {
    /// It is not.
    Same,
    /// It is.
    Mirrored,
    /// Both fit, as for a body whose left and right are alike.
    Either,
    /// Unknown: a surface does not enclose a volume, or the forms do not fit well enough to compare normals.
    #[default]
    Unknown,
}

/// Forms of unit area with a smaller root mean square distance fit so well that the normals of their surfaces can be
/// compared. Between poses of TOSCA's cats, centaurs and davids the distance is mostly below 0.07, between two of
/// these animals mostly above 0.1; but a cat and a dog may be 0.06 apart, so a fit alone does not make one shape.
const FITTING: f64 = 0.08;

/// Normals agree, or disagree, if their mean agreement is beyond this. A safety limit: it is 1 for a perfect map, -1 for the
/// mirrored one, and about 0 if nothing corresponds.
const AGREEMENT: f64 = 0.2;

/// One of two maps fits and the other does not if its distance is larger by this factor, and by [`EXCESS`]. A safety limit.
const DECISIVE: f64 = 1.25;

/// Least difference of two maps in the mean square at unit area, beyond the distance between samples of one surface. Two poses
/// of one body are about 0.03 apart (`cargo run --release -p experiments -- units`), so that smaller differences say nothing.
const EXCESS: f64 = 0.02;

/// A form at unit area, with the faces of the surface turned so that normals point outwards.
struct OutwardForm<'a> {
    mesh: TriMesh,
    weights: &'a [f64],
}

/// Normals at the vertices, not normalised.
fn normals(mesh: &TriMesh) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); mesh.n_vertices()];
    for (f, face) in mesh.faces.iter().enumerate() {
        let normal = mesh.area_vector(f);
        face.iter().for_each(|v| normals[v.index()] += normal);
    }
    normals
}

/// How far the outsides of two forms agree under a motion of the first onto the second: the mean cosine between
/// normals at nearest points, weighted by area, from -1 to 1. `others` are the normals of the second.
///
/// Faces move with their points, so a motion with a reflection reverses normals: this tests whether the map from
/// surface to surface preserves orientation, not whether the motion does.
fn agreement(
    a: &OutwardForm<'_>,
    nearest: &NearestPoints,
    others: &[Vector3<f64>],
    motion: &Alignment,
) -> f64 {
    let positions = a.mesh.positions.iter().map(|p| motion.apply(p)).collect();
    let moved = TriMesh { positions, faces: a.mesh.faces.clone() };
    let (mut sum, mut total) = (0.0, 0.0);
    for ((point, weight), normal) in moved.positions.iter().zip(a.weights).zip(normals(&moved)) {
        let other = others[nearest.nearest(point).0];
        let lengths = normal.norm() * other.norm();
        if lengths > 0.0 {
            sum += weight * normal.dot(&other) / lengths;
            total += weight;
        }
    }
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
    if pair.best().rms >= FITTING {
        return Ok(Handedness::Unknown);
    }
    let [a, b] = [0, 1].map(|i| {
        let (form, mesh) = surfaces[i];
        let mesh = TriMesh { positions: pair.shapes[i].at_unit_area(form), ..outward(mesh)? };
        Some(OutwardForm { mesh, weights: form.weights() })
    });
    let (Some(a), Some(b)) = (a, b) else { return Ok(Handedness::Unknown) };
    let (nearest, others) = (NearestPoints::new(b.mesh.positions.clone())?, normals(&b.mesh));
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
    Ok(Handedness::of_maps([preserving, reversing], pair.shapes[1].form().points().len()))
}

impl Handedness {
    /// From the root mean square distances of the best maps that preserve and that reverse orientation, infinite if there is
    /// none. The second surface has unit area and `n_points` points.
    fn of_maps([preserving, reversing]: [f64; 2], n_points: usize) -> Self {
        // A point is about half of √(1 / n) from the nearest of n others.
        let least = EXCESS.powi(2) + 0.25 / n_points as f64;
        let decided =
            |better: f64, worse: f64| worse > DECISIVE * better && worse.powi(2) - better.powi(2) > least;
        match preserving.is_finite() || reversing.is_finite() {
            false => Self::Unknown,
            _ if decided(preserving, reversing) => Self::Same,
            _ if decided(reversing, preserving) => Self::Mirrored,
            _ => Self::Either,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_handedness_follows_the_decisively_better_map() {
        let of = |distances| Handedness::of_maps(distances, 1000);
        let none = f64::INFINITY;
        for worse in [0.06, none] {
            assert_eq!(of([0.02, worse]), Handedness::Same);
            assert_eq!(of([worse, 0.02]), Handedness::Mirrored);
        }
        assert_eq!(of([0.021, 0.02]), Handedness::Either);
        assert_eq!(of([none, none]), Handedness::Unknown);
    }
}
