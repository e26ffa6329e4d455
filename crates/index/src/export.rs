//! An index as text that does not depend on how it came about.

use std::io::{self, Write};

use serde::{Serialize, Serializer};

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
    facts: Named<'a, f64>,
    fused: &'a [f32],
    signatures: Named<'a, Vec<f32>>,
    form: &'a [[f32; 4]],
}

/// Pairs as an object, in their order.
struct Named<'a, T>(&'a [(String, T)]);

impl<T: Serialize> Serialize for Named<'_, T> {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        out.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
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
    Line {
        id,
        label: &entry.label,
        path: &entry.path,
        content: entry.content.to_string(),
        facts: Named(&entry.facts),
        fused: &vectors.fused,
        signatures: Named(&vectors.signatures),
        form: &vectors.form,
    }
}

fn write_line(out: &mut dyn Write, value: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut *out, value)?;
    out.write_all(b"\n")
}
