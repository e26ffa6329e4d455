//! NumPy arrays in a zip archive.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Write};

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::columns::{Kind, Value, columns};
use super::error::ExportError;
use crate::Index;
use crate::database::to_bytes;

pub(super) fn write(index: &Index, file: &mut File) -> Result<(), ExportError> {
    let mut archive = Archive { zip: ZipWriter::new(BufWriter::with_capacity(1 << 16, file)) };
    let (n, options) = (index.len(), &index.options);
    let longest = options.chars().count().max(1);
    archive.begin("options", &format!("<U{longest}"), &[], 4 * longest)?;
    archive.put(&text(options, longest))?;
    for column in columns(index)? {
        let longest = column.extents.first().map_or(1, |n| *n).max(1);
        let (kind, item) = match column.kind {
            Kind::Text => (format!("<U{longest}"), 4 * longest),
            Kind::Fact => ("<f8".to_owned(), 8),
            Kind::Floats => ("<f4".to_owned(), 4),
        };
        let extents = if let Kind::Floats = column.kind { &column.extents[..] } else { &[] };
        archive.begin(&column.name, &kind, &[&[n], extents].concat(), item)?;
        index.each(|shape| {
            let value = column.value(&shape).unwrap_or(Value::Floats(Cow::default(), Vec::new()));
            archive.put(&match value {
                Value::Text(value) => text(&value, longest),
                Value::Fact(value) => value.to_le_bytes().to_vec(),
                Value::Floats(values, _) => {
                    let mut values = values.into_owned();
                    values.resize(extents.iter().product(), f32::NAN);
                    to_bytes(&values)
                }
            })
        })?;
    }
    let mut out = archive.zip.finish().map_err(failed)?;
    Ok(out.flush()?)
}

/// A text as so many UTF-32 characters, zeros at the end.
fn text(text: &str, longest: usize) -> Vec<u8> {
    let characters = text.chars().map(u32::from).chain(std::iter::repeat(0));
    characters.take(longest).flat_map(u32::to_le_bytes).collect()
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
}

fn failed(error: ZipError) -> ExportError {
    ExportError::Write(io::Error::from(error))
}
