//! Evidence in words, and as a record.

use std::fmt::{self, Display, Formatter};

use index::ContentHash;
use serde::{Serialize, Serializer};

use super::in_space::SurfaceGap;
use super::kinds::{Basis, Change, EvidenceKind};
use super::match_evidence::MatchEvidence;
use super::parts::{Parts, Side};
use super::units::UnitChange;

/// What is less probable is only probable.
const FIRM: f64 = 0.9;

impl Display for MatchEvidence {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [a, b] = &self.names;
        let probably = if self.confidence < FIRM { "probably " } else { "" };
        match (self.kind, self.parts) {
            (EvidenceKind::IdenticalFile, _) => write!(f, "{b} is the same file as {a}"),
            (EvidenceKind::IdenticalGeometry, _) if self.changes.is_empty() => {
                write!(f, "{b} has the same geometry as {a}")
            }
            (EvidenceKind::OtherPose, _) => {
                write!(f, "{b} is {probably}{a} {}", self.pose())?;
                self.write_changes(f, ", ")
            }
            (EvidenceKind::SameClass, _)
                if self.confidence < FIRM && self.verdict.same_shape > 1.0 - FIRM =>
            {
                write!(f, "{b} is of the same class as {a}, and perhaps {a} in another pose")
            }
            (EvidenceKind::SameClass, _) => {
                write!(f, "{b} is {probably}of the same class as {a}, but another shape")
            }
            (EvidenceKind::Different, _) => write!(f, "{b} is {probably}another kind of shape than {a}"),
            (EvidenceKind::Copies | EvidenceKind::PartOf, Some(parts)) => self.write_parts(f, parts),
            _ => {
                write!(f, "{b} is {probably}{a}")?;
                self.write_changes(f, " ")
            }
        }
    }
}

impl MatchEvidence {
    /// The numbers that decided.
    #[must_use]
    pub fn reason(&self) -> String {
        let sides = |numbers: Option<[usize; 2]>, what: &str| match numbers {
            Some([a, b]) if a == b => format!("{a} {what} on both sides"),
            Some([a, b]) => format!("{a} and {b} {what}"),
            None => String::new(),
        };
        let vertices = sides(self.vertices, "vertices");
        match (self.kind, self.vertex_gap, self.surface_gap) {
            (EvidenceKind::PartOf, ..) if self.has(Change::Posed) => {
                format!("by the signatures of the component alone; {}", self.verdict.reason())
            }
            (EvidenceKind::IdenticalFile, ..) => match self.content[0] {
                Some(hash) => format!("the files have the same SHA-256 hash, {}...", &hash.to_string()[..12]),
                None => "the files have the same hash".to_owned(),
            },
            (_, Some(gap), _) => {
                let faces = if self.has(Change::Remeshed) { "other faces" } else { "the same faces" };
                format!("{vertices}, at most {gap:.1e} of the size apart once aligned in space; {faces}")
            }
            (EvidenceKind::Copies | EvidenceKind::PartOf, None, None) if !self.has(Change::Posed) => {
                "the components have the same vertices once aligned in space".to_owned()
            }
            (
                EvidenceKind::Copies | EvidenceKind::PartOf | EvidenceKind::Noisy | EvidenceKind::Remeshed,
                None,
                Some(gap),
            ) => {
                format!("the surfaces are {} once aligned in space; {vertices}", apart(gap))
            }
            (_, None, Some(gap)) => {
                format!("the surfaces are {} once aligned in space; {}", apart(gap), self.verdict.reason())
            }
            (_, None, None) if self.basis == Basis::Descriptions => {
                format!("{}; the mesh was not compared", self.verdict.reason())
            }
            (_, None, None) => {
                format!("the surfaces differ too much in space to be aligned; {}", self.verdict.reason())
            }
        }
    }

    /// The changes, the first after `start`, which is left out if there are none.
    fn write_changes(&self, f: &mut Formatter<'_>, start: &str) -> fmt::Result {
        let mut separator = start;
        for change in &self.changes {
            f.write_str(separator)?;
            separator = ", ";
            let vertices = self.vertices.unwrap_or([1, 1]).map(|n| n.max(1) as f64);
            let share = vertices[1] / vertices[0];
            match change {
                Change::Moved => f.write_str("moved")?,
                Change::Rotated => write!(f, "rotated by {:.1}°", self.rotation.unwrap_or_default())?,
                Change::Scaled => self.write_scale(f)?,
                Change::Mirrored => f.write_str("mirrored")?,
                Change::Decimated => write!(f, "decimated to {} of the vertices", percent(share))?,
                Change::Subdivided => write!(f, "subdivided to {share:.1} times the vertices")?,
                Change::Remeshed if self.vertex_gap.is_some() => f.write_str("with other faces")?,
                Change::Remeshed if (share - 1.0).abs() < 0.005 => f.write_str("remeshed")?,
                Change::Remeshed => write!(f, "remeshed with {share:.2} times the vertices")?,
                Change::Posed => f.write_str(self.pose())?,
                Change::Noisy => {
                    let gap = self.surface_gap.map_or(0.0, |gap| gap.rms);
                    write!(f, "with noise of {} of the size", percent(gap))?;
                }
            }
        }
        Ok(())
    }

