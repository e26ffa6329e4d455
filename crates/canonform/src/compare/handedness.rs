//! Whether a surface is the mirror image of another.

use descriptors::{Alignment, CanonicalForm, PreparedForm};
use mesh::{TriMesh, orient_consistently};
use nalgebra::{Point3, Vector3};
use serde::Serialize;

/// One kind of map fits and the other does not when that is so many times worse, ...
const DECISIVE: f64 = 1.25;

/// ... and worse by so much at unit area, in the mean square, beyond what the distances of vertices make of it. Two
/// poses of one body are about 0.03 apart.
const EXCESS: f64 = 0.02;

/// Normals agree, or disagree, when their mean agreement is beyond this.
const AGREEMENT: f64 = 0.2;

/// A surface has an inside when it holds at least this share of what a ball of its area holds.
const LEAST_VOLUME: f64 = 0.02;

/// Whether the second surface is the mirror image of the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Handedness {
    /// It is not: outside lies on outside.
    Same,
    /// It is: outside lies on outside only when one of them is reflected.
    Mirrored,
    /// Both fit, as where left and right of a body are alike.
    Either,
    /// Nothing is known: a surface has no inside, or the forms do not match well enough to compare normals.
    #[default]
    Unknown,
}

/// A surface with its form: the normals of the form on the outside of the surface.
pub(crate) struct OutwardForm<'a> {
    form: &'a CanonicalForm,
    mesh: TriMesh,
}

impl<'a> OutwardForm<'a> {
    /// `None` when the surface has no inside.
    pub(crate) fn new(form: &'a CanonicalForm, mesh: &TriMesh) -> Option<Self> {
        let mut mesh = mesh.clone();
        orient_consistently(&mut mesh);
        let centre = mesh.positions.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords)
            / mesh.n_vertices().max(1) as f64;
        let volume: f64 = (0..mesh.n_faces())
            .map(|f| {
                let [a, b, c] = mesh.triangle(f).map(|p| p.coords - centre);
                a.dot(&b.cross(&c)) / 6.0
            })
            .sum();
        let ball = mesh.area().powf(1.5) / (6.0 * std::f64::consts::PI.sqrt());
        if volume.abs() < LEAST_VOLUME * ball {
            return None;
        }
        if volume < 0.0 {
            mesh.faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        Some(Self { form, mesh })
    }

    /// Normals at the vertices of the form once moved, not normalised.
    fn normals(&self, motion: impl Fn(&Point3<f64>) -> Point3<f64>) -> Vec<Vector3<f64>> {
        let moved = TriMesh {
            positions: self.form.points().iter().map(motion).collect(),
            faces: self.mesh.faces.clone(),
        };
        let mut normals = vec![Vector3::zeros(); moved.n_vertices()];
        for (f, face) in moved.faces.iter().enumerate() {
            let normal = moved.area_vector(f);
            face.iter().for_each(|v| normals[v.index()] += normal);
        }
        normals
    }
}

/// How far the outsides of two forms agree under a motion of the first onto the second: the mean cosine between
/// normals at nearest points, by area, -1 to 1.
///
/// Faces move with their points, so a motion that reflects turns normals over: what is compared is whether the
/// map from surface to surface keeps orientation, whatever the motion does to space.
fn agreement(a: &OutwardForm<'_>, b: &OutwardForm<'_>, onto: &PreparedForm, motion: &Alignment) -> f64 {
    let normals = a.normals(|p| motion.apply(p));
    let others = b.normals(|p| *p);
    let points = a.form.points().iter().zip(a.form.weights()).zip(&normals);
    let (sum, total) = points.fold((0.0, 0.0), |(sum, total), ((p, weight), normal)| {
        let other = others[onto.nearest_to(&motion.apply(p)).0];
        let lengths = normal.norm() * other.norm();
        if lengths > 0.0 {
            (sum + weight * normal.dot(&other) / lengths, total + weight)
        } else {
            (sum, total)
        }
    });
    if total > 0.0 { sum / total } else { 0.0 }
}

/// Distances and motions without and with a reflection, the second form as it was prepared, and the verdict.
pub(crate) fn handedness(
    a: &OutwardForm<'_>,
    b: &OutwardForm<'_>,
    onto: &PreparedForm,
    found: [(f64, Alignment); 2],
) -> Handedness {
    // Nearest distance of a map that keeps, and of one that reverses orientation.
    let (mut keeps, mut reverses) = (f64::INFINITY, f64::INFINITY);
    for (distance, motion) in found {
        let agreement = agreement(a, b, onto, &motion);
        if agreement > AGREEMENT {
            keeps = keeps.min(distance);
        } else if agreement < -AGREEMENT {
            reverses = reverses.min(distance);
        }
    }
    // A point of a surface of unit area is about half the root of 1 / n from the nearest of n vertices.
    let least = EXCESS.powi(2) + 0.25 / b.form.points().len() as f64;
    let decided =
        |better: f64, worse: f64| worse > DECISIVE * better && worse.powi(2) - better.powi(2) > least;
    match (keeps.is_finite(), reverses.is_finite()) {
        (false, false) => Handedness::Unknown,
        _ if decided(keeps, reverses) => Handedness::Same,
        _ if decided(reverses, keeps) => Handedness::Mirrored,
        _ => Handedness::Either,
    }
}
