//! The evidence of what kind of match two meshes are.

use descriptors::{Handedness, Verdict};
use index::ContentHash;

use super::exact::{SameVertices, same_vertices};
use super::geometry::MeshGeometry;
use super::in_space::{Aligned, SurfaceGap, aligned};
use super::kinds::{Basis, Change, EvidenceKind};
use super::mesh_change::MeshChange;
use super::parts::{Occurrences, Parts, Side, occurrences};
use super::same_surface::same_surface;
use super::units::UnitChange;

/// Sizes of two meshes with the same vertices are equal up to this share.
const SAME_SIZE: f64 = 1e-4;

/// Sizes of two triangulations of one surface are equal up to this share.
const SAME_SIZE_OF_SURFACES: f64 = 0.01;

/// What kind of match two meshes are, how certain that is, and what it was told from. [`Display`](std::fmt::Display) words it.
///
/// The first of these that applies decides:
///
/// 1. The files have the same hash.
/// 2. The vertices are the same after a motion, a reflection and a change of size, up to the rounding of files.
/// 3. A mesh is among the components of the other, in this sense or the next.
/// 4. The surfaces coincide up to a small distance after the best motion, reflection and change of size in space.
/// 5. The [`Verdict`] on their shapes: one shape, which is then in another pose, one class, or different ones.
#[derive(Debug, Clone, PartialEq)]
pub struct MatchEvidence {
    /// The kind of match.
    pub kind: EvidenceKind,
    /// Probability of the kind, 0 to 1.
    pub confidence: f64,
    /// From the first mesh to the second, or to the copies that are part of one of them.
    pub changes: Vec<Change>,
    /// Size of the second over that of the first.
    pub scale: f64,
    /// The change of the unit of length that explains the scale.
    pub units: Option<UnitChange>,
    /// What the evidence is taken from.
    pub basis: Basis,
    /// Hashes of the files, where they are known.
    pub content: [Option<ContentHash>; 2],
    /// Numbers of vertices in different positions.
    pub vertices: Option<[usize; 2]>,
    /// Numbers of faces.
    pub faces: Option<[usize; 2]>,
    /// Numbers of connected components.
    pub components: Option<[usize; 2]>,
    /// The angle of the rotation of the second mesh relative to the first, in degrees, if they have the same vertices and are
    /// not mirror images.
    pub rotation: Option<f64>,
    /// The largest distance between corresponding vertices of one geometry, relative to the size, the square root of the
    /// area.
    pub vertex_gap: Option<f64>,
    /// How far the surfaces are apart in space.
    pub surface_gap: Option<SurfaceGap>,
    /// How often one mesh occurs among the components of the other.
    pub parts: Option<Parts>,
    /// The verdict on the shapes: of meshes with several components, of the largest.
    pub verdict: Verdict,
    /// What the two are called in words.
    pub names: [String; 2],
}

impl MatchEvidence {
    /// The evidence on two meshes with this verdict.
    ///
    /// ```
    /// use canonform::descriptors::{ShapeMetric, ShapePair};
    /// use canonform::{DescribeOptions, EvidenceKind, MatchEvidence, MeshGeometry, Surface, describe, mesh::shapes};
    ///
    /// let ring = shapes::torus(24, 12, 2.0, 0.7);
    /// let mut inches = ring.clone();
    /// inches.positions.iter_mut().for_each(|p| *p /= 25.4);
    /// let options = DescribeOptions::default();
    /// let [a, b] = [&inches, &ring].map(|mesh| {
    ///     let surface = Surface::new(mesh, &options.form.repair).unwrap();
    ///     describe(&surface, &options).unwrap().prepare().unwrap()
    /// });
    /// let verdict = ShapePair::new(ShapeMetric::default(), [&a, &b]).verdict(Default::default());
    /// let [a, b] = [&inches, &ring].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
    ///
    /// let evidence = MatchEvidence::new([&a, &b], verdict).named("ring.off", "ring.stl");
    /// assert_eq!(evidence.kind, EvidenceKind::Scaled);
    /// assert_eq!(evidence.to_string(), "ring.stl is ring.off scaled by 25.4 (inches to millimetres)");
    /// ```
    #[must_use]
    pub fn new([a, b]: [&MeshGeometry; 2], verdict: Verdict) -> Self {
        let content = [a.content, b.content];
        let evidence = Self {
            basis: Basis::Meshes,
            vertices: Some([a.n_vertices(), b.n_vertices()]),
            faces: Some([a.n_faces(), b.n_faces()]),
            components: Some([a.n_components(), b.n_components()]),
            ..Self::of_shapes(content, verdict)
        };
        if evidence.kind == EvidenceKind::IdenticalFile {
            return Self { basis: Basis::Files, ..evidence };
        }
        if let Some(same) = same_vertices(a, b) {
            return evidence.with_same_vertices(&same, [a, b]);
        }
        let (whole, found) = match (occurrences(a, b), occurrences(b, a)) {
            (Some(found), _) => (Side::Second, found),
            (None, Some(found)) => (Side::First, found),
            (None, None) => return evidence.with_surfaces([a, b]),
        };
        evidence.with_parts(whole, found)
    }

