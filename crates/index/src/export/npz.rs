//! NumPy arrays in a zip archive.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::columns::{Kind, Value, columns};
use crate::Index;
use crate::database::to_bytes;

pub(super) fn write(index: &Index, file: &mut File) -> io::Result<()> {
    let mut zip = ZipWriter::new(BufWriter::with_capacity(1 << 16, file));
    let (n, options) = (index.len(), &index.options);
    let longest = options.chars().count().max(1);
    begin(&mut zip, "options", &format!("<U{longest}"), &[], 4 * longest)?;
    zip.write_all(&text(options, longest))?;
    for column in columns(index)? {
        let longest = column.extents.first().map_or(1, |n| *n).max(1);
        let (kind, item) = match column.kind {
            Kind::Text => (format!("<U{longest}"), 4 * longest),
            Kind::Fact => ("<f8".to_owned(), 8),
            Kind::Floats => ("<f4".to_owned(), 4),
        };
        let extents = if let Kind::Floats = column.kind { &column.extents[..] } else { &[] };
        begin(&mut zip, &column.name, &kind, &[&[n], extents].concat(), item)?;
        index.each(|shape| {
            let value = column.value(&shape).unwrap_or(Value::Floats(Cow::default(), Vec::new()));
            zip.write_all(&match value {
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
    zip.finish()?.flush()
}

/// A text as so many UTF-32 characters, zeros at the end.
fn text(text: &str, longest: usize) -> Vec<u8> {
    let characters = text.chars().map(u32::from).chain(std::iter::repeat(0));
    characters.take(longest).flat_map(u32::to_le_bytes).collect()
}

/// Begins an array in C order.
fn begin(
    zip: &mut ZipWriter<impl Write + Seek>,
    name: &str,
    kind: &str,
    shape: &[usize],
    item: usize,
) -> io::Result<()> {
    let bytes = shape.iter().product::<usize>().saturating_mul(item);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .large_file(bytes > 1 << 31);
    zip.start_file(format!("{name}.npy"), options)?;
    let extents: String = shape.iter().map(|n| format!("{n},")).collect();
    let mut head = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({extents}), }}");
    // Magic, version, length and the line end make a multiple of 64 bytes.
    while (head.len() + 11) % 64 != 0 {
        head.push(' ');
    }
    head.push('\n');
    zip.write_all(b"\x93NUMPY\x01\x00")?;
    zip.write_all(&(head.len() as u16).to_le_bytes())?;
    zip.write_all(head.as_bytes())
}
