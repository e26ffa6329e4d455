//! Relations in words, and as a record.

use std::fmt::{self, Display, Formatter};

use descriptors::{Boundary, ShapeMetric, Side};
use rigid::Gap;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::cut::CutPiece;
use super::numbers::{in_digits, in_words, percent};
use super::parts::Parts;
use super::variant::Difference;
use super::{Basis, Change, Evidence, Relation, RelationKind};

impl Display for Relation {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [a, b] = &self.names;
        let probably = self.probably();
        let perhaps_same = self.evidence.same_shape > 1.0 - Boundary::CERTAIN;
        match (self.kind, self.evidence.parts) {
            (RelationKind::IdenticalFile, _) => write!(f, "{b} is the same file as {a}"),
            (RelationKind::IdenticalGeometry, _) if self.changes.is_empty() => {
                write!(f, "{b} has the same geometry as {a}")
            }
            (RelationKind::OtherPose, _) => {
                let changes = self.with_changes(self.pose().to_owned());
                write!(f, "{b} is {probably}{a} {changes}")
            }
            (RelationKind::SameClass, _) => {
                let [alike, not] = match self.evidence.classes {
                    Some(_) => ["of the same class as", "another shape"],
                    None => ["similar to", "not the same shape"],
                };
                match !probably.is_empty() && perhaps_same {
                    true => write!(f, "{b} is {alike} {a}, and perhaps {a} in another pose"),
                    false => write!(f, "{b} is {probably}{alike} {a}, but {not}"),
                }
            }
            (RelationKind::Different, _) if self.evidence.classes.is_some() => {
                write!(f, "{b} is {probably}of another class than {a}")
            }
            (RelationKind::Different, _) => write!(f, "{b} is {probably}not the same shape as {a}"),
            (RelationKind::Copies | RelationKind::PartOf, Some(parts)) => {
                f.write_str(&self.with_changes(self.parts_in_words(parts)))
            }
            (RelationKind::PartOf, None) => f.write_str(&self.with_changes(self.cut_in_words())),
            (RelationKind::Variant, _) => {
                write!(f, "{b} is {probably}a variant of {a}: {}", list(&self.evidence.differences))
            }
            _ => write!(f, "{b} is {probably}{a} {}", self.changes_in_words().join(", ")),
        }
    }
}

impl Relation {
    /// What the two have in common, in a few words.
    pub fn in_brief(&self) -> String {
        let words = match (self.kind, self.evidence.classes) {
            (RelationKind::SameClass, Some(_)) => "the same class",
            (RelationKind::Different, Some(_)) => "another class",
            (kind, _) => kind.words(),
        };
        format!("{}{words}", self.probably())
    }

