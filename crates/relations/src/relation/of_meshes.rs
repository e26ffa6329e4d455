//! The relation of two meshes.

use super::cut::{CutPiece, FoundPiece, piece_of};
use super::exact::{SameVertices, same_vertices};
use super::geometry::MeshGeometry;
use super::in_space::{Aligned, aligned, is_symmetric};
use super::mesh_change::MeshChange;
use super::parts::{Occurrences, Parts, Side, occurrences};
use super::same_surface::{is_one_surface, same_surface};
use super::units::UnitChange;
use super::variant::differences;
use super::{Basis, Change, Relation, RelationKind, SIZE_OF_SURFACES, SIZE_OF_VERTICES};

/// Triangles in common are hardly chance. A convention.
const CUT: f64 = 0.99;

/// The share of parts called variants that are variants of one part. Measured on generated parts (`experiments run
/// evidence`).
const VARIANT: f64 = 0.95;

impl Relation {
    /// The relation once both meshes are known, too.
    ///
    /// ```
    /// use canonform_relations::{Handedness, MeshGeometry, Relation, RelationKind};
    /// use descriptors::ShapeDistance;
    /// use mesh::shapes;
    ///
    /// let ring = shapes::torus(24, 12, 2.0, 0.7);
    /// let mut inches = ring.clone();
    /// inches.positions.iter_mut().for_each(|p| *p /= 25.4);
    /// let [a, b] = [&inches, &ring].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
    /// let near = ShapeDistance { fused: 0.1, combined: 0.1 };
    /// let found = Relation::by_distance(near, 25.4, Handedness::Unknown).by_meshes([&a, &b]);
    /// assert_eq!(found.kind, RelationKind::Scaled);
    /// let words = found.named("ring.off", "ring.stl").to_string();
    /// assert_eq!(words, "ring.stl is ring.off scaled by 25.4 (inches to millimetres)");
    /// ```
    #[must_use]
    pub fn by_meshes(self, [a, b]: [&MeshGeometry; 2]) -> Self {
        let [known_a, known_b] = self.because.content;
        let mut found = self.by_files([a.content.or(known_a), b.content.or(known_b)]);
        found.because.vertices = Some([a.n_vertices(), b.n_vertices()]);
        found.because.faces = Some([a.n_faces(), b.n_faces()]);
        found.because.components = Some([a.n_components(), b.n_components()]);
        if found.kind == RelationKind::IdenticalFile {
            return found;
        }
        found.because.basis = Basis::Meshes;
        // Other faces between the same vertices may be another surface.
        if let Some(same) = same_vertices(a, b).filter(|same| same.same_faces || is_one_surface(same, [a, b]))
        {
            return found.with_same_vertices(&same, [a, b]);
        }
        let (whole, copies) = match (occurrences(a, b), occurrences(b, a)) {
            (Some(copies), _) => (Side::Second, copies),
            (None, Some(copies)) => (Side::First, copies),
            (None, None) => return found.with_surfaces([a, b]),
        };
        found.with_parts(whole, copies)
    }

    /// The relation of this kind, with everything that changed.
    fn found(mut self, kind: RelationKind, confidence: f64, changes: Vec<Change>, scale: f64) -> Self {
        self.because.scale = scale;
        Self { kind, confidence, changes, ..self }
    }

    /// Of meshes whose vertices are the same.
    fn with_same_vertices(mut self, same: &SameVertices, [a, b]: [&MeshGeometry; 2]) -> Self {
        let scale = same.scale * b.size / a.size;
        let mut changes = Vec::new();
        if !same.mirrored {
            let angle = nalgebra::Rotation3::from_matrix_unchecked(same.rotation).angle();
            let shift = b.centre.coords - same.rotation * a.centre.coords * scale;
            if shift.norm() > SIZE_OF_VERTICES * b.size {
                changes.push(Change::Moved);
            }
            if angle > SIZE_OF_VERTICES {
                changes.push(Change::Rotated);
            }
            self.because.rotation = Some(angle.to_degrees());
        }
        let mut kind = RelationKind::IdenticalGeometry;
        if scale.ln().abs() > SIZE_OF_VERTICES {
            changes.push(Change::Scaled);
            kind = RelationKind::Scaled;
        }
        // A surface that is its own mirror image is not another one for being mirrored, only its triangles are.
        let is_turned = same.mirrored && is_symmetric(b);
        if same.mirrored && !is_turned {
            changes.push(Change::Mirrored);
            kind = RelationKind::Mirrored;
        }
        if is_turned || !same.same_faces {
            changes.push(Change::Remeshed);
            kind = RelationKind::Remeshed;
        }
        self.because.vertex_gap = Some(same.gap);
        self.because.units = UnitChange::of(scale, SIZE_OF_VERTICES);
        self.found(kind, 1.0, changes, scale)
    }

