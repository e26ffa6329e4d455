//! Which columns a table of shapes has.

use crate::{Index, IndexError, Shape};

/// Columns of the shapes of an index, each in order of first appearance.
#[derive(Debug, Default)]
pub(super) struct Columns {
    pub(super) n_rows: usize,
    /// Length of the fused vector.
    pub(super) fused: usize,
    /// Names of facts.
    pub(super) facts: Vec<String>,
    /// Names and lengths of signatures.
    pub(super) signatures: Vec<(String, usize)>,
    /// The most points of a form.
    pub(super) points: usize,
    /// The most characters of the texts.
    pub(super) longest: [usize; 4],
}

/// Names of the text columns.
pub(super) const TEXTS: [&str; 4] = ["id", "label", "path", "content"];

impl Columns {
    /// Reads all shapes.
    pub(super) fn of(index: &Index) -> Result<Self, IndexError> {
        let mut columns = Self::default();
        index.each(|shape| {
            columns.n_rows += 1;
            columns.fused = columns.fused.max(shape.vectors.fused.len());
            columns.points = columns.points.max(shape.vectors.form.len());
            for (longest, text) in columns.longest.iter_mut().zip(texts(&shape)) {
                *longest = (*longest).max(text.chars().count());
            }
            for (name, _) in &shape.entry.facts {
                if !columns.facts.contains(name) {
                    columns.facts.push(name.clone());
                }
            }
            for (name, values) in &shape.vectors.signatures {
                match columns.signatures.iter_mut().find(|(known, _)| known == name) {
                    Some((_, length)) => *length = (*length).max(values.len()),
                    None => columns.signatures.push((name.clone(), values.len())),
                }
            }
            Ok::<(), IndexError>(())
        })?;
        Ok(columns)
    }
}

/// The texts of a shape.
pub(super) fn texts(shape: &Shape) -> [String; 4] {
    let entry = &shape.entry;
    [shape.id.clone(), entry.label.clone(), entry.path.clone(), entry.content.to_string()]
}

/// The signature of this name.
pub(super) fn signature<'a>(shape: &'a Shape, name: &str) -> Option<&'a [f32]> {
    shape.vectors.signatures.iter().find(|(known, _)| known == name).map(|(_, values)| values.as_slice())
}