    /// The numbers that decided.
    pub fn reason(&self) -> String {
        let Evidence { vertex_gap, surface_gap, content, vertices, .. } = &self.evidence;
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
            (kind, None, Some(gap)) if !(kind.is_by_distance() || kind == RelationKind::Variant) => {
                format!("the surfaces are {} once aligned in space; {vertices}", apart(gap))
            }
            (_, None, Some(gap)) => format!("{shape}; in space, the surfaces are {}", apart(gap)),
            (_, None, None) if self.evidence.basis == Basis::Descriptions => {
                format!("{shape}; the mesh was not compared")
            }
            (_, None, None) => format!("{shape}; in space, they are not one surface"),
        }
    }

    /// The distance of the shapes, and what it is compared with.
    fn by_distance_in_words(&self) -> String {
        let (shape, distance) = (ShapeMetric::SAME_SHAPE.at, self.evidence.distance.combined);
        let above = match self.evidence.classes {
            Some(classes) => format!("probably another class above {:.3}", classes.at),
            None => format!("not alike above {:.3}", ShapeMetric::SAME_CLASS.gap()[1]),
        };
        format!("combined distance {distance:.3} (probably one shape below {shape:.3}, {above})")
    }

    fn probably(&self) -> &'static str {
        // Without classes, what is said of different shapes is that they are not one.
        let certainty = match (self.kind, self.evidence.classes) {
            (RelationKind::Different, None) => 1.0 - self.evidence.same_shape,
            _ => self.confidence,
        };
        if certainty < Boundary::CERTAIN { "probably " } else { "" }
    }

    /// What was said, and all changes.
    fn with_changes(&self, said: String) -> String {
        [vec![said], self.changes_in_words()].concat().join(", ")
    }

    /// All changes but a cut, of which the sentence is.
    fn changes_in_words(&self) -> Vec<String> {
        let vertices = self.evidence.vertices.unwrap_or([1, 1]).map(|n| n.max(1) as f64);
        let share = vertices[1] / vertices[0];
        let in_words = |change: &Change| match change {
            Change::Moved => "moved".to_owned(),
            Change::Rotated => format!("rotated by {:.1}°", self.evidence.rotation.unwrap_or_default()),
            Change::Scaled => self.scale_in_words(),
            Change::Mirrored => "mirrored".to_owned(),
            Change::Decimated => format!("decimated to {} of the vertices", percent(share)),
            Change::Subdivided => format!("subdivided to {share:.1} times the vertices"),
            Change::Remeshed if self.evidence.vertex_gap.is_some() => "with other faces".to_owned(),
            Change::Remeshed if self.evidence.parts.is_some() || (share - 1.0).abs() < 0.005 => {
                "remeshed".to_owned()
            }
            Change::Remeshed => format!("remeshed with {share:.2} times the vertices"),
            Change::Posed => self.pose().to_owned(),
            Change::Cut => "cut".to_owned(),
            Change::Noisy => {
                let gap = self.evidence.surface_gap.map_or(0.0, |gap| gap.rms);
                format!("with noise of {} of the size", percent(gap))
            }
        };
        self.changes.iter().filter(|change| **change != Change::Cut).map(in_words).collect()
    }

    /// Without meshes the pose is unknown.
    fn pose(&self) -> &'static str {
        match self.evidence.basis {
            Basis::Descriptions => "in this or another pose",
            Basis::Files | Basis::Meshes => "in another pose",
        }
    }

    /// From the first to the second, whichever is the whole.
    fn scale_in_words(&self) -> String {
        let scale = in_digits(5, self.evidence.scale);
        self.evidence
            .units
            .map_or_else(|| format!("scaled by {scale}"), |units| format!("scaled by {scale} ({units})"))
    }

    /// The part and the whole.
    fn part_and_whole(&self, whole: Side) -> [&str; 2] {
        let [a, b] = &self.names;
        if whole == Side::Second { [a, b] } else { [b, a] }
    }

    fn cut_in_words(&self) -> String {
        let CutPiece { whole, left } =
            self.evidence.cut.unwrap_or(CutPiece { whole: Side::Second, left: 1.0 });
        let [part, whole] = self.part_and_whole(whole);
        format!("{part} is a piece of {whole}: {} of its surface", percent(left))
    }

    fn parts_in_words(&self, Parts { whole, found, components }: Parts) -> String {
        let [part, whole] = self.part_and_whole(whole);
        let [copies, all] = [found, components].map(in_words);
        match (self.kind, found) {
            (RelationKind::Copies, _) => format!("{whole} is {copies} copies of {part}"),
            (_, 1) if components == 1 => format!("{part} is part of {whole}, its only large component"),
            (_, 1) => format!("{part} is part of {whole}, one of its {all} components"),
            _ => format!("{whole} has {copies} copies of {part} among its {all} components"),
        }
    }
}

fn apart(gap: &Gap) -> String {
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
struct EvidenceRecord<'a> {
    text: String,
    #[serde(flatten)]
    evidence: &'a Evidence,
}

impl Serialize for Relation {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        let mut record = out.serialize_struct("Relation", 6)?;
        record.serialize_field("kind", &self.kind)?;
        record.serialize_field("confidence", &self.confidence)?;
        record.serialize_field("changes", &self.changes)?;
        record.serialize_field("text", &self.to_string())?;
        record.serialize_field("brief", &self.in_brief())?;
        let evidence = EvidenceRecord { text: self.reason(), evidence: &self.evidence };
        record.serialize_field("because", &evidence)?;
        record.end()
    }
}
