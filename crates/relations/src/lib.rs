//! How two shapes are related: one file, one geometry, one surface, one shape, one class, or a part of each other.
//!
//! ```text
//! ShapeDistance -> Relation by descriptions
//! TriMesh -> MeshGeometry -> same vertices? components? one surface in space? -> Relation by meshes
//! ```

mod calibration;
mod cut;
mod evidence;
mod exact;
mod exactness;
mod extents;
mod geometry;
mod invariants;
mod kind;
mod mesh_change;
mod mesh_overlay;
mod noise;
mod numbers;
mod of_meshes;
mod offsets;
mod parts;
mod same_surface;
mod units;
mod variant;
mod words;

use base::ContentHash;
use descriptors::{Boundary, ShapeDistance, ShapeMetric, Side};
use rigid::{Handedness, Similarity};

pub use cut::CutPiece;
pub use evidence::{Basis, Evidence};
pub use exactness::Merit;
pub use geometry::MeshGeometry;
pub use invariants::SurfaceInvariants;
pub use kind::{Change, RelationKind};
pub use mesh_overlay::MeshOverlay;
pub use numbers::in_four_digits;
pub use parts::Parts;
pub use units::UnitChange;
pub use variant::{Difference, Dimension};

/// Sizes of two triangulations of one surface, and of copies on one plate, are equal up to this share. A tolerance: fewer
/// triangles cut off more of a curved surface, so that a decimated copy of the same size is aligned at a slightly different one.
const SIZE_OF_SURFACES: f64 = 0.01;

/// How two shapes are related: the one answer of every program. [`Display`](std::fmt::Display) says it in a sentence,
/// [`reason`](Self::reason) the numbers that decided.
///
/// The first of these that applies decides:
///
/// 1. The files have the same hash.
/// 2. The vertices are the same after a motion, a reflection and a change of size, up to the rounding of files.
/// 3. A mesh is among the components of the other, in this sense or the next.
/// 4. The surfaces coincide up to a small distance after the best motion, reflection and change of size in space.
/// 5. The distance of their shapes: one shape, which is then in another pose, one class, or different ones.
///
/// The last needs descriptions only, as an index stores them; the others need the files or the meshes.
#[derive(Debug, Clone, PartialEq)]
pub struct Relation {
    /// The kind, by what changed least.
    pub kind: RelationKind,
    /// From the first mesh to the second, or to the copies that are part of one of them.
    pub changes: Vec<Change>,
    /// Probability of the kind, 0 to 1, by fits to generated shapes with whole families held out. Of variants and of pieces it is a
    /// score: the share of such answers that was right.
    pub confidence: f64,
    /// What it is told from.
    pub evidence: Evidence,
    /// What the two are called in words.
    names: [String; 2],
    /// The map from the first mesh to the second, both at unit area, of surfaces that are alike in space.
    map: Option<Similarity>,
}

impl Relation {
    /// The relation of two shapes by their distance alone, the likeliest. `scale` is the size of the second over that of the
    /// first.
    ///
    /// ```
    /// use canonform_relations::{Relation, RelationKind};
    /// use rigid::Handedness;
    ///
    /// # use descriptors::ShapeDistance;
    /// let at = |d| Relation::by_distance(ShapeDistance { fused: d, combined: d }, 1.0, Handedness::Unknown);
    /// assert_eq!(at(0.5).kind, RelationKind::OtherPose);
    /// assert_eq!(at(20.0).named("cat", "hand").to_string(), "hand is not the same shape as cat");
    /// assert!(at(0.5).confidence > at(1.0).confidence);
    /// ```
    pub fn by_distance(distance: ShapeDistance, scale: f64, handedness: Handedness) -> Self {
        Self::in_classes(distance, scale, handedness, None)
    }

