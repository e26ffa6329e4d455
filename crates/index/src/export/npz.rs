//! NumPy arrays in a zip archive.

use std::fs::File;
use std::io::{self, BufWriter, Write};

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::columns::{Columns, TEXTS, signature, texts};
use super::error::ExportError;
use crate::{Index, Shape};

pub(super) fn write(index: &Index, file: &mut File) -> Result<(), ExportError> {
    let columns = Columns::of(index)?;
    let mut archive = Archive { zip: ZipWriter::new(BufWriter::with_capacity(1 << 16, file)) };
    let n = columns.n_rows;
    archive.text(
        "options",
        &[],
        std::iter::once(index.options().to_owned()),
        index.options().chars().count(),
    )?;
    for (which, name) in TEXTS.into_iter().enumerate() {
        let mut found = Vec::with_capacity(n);
        index.each(|shape| {
            found.extend(texts(&shape).into_iter().nth(which));
            Ok::<(), ExportError>(())
        })?;
        archive.text(name, &[n], found.into_iter(), columns.longest[which])?;
    }
    for fact in &columns.facts {
        archive.begin(&format!("fact_{fact}"), "<f8", &[n], 8)?;
        index.each(|shape| archive.put(&shape.entry.fact(fact).unwrap_or(f64::NAN).to_le_bytes()))?;
    }
    archive.floats(index, "fused", &[n, columns.fused], |shape: &Shape| shape.vectors.fused.clone())?;
    for (name, length) in &columns.signatures {
        let values = |shape: &Shape| signature(shape, name).unwrap_or_default().to_vec();
        archive.floats(index, &format!("signature_{name}"), &[n, *length], values)?;
    }
    let points = |shape: &Shape| shape.vectors.form.as_flattened().to_vec();
    archive.floats(index, "form", &[n, columns.points, 4], points)?;
    let mut out = archive.zip.finish().map_err(failed)?;
    Ok(out.flush()?)
}

struct Archive<'a> {
    zip: ZipWriter<BufWriter<&'a mut File>>,
}

impl Archive<'_> {
    /// Begins an array in C order.
    fn begin(&mut self, name: &str, kind: &str, shape: &[usize], item: usize) -> Result<(), ExportError> {
        let bytes = shape.iter().product::<usize>().saturating_mul(item);
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(bytes > 1 << 31);
        self.zip.start_file(format!("{name}.npy"), options).map_err(failed)?;
        let extents: String = shape.iter().map(|n| format!("{n},")).collect();
        let mut head = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({extents}), }}");
        // Magic, version, length and the line end make a multiple of 64 bytes.
        while (head.len() + 11) % 64 != 0 {
            head.push(' ');
        }
        head.push('\n');
        self.put(b"\x93NUMPY\x01\x00")?;
        self.put(&(head.len() as u16).to_le_bytes())?;
        self.put(head.as_bytes())
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), ExportError> {
        Ok(self.zip.write_all(bytes)?)
    }

    /// Writes an array of texts, each of `longest` UTF-32 characters, zeros at the end.
    fn text(
        &mut self,
        name: &str,
        shape: &[usize],
        texts: impl Iterator<Item = String>,
        longest: usize,
    ) -> Result<(), ExportError> {
        let longest = longest.max(1);
        self.begin(name, &format!("<U{longest}"), shape, 4 * longest)?;
        for text in texts {
            let characters = text.chars().map(u32::from).chain(std::iter::repeat(0));
            for character in characters.take(longest) {
                self.put(&character.to_le_bytes())?;
            }
        }
        Ok(())
    }

    /// Writes an array of vectors, filled up with NaN.
    fn floats<V: AsRef<[f32]>>(
        &mut self,
        index: &Index,
        name: &str,
        shape: &[usize],
        values: impl Fn(&Shape) -> V,
    ) -> Result<(), ExportError> {
        self.begin(name, "<f4", shape, 4)?;
        let length: usize = shape[1..].iter().product();
        index.each(|row| {
            let found = values(&row);
            let filled = found.as_ref().iter().copied().chain(std::iter::repeat(f32::NAN)).take(length);
            let bytes: Vec<u8> = filled.flat_map(f32::to_le_bytes).collect();
            self.put(&bytes)
        })
    }
}

fn failed(error: ZipError) -> ExportError {
    ExportError::Write(io::Error::from(error))
}
