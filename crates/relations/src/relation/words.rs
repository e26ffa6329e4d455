//! Relations in words, and as a record.

use std::fmt::{self, Display, Formatter};

use descriptors::ShapeMetric;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::cut::CutPiece;
use super::in_space::SurfaceGap;
use super::numbers::{in_digits, in_words, percent};
use super::parts::{Parts, Side};
use super::variant::Difference;
use super::{Basis, Because, Change, Relation, RelationKind};

impl Display for Relation {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [a, b] = &self.names;
        let probably = self.probably();
        let perhaps_same = self.because.same_shape > 1.0 - ShapeMetric::CERTAIN;
        match (self.kind, self.because.parts) {
            (RelationKind::IdenticalFile, _) => write!(f, "{b} is the same file as {a}"),
            (RelationKind::IdenticalGeometry, _) if self.changes.is_empty() => {
                write!(f, "{b} has the same geometry as {a}")
            }
            (RelationKind::OtherPose, _) => {
                write!(f, "{b} is {probably}{a} {}", self.pose())?;
                self.write_changes(f, ", ")
            }
            (RelationKind::SameClass, _) if !probably.is_empty() && perhaps_same => {
                write!(f, "{b} is of the same class as {a}, and perhaps {a} in another pose")
            }
            (RelationKind::SameClass, _) => {
                write!(f, "{b} is {probably}of the same class as {a}, but another shape")
            }
            (RelationKind::Different, _) => write!(f, "{b} is {probably}another kind of shape than {a}"),
            (RelationKind::Copies | RelationKind::PartOf, Some(parts)) => self.write_parts(f, parts),
            (RelationKind::PartOf, None) => self.write_cut(f),
            (RelationKind::Variant, _) => {
                write!(f, "{b} is {probably}a variant of {a}: {}", list(&self.because.differences))
            }
            _ => {
                write!(f, "{b} is {probably}{a}")?;
                self.write_changes(f, " ")
            }
        }
    }
}

impl Relation {
    /// What the two have in common, in a few words.
    #[must_use]
    pub fn in_brief(&self) -> String {
        format!("{}{}", self.probably(), self.kind.words())
    }

    /// The numbers that decided.
    #[must_use]
    pub fn reason(&self) -> String {
        let Because { vertex_gap, surface_gap, content, vertices, .. } = &self.because;
        let vertices = match vertices {
            Some([a, b]) if a == b => format!("{a} vertices on both sides"),
            Some([a, b]) => format!("{a} and {b} vertices"),
            None => String::new(),
        };
        let shape = self.by_distance_in_words();
        match (self.kind, vertex_gap, surface_gap) {
            (RelationKind::IdenticalFile, ..) => match content[0] {
                Some(hash) => format!("the files have the same SHA-256 hash, {}...", &hash.to_string()[..12]),
                None => "the files have the same hash".to_owned(),
            },
            (RelationKind::PartOf, ..) if self.has(Change::Posed) => {
                format!("by the signatures of the component alone; {shape}")
            }
            (RelationKind::PartOf, ..) if self.has(Change::Cut) => {
                format!("its triangles are triangles of the other mesh; {vertices}")
            }
            (_, Some(gap), _) => {
                let faces = if self.has(Change::Remeshed) { "other faces" } else { "the same faces" };
                format!("{vertices}, at most {gap:.1e} of the size apart once aligned in space; {faces}")
            }
            (RelationKind::Copies | RelationKind::PartOf, None, None) => {
                "the components have the same vertices once aligned in space".to_owned()
            }
            (kind, None, Some(gap)) if kind <= RelationKind::PartOf => {
                format!("the surfaces are {} once aligned in space; {vertices}", apart(gap))
            }
            (_, None, Some(gap)) => format!("{shape}; in space, the surfaces are {}", apart(gap)),
            (_, None, None) if self.because.basis == Basis::Descriptions => {
                format!("{shape}; the mesh was not compared")
            }
            (_, None, None) => format!("{shape}; in space, they are not one surface"),
        }
    }

    /// The distance of the shapes, and what it is compared with.
    fn by_distance_in_words(&self) -> String {
        let ([shape, _], [_, class]) = (ShapeMetric::SAME_SHAPE.gap(), ShapeMetric::SAME_CLASS.gap());
        let distance = self.because.distance.combined;
        format!(
            "combined distance {distance:.3} (same shape below {shape:.3}, another class above {class:.3})"
        )
    }