    /// The same in a collection that has classes with this boundary.
    pub fn in_classes(
        distance: ShapeDistance,
        scale: f64,
        handedness: Handedness,
        classes: Option<Boundary>,
    ) -> Self {
        let same_class = classes.unwrap_or(ShapeMetric::SAME_CLASS).probability(distance.combined);
        // Bodies of one class may be farther apart elsewhere, poses of one body not.
        let same_shape = distance.same_shape().min(same_class);
        let mut evidence =
            Evidence { distance, same_shape, same_class, classes, scale, handedness, ..Evidence::default() };
        let (another_shape, another_class) = (same_class - same_shape, 1.0 - same_class);
        let (kind, confidence, changes) = if same_shape >= another_shape.max(another_class) {
            evidence.units = UnitChange::from_scale(scale, SIZE_OF_SURFACES);
            let tolerance = ShapeMetric::SIZE_OF_POSES.ln();
            let changes = Change::from_similarity(scale, tolerance, handedness == Handedness::Mirrored);
            (RelationKind::OtherPose, same_shape, changes)
        } else if another_shape >= another_class {
            (RelationKind::SameClass, another_shape, Vec::new())
        } else {
            (RelationKind::Different, another_class, Vec::new())
        };
        let names = ["the first", "the second"].map(str::to_owned);
        Self { kind, changes, confidence, evidence, names, map: None }
    }

    /// The relation of parts of machines: they do not bend, so that another pose is not what their distance may say.
    #[must_use]
    pub fn without_poses(mut self) -> Self {
        if self.kind == RelationKind::OtherPose {
            self.changes.clear();
            (self.kind, self.confidence) = (RelationKind::SameClass, self.evidence.same_class);
        }
        self
    }

    /// The relation once the hashes of the files are known, too.
    #[must_use]
    pub fn by_files(mut self, content: [Option<ContentHash>; 2]) -> Self {
        self.evidence.content = content;
        if matches!(content, [Some(a), Some(b)] if a == b) {
            (self.kind, self.confidence) = (RelationKind::IdenticalFile, 1.0);
            self.changes.clear();
            self.evidence = Evidence { basis: Basis::Files, scale: 1.0, units: None, ..self.evidence };
        }
        self
    }

    /// The relation with names for the first and the second mesh.
    #[must_use]
    pub fn named(self, first: &str, second: &str) -> Self {
        Self { names: [first, second].map(str::to_owned), ..self }
    }

    /// The relation of the first mesh and one of the components of the second, when the distance is that of these two.
    #[must_use]
    pub fn to_component(mut self, n_components: usize) -> Self {
        if self.kind != RelationKind::PartOf && self.kind != RelationKind::Copies {
            self.kind = RelationKind::PartOf;
            self.evidence.parts = Some(Parts { whole: Side::Second, found: 1, components: n_components });
            self.changes.push(Change::Posed);
        }
        self
    }

