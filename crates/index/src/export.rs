//! Export of an index as text that does not depend on its history.

use std::io::{self, Write};

use serde::{Serialize, Serializer};

use crate::{Index, IndexError, Shape};

/// The first line of an export.
#[derive(Serialize)]
struct Head<'a> {
    format: &'static str,
    version: u32,
    options: &'a str,
    shapes: usize,
}

/// Each further line.
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

/// Pairs serialised as an object, in order.
struct Named<'a, T>(&'a [(String, T)]);

impl<T: Serialize> Serialize for Named<'_, T> {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        out.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// Errors of an export.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The index cannot be read.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// The text cannot be written.
    #[error("cannot write the export: {0}")]
    Write(#[from] io::Error),
}

impl Index {
    /// Writes the index as lines of JSON: first a header, then one line per shape in ascending order of names. Numbers
    /// read back bit for bit.
    ///
    /// Equal indexes give equal bytes, whether they were built at once, after interruptions, or merged from parts.
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
