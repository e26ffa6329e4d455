//! The relation of two meshes.

use std::ops::ControlFlow::{self, Break, Continue};

use descriptors::Side;
use rigid::{Alignment, Gap, Similarity, align_surfaces, is_symmetric};

use super::calibration::{CUT, EXACT, FARTHEST, VARIANT};
use super::cut::piece_of;
use super::exact::{SameVertices, same_vertices};
use super::geometry::{MAX_ROUNDING, MeshGeometry, ROUNDING, SIZE_BY_DISTANCE};
use super::mesh_change::mesh_change;
use super::noise::noise_of_parts;
use super::parts::{PartCopy, Parts, occurrences};
use super::same_surface::{is_one_surface, same_surface};
use super::units::UnitChange;
use super::variant::differences;
use super::{Basis, Change, Relation, RelationKind, SIZE_OF_SURFACES};

/// Up to which share the sizes of two triangulations are equal that are so far apart, at unit area.
fn size_tolerance(gap: Gap) -> f64 {
    (SIZE_BY_DISTANCE * gap.rms).clamp(MAX_ROUNDING, SIZE_OF_SURFACES)
}

impl Relation {
    /// The relation once both meshes are known, too.
    ///
    /// ```
    /// use canonform_relations::{MeshGeometry, Relation, RelationKind};
    /// use descriptors::ShapeDistance;
    /// use mesh::shapes;
    /// use rigid::Handedness;
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
    pub fn by_meshes(self, meshes: [&MeshGeometry; 2]) -> Self {
        match self.with_shared(meshes) {
            Break(found) => found,
            Continue(found) => found.with_differences(meshes),
        }
    }

    /// The relation once both meshes are known, if all that matters is whether one is the other or has it as a component: pieces and
    /// variants are not sought.
    #[must_use]
    pub fn by_surfaces(self, meshes: [&MeshGeometry; 2]) -> Self {
        match self.with_shared(meshes) {
            Break(found) | Continue(found) => found,
        }
    }

    /// The relation once both meshes are known, if all that matters is whether they have the same vertices.
    #[must_use]
    pub fn by_vertices(self, meshes: [&MeshGeometry; 2]) -> Self {
        match self.with_vertices(meshes) {
            Break(found) | Continue(found) => found,
        }
    }

    /// The relation, if the meshes are one surface, or one is a component of the other; else the search for it goes on.
    fn with_shared(self, [a, b]: [&MeshGeometry; 2]) -> ControlFlow<Self, Self> {
        let found = self.with_vertices([a, b])?;
        let sides = [(Side::Second, a, b), (Side::First, b, a)];
        let copies = sides.into_iter().find_map(|(whole, mesh, of)| {
            let (found, copy) = occurrences(mesh, of)?;
            Some((Parts { whole, found, components: of.parts().len() }, copy))
        });
        match copies {
            Some((parts, copy)) => Break(found.with_parts(parts, copy)),
            None => found.with_surfaces([a, b]),
        }
    }

    /// The relation, if the meshes have the same vertices; else the search for it goes on.
    fn with_vertices(self, [a, b]: [&MeshGeometry; 2]) -> ControlFlow<Self, Self> {
        let [known_a, known_b] = self.evidence.content;
        let mut found = self.by_files([a.content.or(known_a), b.content.or(known_b)]);
        found.evidence.vertices = Some([a.n_vertices(), b.n_vertices()]);
        found.evidence.faces = Some([a.n_faces(), b.n_faces()]);
        found.evidence.components = Some([a.n_components(), b.n_components()]);
        if found.kind == RelationKind::IdenticalFile {
            return Break(found);
        }
        found.evidence.basis = Basis::Meshes;
        // Other faces between the same vertices may be another surface.
        match same_vertices(a, b).filter(|same| same.same_faces || is_one_surface(same, [a, b])) {
            Some(same) => Break(found.with_same_vertices(&same, [a, b])),
            None => Continue(found),
        }
    }

    /// The relation of this kind, with everything that changed; `tolerance` is that of the scale.
    fn found(
        mut self,
        kind: RelationKind,
        confidence: f64,
        changes: Vec<Change>,
        scale: f64,
        tolerance: f64,
    ) -> Self {
        self.evidence.scale = scale;
        self.evidence.units = UnitChange::from_scale(scale, tolerance);
        Self { kind, confidence, changes, ..self }
    }