    /// Whether the second mesh changed from the first in this way.
    pub fn has(&self, change: Change) -> bool {
        self.changes.contains(&change)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn at(combined: f64, scale: f64, handedness: Handedness) -> Relation {
        Relation::by_distance(ShapeDistance { fused: combined, combined }, scale, handedness).named("a", "b")
    }

    /// The relation of two meshes at the distance of one shape. In space it does not depend on the distance.
    pub(crate) fn related(a: &MeshGeometry, b: &MeshGeometry) -> Relation {
        at(0.1, 1.0, Handedness::Unknown).by_meshes([a, b])
    }

    #[test]
    fn kinds_follow_each_other_as_the_distance_grows() {
        let mut kinds = Vec::new();
        for i in 0..4000 {
            let next = at(f64::from(i) * 0.005, 1.0, Handedness::Unknown);
            // Where one class ends, one shape is still possible, in a share of `far`: none of three kinds has half, and the
            // likeliest has (1 - far) / (2 - far).
            let far = ShapeMetric::SAME_SHAPE.range[0];
            assert!(
                next.confidence > (1.0 - far) / (2.0 - far) - 0.005 && next.confidence <= 1.0,
                "{next:?}"
            );
            if kinds.last() != Some(&next.kind) {
                kinds.push(next.kind);
            }
        }
        assert_eq!(kinds, [RelationKind::OtherPose, RelationKind::SameClass, RelationKind::Different]);
    }

    #[test]
    fn size_and_handedness_are_changes_of_one_shape_only() {
        let (near, far) = (0.2, 30.0);
        for unclear in [Handedness::Same, Handedness::Either, Handedness::Unknown] {
            assert_eq!(at(near, 1.0, unclear).to_string(), "b is probably a in this or another pose");
            assert_eq!(
                at(near, 1.129, unclear).to_string(),
                "b is probably a in this or another pose, scaled by 1.129"
            );
        }
        let mirrored = at(near, 1.02, Handedness::Mirrored);
        assert_eq!(mirrored.to_string(), "b is probably a in this or another pose, mirrored");
        assert_eq!(at(near, 2.0, Handedness::Mirrored).changes, [Change::Scaled, Change::Mirrored]);
        let apart = at(far, 3.0, Handedness::Mirrored);
        assert_eq!((apart.changes.len(), apart.to_string().as_str()), (0, "b is not the same shape as a"));
    }

    #[test]
    fn sizes_are_told_apart_as_precisely_as_vertices_agree() {
        let ring = mesh::shapes::torus(24, 12, 2.0, 0.7);
        let rounded = |x: f64| (1e5 * x).round() / 1e5;
        for (factor, kind) in [(1.000_002, RelationKind::IdenticalGeometry), (1.000_05, RelationKind::Scaled)]
        {
            for is_rounded in [false, true] {
                let mut other = ring.clone();
                other.positions.iter_mut().for_each(|p| *p *= factor);
                if is_rounded {
                    other.positions.iter_mut().for_each(|p| p.coords.apply(|x| *x = rounded(*x)));
                }
                let [a, b] = [&ring, &other].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
                let found = related(&a, &b);
                assert_eq!(found.kind, kind, "{factor}, {is_rounded}: {found}");
            }
        }
    }

    #[test]
    fn coordinates_that_were_rounded_far_from_the_origin_are_not_noise() {
        let ring =
            testkit::moved(&mesh::shapes::torus(24, 12, 200.0, 70.0), |p| p + Vector3::new(4e5, 4.1e6, 0.0));
        let single = testkit::moved(&ring, |p| p.map(|x| f64::from(x as f32)));
        let [a, b] = [&ring, &single].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
        let found = related(&a, &b);
        assert_eq!(found.kind, RelationKind::IdenticalGeometry, "{found}");
    }

    #[test]
    fn what_is_not_certain_is_probable() {
        let unsure = at(ShapeMetric::SAME_SHAPE.at * 1.01, 1.0, Handedness::Unknown);
        assert_eq!(unsure.to_string(), "b is similar to a, and perhaps a in another pose");
        let unsure = at(ShapeMetric::SAME_CLASS.at * 1.01, 1.0, Handedness::Unknown);
        assert_eq!(unsure.to_string(), "b is probably not the same shape as a");
    }

    #[test]
    fn classes_are_spoken_of_only_where_there_are_some() {
        let classes = Some(Boundary::new(8.0, 6.0));
        let at = |combined| {
            let distance = ShapeDistance { fused: combined, combined };
            Relation::in_classes(distance, 1.0, Handedness::Unknown, classes).named("a", "b")
        };
        assert_eq!(at(5.0).kind, RelationKind::SameClass, "classes of this collection are wide");
        assert_eq!(at(5.0).to_string(), "b is of the same class as a, but another shape");
        assert_eq!(
            (at(5.0).in_brief(), at(20.0).in_brief()),
            ("the same class".into(), "another class".into())
        );
        assert_eq!(at(20.0).to_string(), "b is of another class than a");
        assert!(at(20.0).reason().contains("another class above"));
        let part = Relation::by_distance(ShapeDistance::default(), 1.0, Handedness::Unknown).without_poses();
        assert_eq!((part.in_brief(), part.kind), ("a similar shape".into(), RelationKind::SameClass));
    }
}