    /// The evidence on two shapes without their meshes: by the hashes of their files and the verdict.
    #[must_use]
    pub fn of_shapes(content: [Option<ContentHash>; 2], verdict: Verdict) -> Self {
        let same_file = matches!(content, [Some(a), Some(b)] if a == b);
        let (kind, confidence) = match same_file {
            true => (EvidenceKind::IdenticalFile, 1.0),
            false => by_verdict(&verdict),
        };
        let is_near = kind == EvidenceKind::OtherPose;
        let scale = if same_file { 1.0 } else { verdict.scale };
        let mut changes = Vec::new();
        if is_near && verdict.is_resized() {
            changes.push(Change::Scaled);
        }
        if is_near && verdict.handedness == Handedness::Mirrored {
            changes.push(Change::Mirrored);
        }
        Self {
            kind,
            confidence,
            units: UnitChange::of(scale, SAME_SIZE_OF_SURFACES).filter(|_| is_near),
            scale,
            changes,
            basis: if same_file { Basis::Files } else { Basis::Descriptions },
            content,
            vertices: None,
            faces: None,
            components: None,
            rotation: None,
            vertex_gap: None,
            surface_gap: None,
            parts: None,
            verdict,
            names: ["the first", "the second"].map(str::to_owned),
        }
    }

    /// The evidence with names for the first and the second mesh.
    #[must_use]
    pub fn named(self, first: &str, second: &str) -> Self {
        Self { names: [first, second].map(str::to_owned), ..self }
    }

    /// The evidence on the first mesh and one of the components of the second, when the verdict is on these two.
    #[must_use]
    pub(crate) fn of_component(mut self, n_components: usize) -> Self {
        if self.kind != EvidenceKind::PartOf && self.kind != EvidenceKind::Copies {
            self.kind = EvidenceKind::PartOf;
            self.parts = Some(Parts { whole: Side::Second, found: 1, components: n_components });
            self.changes.push(Change::Posed);
        }
        self
    }

    /// Whether the second mesh changed from the first in this way.
    #[must_use]
    pub fn has(&self, change: Change) -> bool {
        self.changes.contains(&change)
    }

    /// Of meshes whose vertices are the same.
    fn with_same_vertices(self, same: &SameVertices, [a, b]: [&MeshGeometry; 2]) -> Self {
        let scale = same.scale * b.size / a.size;
        let mut changes = Vec::new();
        let mut rotation = None;
        if !same.mirrored {
            let angle = nalgebra::Rotation3::from_matrix_unchecked(same.rotation).angle();
            let shift = b.centre.coords - same.rotation * a.centre.coords * scale;
            if shift.norm() > SAME_SIZE * b.size {
                changes.push(Change::Moved);
            }
            if angle > SAME_SIZE {
                changes.push(Change::Rotated);
            }
            rotation = Some(angle.to_degrees());
        }
        let mut kind = EvidenceKind::IdenticalGeometry;
        if scale.ln().abs() > SAME_SIZE {
            changes.push(Change::Scaled);
            kind = EvidenceKind::Scaled;
        }
        if same.mirrored {
            changes.push(Change::Mirrored);
            kind = EvidenceKind::Mirrored;
        }
        if !same.same_faces {
            changes.push(Change::Remeshed);
            kind = EvidenceKind::Remeshed;
        }
        let (vertex_gap, units) = (Some(same.gap), UnitChange::of(scale, SAME_SIZE));
        Self { kind, confidence: 1.0, changes, scale, units, rotation, vertex_gap, ..self }
    }

    /// Of meshes of which one, `whole`, has the other as a component.
    fn with_parts(self, whole: Side, found: Occurrences) -> Self {
        let scale = if whole == Side::Second { found.scale } else { 1.0 / found.scale };
        let is_resized =
            scale.ln().abs() > if found.same_vertices { SAME_SIZE } else { SAME_SIZE_OF_SURFACES };
        let mut changes = Vec::new();
        if is_resized {
            changes.push(Change::Scaled);
        }
        if found.mirrored {
            changes.push(Change::Mirrored);
        }
        if !found.same_vertices {
            changes.push(Change::Remeshed);
        }
        let all = found.found == found.components && found.found > 1;
        Self {
            kind: if all { EvidenceKind::Copies } else { EvidenceKind::PartOf },
            confidence: found.confidence,
            changes,
            scale,
            units: UnitChange::of(scale, SAME_SIZE_OF_SURFACES),
            surface_gap: found.gap,
            parts: Some(Parts { whole, found: found.found, components: found.components }),
            ..self
        }
    }

    /// Of meshes with different vertices: one surface, or what the verdict says.
    fn with_surfaces(self, [a, b]: [&MeshGeometry; 2]) -> Self {
        let Some(Aligned { map, gap, mirrored }) = aligned(a, b) else { return self };
        let change = MeshChange::of([a, b], &map);
        let (probability, surface_gap) = (same_surface(gap, [a, b], change), Some(gap));
        if probability < 0.5 || change == MeshChange::Deformed {
            return Self { surface_gap, ..self };
        }
        let scale = map.scale * b.size / a.size;
        let mut changes = Vec::new();
        if scale.ln().abs() > SAME_SIZE_OF_SURFACES {
            changes.push(Change::Scaled);
        }
        if mirrored {
            changes.push(Change::Mirrored);
        }
        changes.extend(change.triangles());
        let kind = if changes.iter().any(|change| *change >= Change::Decimated) {
            EvidenceKind::Remeshed
        } else {
            EvidenceKind::Noisy
        };
        if change.has_noise([a, b]) {
            changes.push(Change::Noisy);
        }
        let units = UnitChange::of(scale, SAME_SIZE_OF_SURFACES);
        Self { kind, confidence: probability, changes, scale, units, surface_gap, ..self }
    }
}

/// The likeliest kind by the verdict alone.
fn by_verdict(verdict: &Verdict) -> (EvidenceKind, f64) {
    if verdict.same_shape > 0.5 {
        (EvidenceKind::OtherPose, verdict.same_shape)
    } else if verdict.same_class > 0.5 {
        (EvidenceKind::SameClass, verdict.same_class - verdict.same_shape)
    } else {
        (EvidenceKind::Different, 1.0 - verdict.same_class)
    }
}