    /// Without meshes the pose is unknown.
    fn pose(&self) -> &'static str {
        match self.basis {
            Basis::Descriptions => "in this or another pose",
            Basis::Files | Basis::Meshes => "in another pose",
        }
    }

    fn write_scale(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "scaled by {}", significant(self.scale))?;
        match self.units {
            Some(units) => write!(f, " ({units})"),
            None => Ok(()),
        }
    }

    fn write_parts(&self, f: &mut Formatter<'_>, parts: Parts) -> fmt::Result {
        let [a, b] = &self.names;
        let (part, whole) = if parts.whole == Side::Second { (a, b) } else { (b, a) };
        let Parts { found, components, .. } = parts;
        match (self.kind, found) {
            (EvidenceKind::Copies, _) => write!(f, "{whole} is {} copies of {part}", in_words(found))?,
            (_, 1) => write!(f, "{part} is part of {whole}, one of its {} components", in_words(components))?,
            _ => write!(
                f,
                "{whole} has {} copies of {part} among its {} components",
                in_words(found),
                in_words(components)
            )?,
        }
        if self.has(Change::Scaled) {
            // From the first to the second, whichever is the whole.
            f.write_str(", ")?;
            self.write_scale(f)?;
        }
        if self.has(Change::Mirrored) {
            f.write_str(", mirrored")?;
        }
        if self.has(Change::Remeshed) {
            f.write_str(", remeshed")?;
        }
        match self.has(Change::Posed) {
            true => write!(f, ", {}", self.pose()),
            false => Ok(()),
        }
    }
}

fn apart(gap: SurfaceGap) -> String {
    format!("{} of the size apart (root mean square; at most {})", percent(gap.rms), percent(gap.max))
}

/// A share in percent, with two significant digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        p if p >= 10.0 => format!("{p:.0} %"),
        p if p >= 1.0 => format!("{p:.1} %"),
        p if p >= 0.01 => format!("{p:.2} %"),
        p => format!("{p:.1e} %"),
    }
}

/// A number with five significant digits and no zeros at the end.
fn significant(x: f64) -> String {
    let digits = (4.0 - x.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{x:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

fn in_words(n: usize) -> String {
    const WORDS: [&str; 13] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven",
        "twelve",
    ];
    WORDS.get(n).map_or_else(|| n.to_string(), |word| (*word).to_owned())
}

/// Evidence with its words, as it is written. The verdict is written beside it.
#[derive(Serialize)]
struct EvidenceRecord<'a> {
    kind: EvidenceKind,
    confidence: f64,
    text: String,
    reason: String,
    changes: &'a [Change],
    scale: f64,
    units: Option<UnitChange>,
    basis: Basis,
    content: [Option<String>; 2],
    vertices: Option<[usize; 2]>,
    faces: Option<[usize; 2]>,
    components: Option<[usize; 2]>,
    rotation: Option<f64>,
    vertex_gap: Option<f64>,
    surface_gap: Option<SurfaceGap>,
    parts: Option<Parts>,
}

impl Serialize for MatchEvidence {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        let record = EvidenceRecord {
            kind: self.kind,
            confidence: self.confidence,
            text: self.to_string(),
            reason: self.reason(),
            changes: &self.changes,
            scale: self.scale,
            units: self.units,
            basis: self.basis,
            content: self.content.map(|content| content.map(|hash: ContentHash| hash.to_string())),
            vertices: self.vertices,
            faces: self.faces,
            components: self.components,
            rotation: self.rotation,
            vertex_gap: self.vertex_gap,
            surface_gap: self.surface_gap,
            parts: self.parts,
        };
        record.serialize(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown = [25.4, 1000.0, 0.001, 1.0 / 25.4, 2.0 / 3.0, 123_456.7].map(significant);
        assert_eq!(shown, ["25.4", "1000", "0.001", "0.03937", "0.66667", "123457"]);
        assert_eq!([0.5, 0.0312, 0.0025].map(percent), ["50 %", "3.1 %", "0.25 %"]);
        assert_eq!([0, 6, 13].map(in_words), ["no", "six", "13"]);
    }
}
