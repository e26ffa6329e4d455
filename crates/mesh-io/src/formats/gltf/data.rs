//! The data of a glTF file: chunks of GLB, buffers in data URIs and other files, and typed arrays of numbers in them.

use std::borrow::Cow;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::schema::{Accessor, Asset, Index, Root, Sparse, Stated};
use crate::name::referred;
use crate::prelude::*;

const MAGIC: &[u8] = b"glTF";
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// Checks that a file is text that begins like JSON.
pub(crate) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    check_is_not_utf16(start)?;
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
    match text.first() {
        None | Some(b'{') => check_is_text(start, "a glTF file"),
        Some(_) if start.starts_with(MAGIC) => {
            let found = "it begins like a binary one, whose extension is .glb";
            Err(Fault::wrong_format("a glTF file as text", found).whole())
        }
        Some(_) => Err(other_format("a glTF file", text).whole()),
    }
}

/// Checks the header of a GLB file, and that the file has the length it states.
pub(crate) fn check_binary_start(start: &[u8], size: Option<u64>) -> Result<(), Located> {
    stated_length(start, size).map(drop)
}

fn stated_length(start: &[u8], size: Option<u64>) -> Result<u64, Located> {
    if !start.starts_with(MAGIC) {
        return Err(other_format("a GLB file", start).whole());
    }
    let mut words = Bytes::new(start, MAGIC.len(), ByteOrder::Little);
    let (Some(version), Some(length)) = (words.u32(), words.u32().map(u64::from)) else {
        return Err(Fault::cut_short("the header").at_byte(start.len()));
    };
    if version != 2 {
        let what = format!("this is version {version} of GLB");
        return Err(Fault::unsupported(what, "export it as glTF 2.0").at_byte(4));
    }
    if length < (HEADER + CHUNK_HEADER) as u64 {
        let found = format!("{length} bytes in the header");
        return Err(Fault::syntax("the length of a GLB file, which is not empty", found).at_byte(8));
    }
    match size.filter(|size| *size < length) {
        Some(size) => Err(Fault::truncated("bytes", length, size).at_byte(8)),
        None => Ok(length),
    }
}

/// The description of a scene, and the binary chunk if there is one, of a GLB file or a text.
pub(super) fn open(bytes: &[u8]) -> Result<(Root, Option<&[u8]>), Located> {
    let (mut json, mut binary) = (bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None);
    let is_text = !bytes.starts_with(MAGIC);
    if !is_text {
        let length = stated_length(bytes, Some(bytes.len() as u64))?;
        // Bytes after the stated length belong to nobody.
        let mut chunks = Bytes::new(&bytes[..length as usize], HEADER, ByteOrder::Little);
        let Some((b"JSON", first)) = chunk(&mut chunks)? else {
            return Err(Fault::cut_short("the JSON chunk").at_byte(HEADER));
        };
        json = first;
        while binary.is_none()
            && let Some((kind, data)) = chunk(&mut chunks)?
        {
            binary = Some(data).filter(|_| kind == b"BIN\0");
        }
    }
    let unreadable = |error| {
        let fault = Fault::syntax("the JSON of glTF 2.0", there(json, &error));
        if is_text { fault.in_line(error.line()) } else { fault.at_byte(HEADER + CHUNK_HEADER) }
    };
    // Other versions lay out the rest differently, so the version comes first.
    let stated: Stated = serde_json::from_slice(json).map_err(unreadable)?;
    check_version(&stated.asset).whole()?;
    Ok((serde_json::from_slice(json).map_err(unreadable)?, binary))
}

fn check_version(asset: &Asset) -> Result<(), Fault> {
    let version = asset.min_version.as_ref().unwrap_or(&asset.version);
    if version.split('.').next() == Some("2") {
        return Ok(());
    }
    let what = format!("its version of glTF is `{}`", excerpt(version.as_bytes()));
    Err(Fault::unsupported(what, "export it as glTF 2.0"))
}

/// The text around the place in JSON at which it cannot be read.
fn there(json: &[u8], error: &serde_json::Error) -> String {
    let line = json.split(|byte| *byte == b'\n').nth(error.line().saturating_sub(1)).unwrap_or_default();
    let start = error.column().saturating_sub(AROUND).min(line.len());
    let around = &line[start..line.len().min(start + 2 * AROUND)];
    String::from_utf8_lossy(around).trim().to_owned()
}

/// Bytes of JSON before and after a fault that its message shows.
const AROUND: usize = 20;

/// The kind and the data of a chunk. Less than the header of one at the end of the file is padding.
type Chunk<'a> = Option<(&'a [u8], &'a [u8])>;

fn chunk<'a>(bytes: &mut Bytes<'a>) -> Result<Chunk<'a>, Located> {
    let start = bytes.at;
    let (Some(length), Some(kind)) = (bytes.u32(), bytes.take(4)) else { return Ok(None) };
    let found = bytes.rest.len() as u64;
    match bytes.take(length as usize) {
        Some(data) => Ok(Some((kind, data))),
        None => Err(Fault::truncated("bytes of a chunk", u64::from(length), found).at_byte(start)),
    }
}