    /// Of meshes whose vertices are the same.
    fn with_same_vertices(mut self, same: &SameVertices, [a, b]: [&MeshGeometry; 2]) -> Self {
        let Similarity { rotation, reflected, scale, .. } = same.map;
        let scale = scale * b.size() / a.size();
        let mut changes = Vec::new();
        if !reflected {
            let angle = nalgebra::Rotation3::from_matrix_unchecked(rotation).angle();
            let shift = b.surface.center.coords - rotation * a.surface.center.coords * scale;
            if shift.norm() > MAX_ROUNDING * b.size() {
                changes.push(Change::Moved);
            }
            if angle > MAX_ROUNDING {
                changes.push(Change::Rotated);
            }
            self.evidence.rotation = Some(angle.to_degrees());
        }
        // A surface that is its own mirror image is not another one for being mirrored, only its triangles are.
        let is_turned = reflected && is_symmetric(&b.surface);
        // Sizes are known as well as vertices agree.
        let tolerance = (SIZE_BY_DISTANCE * same.gap).clamp(ROUNDING, MAX_ROUNDING);
        changes.extend(Change::from_similarity(scale, tolerance, reflected && !is_turned));
        changes.extend((is_turned || !same.same_faces).then_some(Change::Remeshed));
        let kind = match changes.last() {
            Some(Change::Scaled) => RelationKind::Scaled,
            Some(Change::Mirrored) => RelationKind::Mirrored,
            Some(Change::Remeshed) => RelationKind::Remeshed,
            _ => RelationKind::IdenticalGeometry,
        };
        (self.evidence.vertex_gap, self.map) = (Some(same.gap), Some(same.map));
        self.found(kind, 1.0, changes, scale, tolerance)
    }

    /// Of meshes of which one has the other as a component.
    fn with_parts(mut self, parts: Parts, copy: PartCopy) -> Self {
        let PartCopy { scale, mirrored, gap, confidence } = copy;
        let scale = if parts.whole == Side::Second { scale } else { 1.0 / scale };
        let tolerance = gap.map_or(MAX_ROUNDING, size_tolerance);
        let mut changes = Change::from_similarity(scale, tolerance, mirrored);
        changes.extend(gap.map(|_| Change::Remeshed));
        let all = parts.found == parts.components && parts.found > 1;
        let kind = if all { RelationKind::Copies } else { RelationKind::PartOf };
        self.evidence.surface_gap = gap;
        self.evidence.parts = Some(parts);
        self.found(kind, confidence, changes, scale, tolerance)
    }

    /// Of meshes with different vertices that are one surface; else with how far their surfaces are apart.
    fn with_surfaces(mut self, [a, b]: [&MeshGeometry; 2]) -> ControlFlow<Self, Self> {
        let Some(aligned) = align_surfaces(&a.surface, &b.surface) else { return Continue(self) };
        let Alignment { map, gap } = aligned;
        let change = mesh_change([a, b], &map);
        let [ratio, probability] = same_surface(&aligned, [a, b], change);
        (self.evidence.surface_gap, self.evidence.gap_ratio, self.map) = (Some(gap), Some(ratio), Some(map));
        if probability < 0.5 || change == Change::Posed {
            return Continue(self);
        }
        let scale = map.scale * b.size() / a.size();
        let tolerance = size_tolerance(gap);
        let mut changes = Change::from_similarity(scale, tolerance, map.reflected);
        let kind = if change == Change::Noisy { RelationKind::Noisy } else { RelationKind::Remeshed };
        changes.push(change);
        // One of the two has noise, and the other has not.
        let is_noisier = match noise_of_parts([a, b]) {
            Some([x, y]) => (x - y).abs() > EXACT / FARTHEST,
            None => a.is_noisy() != b.is_noisy(),
        };
        if change != Change::Noisy && is_noisier {
            changes.push(Change::Noisy);
        }
        Break(self.found(kind, probability, changes, scale, tolerance))
    }

    /// Of meshes that are not one surface. Parts of machines do not bend, so they are variants of one part, or other parts.
    fn with_differences(mut self, meshes: [&MeshGeometry; 2]) -> Self {
        let [a, b] = meshes;
        let rms = self.evidence.surface_gap.map(|gap| gap.rms);
        let differences = differences(meshes, rms);
        // What was cut out of a body is open; a closed part is a variant, though it shares most triangles.
        let is_cut = |piece: &MeshGeometry| differences.is_none() || piece.closed().is_none();
        let sides = [(Side::First, a, b), (Side::Second, b, a)].into_iter();
        let mut pieces = sides.filter(|(_, _, piece)| is_cut(piece));
        if let Some((cut, factor)) = pieces.find_map(|(whole, of, piece)| piece_of(whole, of, piece)) {
            let scale = if cut.whole == Side::First { factor } else { 1.0 / factor };
            self.evidence.cut = Some(cut);
            let mut changes = Change::from_similarity(scale, MAX_ROUNDING, false);
            changes.push(Change::Cut);
            return self.found(RelationKind::PartOf, CUT, changes, scale, MAX_ROUNDING);
        }
        if let Some(differences) = differences {
            self.evidence.differences = differences;
            self.changes.clear();
            return Self { kind: RelationKind::Variant, confidence: VARIANT, ..self };
        }
        let is_mechanical = meshes.iter().any(|mesh| mesh.is_mechanical());
        let mut found = if is_mechanical { self.without_poses() } else { self };
        if meshes.iter().all(|mesh| mesh.is_exact_part()) {
            found.evidence.same_shape = 0.0;
            if found.kind == RelationKind::SameClass {
                found.confidence = found.evidence.same_class;
            }
        }
        found
    }
}