    fn probably(&self) -> &'static str {
        if self.confidence < ShapeMetric::CERTAIN { "probably " } else { "" }
    }

    /// The changes, the first after `start`, which is left out if there are none.
    fn write_changes(&self, f: &mut Formatter<'_>, start: &str) -> fmt::Result {
        let mut separator = start;
        for change in &self.changes {
            f.write_str(separator)?;
            separator = ", ";
            let vertices = self.because.vertices.unwrap_or([1, 1]).map(|n| n.max(1) as f64);
            let share = vertices[1] / vertices[0];
            match change {
                Change::Moved => f.write_str("moved")?,
                Change::Rotated => write!(f, "rotated by {:.1}°", self.because.rotation.unwrap_or_default())?,
                Change::Scaled => self.write_scale(f)?,
                Change::Mirrored => f.write_str("mirrored")?,
                Change::Decimated => write!(f, "decimated to {} of the vertices", percent(share))?,
                Change::Subdivided => write!(f, "subdivided to {share:.1} times the vertices")?,
                Change::Remeshed if self.because.vertex_gap.is_some() => f.write_str("with other faces")?,
                Change::Remeshed if self.because.parts.is_some() || (share - 1.0).abs() < 0.005 => {
                    f.write_str("remeshed")?;
                }
                Change::Remeshed => write!(f, "remeshed with {share:.2} times the vertices")?,
                Change::Posed => f.write_str(self.pose())?,
                Change::Cut => f.write_str("cut")?,
                Change::Noisy => {
                    let gap = self.because.surface_gap.map_or(0.0, |gap| gap.rms);
                    write!(f, "with noise of {} of the size", percent(gap))?;
                }
            }
        }
        Ok(())
    }

    /// Without meshes the pose is unknown.
    fn pose(&self) -> &'static str {
        match self.because.basis {
            Basis::Descriptions => "in this or another pose",
            Basis::Files | Basis::Meshes => "in another pose",
        }
    }

    fn write_scale(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "scaled by {}", in_digits(5, self.because.scale))?;
        match self.because.units {
            Some(units) => write!(f, " ({units})"),
            None => Ok(()),
        }
    }

    fn write_cut(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [a, b] = &self.names;
        let CutPiece { whole, left } =
            self.because.cut.unwrap_or(CutPiece { whole: Side::Second, left: 1.0 });
        let (part, whole) = if whole == Side::Second { (a, b) } else { (b, a) };
        write!(f, "{part} is a piece of {whole}: {} of its surface", percent(left))?;
        if self.has(Change::Scaled) {
            f.write_str(", ")?;
            self.write_scale(f)?;
        }
        Ok(())
    }

    fn write_parts(&self, f: &mut Formatter<'_>, parts: Parts) -> fmt::Result {
        let [a, b] = &self.names;
        let (part, whole) = if parts.whole == Side::Second { (a, b) } else { (b, a) };
        let Parts { found, components, .. } = parts;
        match (self.kind, found) {
            (RelationKind::Copies, _) => write!(f, "{whole} is {} copies of {part}", in_words(found))?,
            (_, 1) => write!(f, "{part} is part of {whole}, one of its {} components", in_words(components))?,
            _ => write!(
                f,
                "{whole} has {} copies of {part} among its {} components",
                in_words(found),
                in_words(components)
            )?,
        }
        // From the first to the second, whichever is the whole.
        self.write_changes(f, ", ")
    }
}

fn apart(gap: &SurfaceGap) -> String {
    format!("{} of the size apart (root mean square; at most {})", percent(gap.rms), percent(gap.max))
}

/// The first differences, and how many more there are.
fn list(differences: &[Difference]) -> String {
    const SHOWN: usize = 3;
    let shown: Vec<String> = differences.iter().take(SHOWN).map(Difference::to_string).collect();
    match differences.len() {
        n if n > SHOWN => format!("{}, and {} more", shown.join(", "), n - SHOWN),
        _ => shown.join(", "),
    }
}

/// Everything that a relation is told from, with its words.
#[derive(Serialize)]
struct BecauseRecord<'a> {
    text: String,
    #[serde(flatten)]
    because: &'a Because,
}

impl Serialize for Relation {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        let mut record = out.serialize_struct("Relation", 6)?;
        record.serialize_field("kind", &self.kind)?;
        record.serialize_field("confidence", &self.confidence)?;
        record.serialize_field("changes", &self.changes)?;
        record.serialize_field("text", &self.to_string())?;
        record.serialize_field("brief", &self.in_brief())?;
        let because = BecauseRecord { text: self.reason(), because: &self.because };
        record.serialize_field("because", &because)?;
        record.end()
    }
}