/// Names of the other files that hold buffers, each once, in the order of the buffers.
pub(super) fn companions_of(root: &Root) -> Result<Vec<String>, Located> {
    let mut names = Vec::new();
    for (number, buffer) in root.buffers.iter().enumerate() {
        if let Some(uri) = buffer.uri.as_deref().filter(|uri| !is_data(uri)) {
            let name = local_name(uri).in_part("buffer", number)?;
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    Ok(names)
}

fn is_data(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// The name of a file below the folder of the glTF file.
fn local_name(uri: &str) -> Result<String, Fault> {
    let is_strange = |c: char| c.is_control() || matches!(c, '\\' | ':');
    let is_part = |part: &str| !matches!(part, "" | "..");
    let is_local = |name: &String| !name.contains(is_strange) && name.split('/').all(is_part);
    referred(uri).filter(is_local).ok_or_else(|| {
        Fault::unsupported(
            format!("its data is in `{}`, which is not a file in its own folder", excerpt(uri.as_bytes())),
            "put both files into one folder and name the data by its file name, or export a .glb file",
        )
    })
}

/// The data in a data URI.
fn decoded(uri: &str) -> Result<Vec<u8>, Fault> {
    let wrong = |found: String| Fault::syntax("a data URI in base64", found);
    let (head, data) = uri.split_once(',').ok_or_else(|| wrong(excerpt(uri.as_bytes())))?;
    if !head.to_ascii_lowercase().ends_with(";base64") {
        return Err(wrong(excerpt(head.as_bytes())));
    }
    STANDARD.decode(data.trim()).map_err(|fault| wrong(fault.to_string()))
}

/// A part of the file that another refers to.
pub(super) fn part<'a, T>(parts: &'a [T], kind: &'static str, number: Index) -> Result<&'a T, Located> {
    parts.get(number).ok_or_else(|| {
        let found = format!("{kind} {number} of {}", parts.len());
        Fault::syntax("the number of a part that exists", found).whole()
    })
}

/// The accessors of a file and what they read from.
pub(super) struct Data<'a> {
    pub(super) root: &'a Root,
    buffers: Vec<Option<Cow<'a, [u8]>>>,
    /// Bytes of all files.
    pub(super) n_bytes: u64,
}

impl<'a> Data<'a> {
    /// Finds the buffers in the binary chunk, in data URIs and in the files, which are the glTF file and its
    /// companions.
    pub(super) fn new(root: &'a Root, chunk: Option<&'a [u8]>, files: &[&'a [u8]]) -> Result<Self, Located> {
        let names = companions_of(root)?;
        let mut buffers = Vec::with_capacity(root.buffers.len());
        for (number, buffer) in root.buffers.iter().enumerate() {
            buffers.push(match buffer.uri.as_deref() {
                None => chunk.filter(|_| number == 0).map(Cow::from),
                Some(uri) if is_data(uri) => Some(decoded(uri).in_part("buffer", number)?.into()),
                Some(uri) => {
                    let name = local_name(uri).in_part("buffer", number)?;
                    let place = names.iter().position(|known| *known == name);
                    place.and_then(|place| files.get(place + 1)).map(|file| Cow::from(*file))
                }
            });
        }
        Ok(Self { root, buffers, n_bytes: files.iter().map(|file| file.len() as u64).sum() })
    }

    /// The number of rows of an accessor.
    pub(super) fn len(&self, accessor: Index) -> Result<u64, Located> {
        Ok(part(&self.root.accessors, "accessor", accessor)?.count)
    }

    /// Positions; integers that are normalized are fractions of their largest value.
    pub(super) fn positions(&self, index: Index) -> Result<Vec<Point3<f64>>, Located> {
        let (accessor, scalar, numbers) = self.numbers(index, ("VEC3", 3), "positions of type VEC3")?;
        let n_bits = 8 * scalar.size() as i32 - i32::from(matches!(scalar, Scalar::I8 | Scalar::I16));
        let unit = if scalar.is_integer() { 2f64.powi(n_bits) - 1.0 } else { 1.0 };
        // The most negative integer stands for -1 too.
        let scaled = |x: f64| if accessor.normalized { (x / unit).max(-1.0) } else { x };
        let rows = numbers.as_chunks::<3>().0.iter().enumerate();
        rows.map(|(vertex, row)| finite(row.map(scaled), vertex).in_part("accessor", index)).collect()
    }

    /// Vertex numbers, less than `n_vertices`.
    pub(super) fn indices(&self, index: Index, n_vertices: usize) -> Result<Vec<u32>, Located> {
        let (_, scalar, numbers) = self.numbers(index, ("SCALAR", 1), "indices of type SCALAR")?;
        let fault = match numbers.iter().find(|x| **x >= n_vertices as f64) {
            _ if !matches!(scalar, Scalar::U8 | Scalar::U16 | Scalar::U32) => {
                Fault::syntax("indices that are unsigned integers", format!("{scalar:?}"))
            }
            Some(number) => Fault::no_vertex(number, 0, n_vertices as u64),
            None => return Ok(numbers.into_iter().map(|x| x as u32).collect()),
        };
        Err(fault.in_part("accessor", index))
    }

    /// An accessor with rows of a kind and width, the type of its numbers, and all of them row by row.
    fn numbers(
        &self,
        index: Index,
        (kind, width): (&str, usize),
        expected: &'static str,
    ) -> Result<(&Accessor, Scalar, Vec<f64>), Located> {
        let accessor = part(&self.root.accessors, "accessor", index)?;
        let at = |fault: Fault| fault.in_part("accessor", index);
        let Some(scalar) = scalar(accessor.component_type).filter(|_| accessor.kind == kind) else {
            return Err(at(Fault::syntax(expected, "another type")));
        };
        let count = accessor.count;
        let mut numbers = match accessor.buffer_view {
            Some(view) => {
                self.rows(view, accessor.byte_offset.unwrap_or(0), count, (scalar, width), true, at)?
            }
            None if accessor.sparse.is_none() => {
                return Err(at(Fault::unsupported(
                    "its numbers are not in the file, as in compressed meshes",
                    "decompress it, for example with `gltf-transform copy in.glb out.glb`",
                )));
            }
            None if count > self.n_bytes => return Err(at(Fault::decompression_bomb(self.n_bytes))),
            None => vec![0.0; count as usize * width],
        };
        let Some(Sparse { indices, values, count: n }) = &accessor.sparse else {
            return Ok((accessor, scalar, numbers));
        };
        let places = self::scalar(indices.component_type)
            .ok_or_else(|| at(Fault::syntax("indices that are unsigned integers", "another type")))?;
        let places =
            self.rows(indices.rows.buffer_view, indices.rows.byte_offset, *n, (places, 1), false, at)?;
        let values = self.rows(values.buffer_view, values.byte_offset, *n, (scalar, width), false, at)?;
        for (place, row) in places.iter().zip(values.chunks_exact(width)) {
            let slot = numbers.chunks_exact_mut(width).nth(*place as usize).filter(|_| *place >= 0.0);
            slot.ok_or_else(|| at(Fault::no_vertex(place, 0, count)))?.copy_from_slice(row);
        }
        Ok((accessor, scalar, numbers))
    }

    /// Rows of a buffer view; `at` places a fault.
    fn rows(
        &self,
        view: Index,
        offset: u64,
        count: u64,
        (scalar, width): (Scalar, usize),
        is_strided: bool,
        at: impl Fn(Fault) -> Located,
    ) -> Result<Vec<f64>, Located> {
        let (bytes, stride) = self.view(view)?;
        let row = scalar.size() * width;
        let stride = stride.filter(|_| is_strided).unwrap_or(row);
        if stride < row {
            return Err(at(Fault::syntax("a stride no shorter than a row", format!("{stride} bytes"))));
        }
        let to_last = count.saturating_sub(1).checked_mul(stride as u64).and_then(|n| n.checked_add(offset));
        let needed = to_last.and_then(|n| n.checked_add(if count == 0 { 0 } else { row as u64 }));
        if needed.is_none_or(|needed| needed > bytes.len() as u64) {
            let found = (bytes.len() as u64).saturating_sub(offset) / stride as u64;
            return Err(at(Fault::truncated("rows", count, found)));
        }
        let mut numbers = Vec::with_capacity(count as usize * width);
        for i in 0..count as usize {
            let row = bytes[offset as usize + i * stride..][..row].chunks_exact(scalar.size());
            numbers.extend(row.filter_map(|number| scalar.decode(ByteOrder::Little, number)));
        }
        Ok(numbers)
    }

    /// The bytes of a view and its stride.
    fn view(&self, index: Index) -> Result<(&[u8], Option<usize>), Located> {
        let view = part(&self.root.buffer_views, "buffer view", index)?;
        let buffer = view.buffer;
        let bytes = part(&self.buffers, "buffer", buffer)?.as_deref().ok_or_else(|| {
            let what = format!("buffer {buffer} has no data, as in compressed files");
            Fault::unsupported(what, "export it without compression").in_part("buffer view", index)
        })?;
        let start = view.byte_offset.unwrap_or(0);
        let end = start.saturating_add(view.byte_length);
        let data = bytes.get(start as usize..end as usize).ok_or_else(|| {
            let items = format!("bytes in buffer {buffer}");
            Fault::truncated(items, end, bytes.len() as u64).in_part("buffer view", index)
        })?;
        Ok((data, view.byte_stride.filter(|stride| *stride > 0)))
    }
}

/// How numbers of a component type are stored. `None` for a number that is not in the standard.
fn scalar(component_type: u32) -> Option<Scalar> {
    use Scalar::{F32, I8, I16, U8, U16, U32};
    let numbered = [(5120, I8), (5121, U8), (5122, I16), (5123, U16), (5125, U32), (5126, F32)];
    numbered.into_iter().find(|(number, _)| *number == component_type).map(|(_, scalar)| scalar)
}