    /// Of meshes of which one, `whole`, has the other as a component.
    fn with_parts(mut self, whole: Side, found: Occurrences) -> Self {
        let scale = if whole == Side::Second { found.scale } else { 1.0 / found.scale };
        let is_resized =
            scale.ln().abs() > if found.same_vertices { SIZE_OF_VERTICES } else { SIZE_OF_SURFACES };
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
        let kind = if all { RelationKind::Copies } else { RelationKind::PartOf };
        self.because.units = UnitChange::of(scale, SIZE_OF_SURFACES);
        self.because.surface_gap = found.gap;
        self.because.parts = Some(Parts { whole, found: found.found, components: found.components });
        self.found(kind, found.confidence, changes, scale)
    }

    /// Of meshes with different vertices: one surface, variants of one part, or what their distance says.
    fn with_surfaces(mut self, [a, b]: [&MeshGeometry; 2]) -> Self {
        let Some(aligned) = aligned(a, b) else { return self.with_differences([a, b], None) };
        let Aligned { map, gap, mirrored } = aligned;
        let change = MeshChange::of([a, b], &map);
        let probability = same_surface(&aligned, [a, b], change);
        self.because.surface_gap = Some(gap);
        if probability < 0.5 || change == MeshChange::Deformed {
            return self.with_differences([a, b], Some(gap.rms));
        }
        let scale = map.scale * b.size / a.size;
        let mut changes = Vec::new();
        if scale.ln().abs() > SIZE_OF_SURFACES {
            changes.push(Change::Scaled);
        }
        if mirrored {
            changes.push(Change::Mirrored);
        }
        changes.extend(change.triangles());
        let kind = if changes.iter().any(|change| *change >= Change::Decimated) {
            RelationKind::Remeshed
        } else {
            RelationKind::Noisy
        };
        if change.has_noise([a, b]) {
            changes.push(Change::Noisy);
        }
        self.because.units = UnitChange::of(scale, SIZE_OF_SURFACES);
        self.found(kind, probability, changes, scale)
    }

    /// Of meshes that are not one surface. Parts of machines do not bend, so they are variants of one part, or other parts.
    fn with_differences(mut self, meshes: [&MeshGeometry; 2], rms: Option<f64>) -> Self {
        let [a, b] = meshes;
        let cuts = [(Side::First, piece_of(a, b)), (Side::Second, piece_of(b, a))];
        if let Some((whole, found)) = cuts.into_iter().find_map(|(whole, found)| Some((whole, found?))) {
            let FoundPiece { left, factor } = found;
            self.because.cut = Some(CutPiece { whole, left });
            let scale = if whole == Side::First { factor } else { 1.0 / factor };
            let mut changes = vec![Change::Cut];
            if factor != 1.0 {
                changes.insert(0, Change::Scaled);
                self.because.units = UnitChange::of(scale, SIZE_OF_VERTICES);
            }
            return self.found(RelationKind::PartOf, CUT, changes, scale);
        }
        if let Some(differences) = differences(meshes, rms) {
            self.because.differences = differences;
            self.changes.clear();
            return Self { kind: RelationKind::Variant, confidence: VARIANT, ..self };
        }
        if meshes.iter().any(|mesh| mesh.is_mechanical()) && self.kind == RelationKind::OtherPose {
            self.changes.clear();
            return Self { kind: RelationKind::SameClass, confidence: self.because.same_class, ..self };
        }
        self
    }
}
