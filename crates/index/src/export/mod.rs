//! Export of an index as files that do not depend on its history.

mod columns;
mod csv;
mod npz;
mod parquet;
#[cfg(test)]
mod tests;

use std::fs::File;
use std::io::{self, BufWriter, Write};

use base::object;
use serde::Serialize;

use crate::Index;

pub use csv::{csv_field, text_cell};

/// A file format for an index; [`Index::export_as`] writes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportFormat {
    /// Everything, as lines of JSON; see [`Index::export`].
    JsonLines,
    /// Everything, a row for every shape.
    ///
    /// Columns: `id`, `label`, `path` and `content` (text); `fact_NAME` (double); `fused` and
    /// `signature_NAME` (lists of float, null if a shape lacks it); `form` (a list of float: x, y, z and weight of each
    /// point); `disc_areas` and `components` (lists of float, one component after the other), if any shape has them. The
    /// metadata of the file has `canonform.options`.
    Parquet,
    /// Everything, an array for every column: text for `id`, `label`, `path` and `content`, which are n long; float64 for
    /// `fact_NAME`; float32 for `fused`, `signature_NAME` and `disc_areas`, which are n x length, for `form`, n x points x
    /// 4, and for `components`, n x components x length. NaN stands for what a shape lacks. `options` is a text.
    Npz,
    /// Comma-separated values without the signatures and the form: `id`, `label`, `path`, `content`, `fact_NAME` and
    /// `fused_0`, `fused_1`, ...
    Csv,
}

impl ExportFormat {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::JsonLines, Self::Parquet, Self::Npz, Self::Csv];

    /// The extension of its files.
    pub fn extension(self) -> &'static str {
        match self {
            Self::JsonLines => "jsonl",
            Self::Parquet => "parquet",
            Self::Npz => "npz",
            Self::Csv => "csv",
        }
    }

    /// The format of files with this extension.
    pub fn named(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.extension() == extension)
    }
}

impl Index {
    /// Writes the index into a file. Rows are in ascending order of names, and equal indexes give equal bytes.
    ///
    /// # Errors
    /// If the file cannot be written. An [`IndexError`](crate::IndexError) is within the error if the index cannot be read.
    pub fn export_as(&self, format: ExportFormat, file: &mut File) -> io::Result<()> {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        match format {
            ExportFormat::Parquet => parquet::write(self, out.get_mut())?,
            ExportFormat::Npz => npz::write(self, out.get_mut())?,
            ExportFormat::Csv => csv::write(self, &mut out)?,
            ExportFormat::JsonLines => self.export(&mut out)?,
        }
        out.flush()
    }

    /// Writes the index as lines of JSON: first a header, then one line per shape in ascending order of names. Numbers
    /// read back bit for bit.
    ///
    /// Equal indexes give equal bytes, whether they were built at once, after interruptions, or merged from parts.
    ///
    /// # Errors
    /// As of [`export_as`](Self::export_as).
    pub fn export(&self, out: &mut dyn Write) -> io::Result<()> {
        let (options, shapes) = (&self.options, self.len());
        write_line(out, &object! { format: "canonform-index", version: 3, options, shapes })?;
        self.each(|shape| write_line(out, &shape))
    }
}

fn write_line(out: &mut dyn Write, value: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut *out, value)?;
    out.write_all(b"\n")
}
