//! An index as text that does not depend on how it came about.

use std::io::{self, Write};

use serde::Serialize;

use super::{Index, IndexError, Shape};

/// The first line of an export.
#[derive(Serialize)]
struct Head<'a> {
    format: &'static str,
    version: u32,
    options: &'a str,
    shapes: usize,
}

/// Any other line.
#[derive(Serialize)]
struct Line<'a> {
    id: &'a str,
    label: &'a str,
    path: &'a str,
    content: String,
    facts: serde_json::Map<String, serde_json::Value>,
    fused: &'a [f32],
    signatures: serde_json::Map<String, serde_json::Value>,
    form: &'a [[f32; 3]],
}

/// What stopped an export.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// Reading the index.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// Writing the text.
    #[error("cannot write the export: {0}")]
    Write(#[from] io::Error),
}

impl Index {
    /// Writes the index as lines of JSON: one on the whole, then one a shape in ascending order of names.
    /// Numbers are written in full: they read back bit for bit.
    ///
    /// Equal indexes give equal bytes, whether they were built at once, after interruptions, or in parts
    /// that were merged.
    ///
    /// # Errors
    /// [`ExportError`].
    pub fn export(&self, out: &mut dyn Write) -> Result<(), ExportError> {
        let head =
            Head { format: "canonform-index", version: 1, options: self.options(), shapes: self.len() };
        write_line(out, &head)?;
        self.each(|shape| write_line(out, &line(&shape)).map_err(ExportError::from))
    }
}

fn line(shape: &Shape) -> Line<'_> {
    let Shape { id, entry, vectors } = shape;
    let facts = entry.facts.iter().map(|(name, value)| (name.clone(), (*value).into()));
    let signatures =
        vectors.signatures.iter().map(|(name, values)| (name.clone(), serde_json::json!(values)));
    Line {
        id,
        label: &entry.label,
        path: &entry.path,
        content: entry.content.to_string(),
        facts: facts.collect(),
        fused: &vectors.fused,
        signatures: signatures.collect(),
        form: &vectors.form,
    }
}

fn write_line(out: &mut dyn Write, value: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut *out, value)?;
    out.write_all(b"\n")
}
