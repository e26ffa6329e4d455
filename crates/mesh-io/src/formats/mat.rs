//! MATLAB 5 files with a surface in the layout of TOSCA: a struct with the fields `X Y Z TRIV`.
//!
//! A header of 128 bytes is followed by tagged elements, compressed or not.

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::prelude::*;

const HEADER: usize = 128;

/// The fields of the struct.
const FIELDS: [&str; 4] = ["X", "Y", "Z", "TRIV"];

/// Types of elements, and classes of matrices.
const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
const STRUCT_CLASS: u32 = 2;
const NUMERIC_CLASSES: std::ops::RangeInclusive<u32> = 6..=15;

/// Limits of the decompressed size, per byte of the file and for small files. Meshes compress by a factor of
/// three to ten; deflate can reach a thousand.
const INFLATION: u64 = 32;
const SMALL_FILE: u64 = 16 << 20;

/// The most variables that a message lists.
const MAX_NAMED: usize = 8;

/// Checks the header.
pub(super) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    parse_header(start).map(drop)
}

fn parse_header(bytes: &[u8]) -> Result<ByteOrder, Located> {
    let wrong = |found: &str| Err(Fault::wrong_format("a MATLAB 5 file", found).whole());
    if bytes.starts_with(b"MATLAB 7.3") || bytes.starts_with(b"\x89HDF") {
        return Err(Fault::unsupported("this is a MATLAB 7.3 file", "save it with `save -v7`").whole());
    }
    match bytes.get(124..HEADER) {
        Some([_, 1, b'I', b'M']) => Ok(ByteOrder::Little),
        Some([1, _, b'M', b'I']) => Ok(ByteOrder::Big),
        Some(_) => wrong("its header lacks the version and byte order"),
        None => wrong("it is shorter than the header"),
    }
}

/// Reads the first struct in the file with the numeric fields `X`, `Y`, `Z` (one column each) and `TRIV`
/// (three columns, one-based). Other variables and fields are ignored.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let bytes = files[0];
    let order = parse_header(bytes)?;
    let limit = SMALL_FILE + INFLATION * bytes.len() as u64;
    let mut file = Elements::new(bytes, HEADER, order, cut_short());
    let mut seen = Vec::new();
    while !file.bytes.rest.is_empty() {
        let start = file.bytes.at;
        file.start = start;
        let Tag { mut kind, length, .. } = file.tag()?;
        let begin = start + 8;
        let found = file.bytes.rest.len() as u64;
        let data = file.bytes.take(length as usize).ok_or_else(|| {
            Fault::truncated("bytes of a variable", u64::from(length), found).at_byte(start)
        })?;
        let mut content = Vec::new();
        let mut variable = Elements::new(data, 0, order, cut_short());
        if kind == COMPRESSED {
            let read = ZlibDecoder::new(data).take(limit).read_to_end(&mut content);
            let end = match read {
                Err(e) if e.kind() != io::ErrorKind::UnexpectedEof => Fault::syntax("compressed data", e),
                _ if content.len() as u64 == limit => Fault::decompression_bomb(limit),
                _ => cut_short(),
            };
            variable = Elements::new(&content, 0, order, end);
            variable.start = begin;
            kind = variable.tag()?.kind;
        }
        variable.start = begin;
        if kind == MATRIX
            && let Some(fields) = surface(&mut variable, &mut seen, limits)?
        {
            return mesh_of(fields, begin, limits);
        }
    }
    let seen = match seen.split_at_checked(MAX_NAMED) {
        _ if seen.is_empty() => "none".to_owned(),
        Some((named, more @ [_, ..])) => format!("{} and {} more", named.join(", "), more.len()),
        _ => seen.join(", "),
    };
    let what = format!("the file has no struct with the fields X Y Z TRIV (its variables: {seen})");
    Err(Fault::unsupported(what, "save one, as `surface.X = ...; save(file, 'surface', '-v7')`").whole())
}

/// The fault of data that ends too early.
fn cut_short() -> Fault {
    Fault::cut_short("the rest of an element")
}

/// Type and length in bytes of an element.
#[derive(Debug, Clone, Copy)]
struct Tag<'a> {
    kind: u32,
    length: u32,
    /// Up to four bytes of data are stored in the tag itself.
    inline: Option<&'a [u8]>,
}

/// A sequence of elements.
struct Elements<'a> {
    bytes: Bytes<'a>,
    /// Byte of the file at which the sequence begins, for messages.
    start: usize,
    /// Why there is no more.
    end: Fault,
}

impl<'a> Elements<'a> {
    fn new(bytes: &'a [u8], start: usize, order: ByteOrder, end: Fault) -> Self {
        Self { bytes: Bytes::new(bytes, start, order), start, end }
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], Located> {
        self.bytes.take(length).ok_or_else(|| self.end.clone().at_byte(self.start))
    }

    /// A 32-bit word; zero if there is none.
    fn word(&self, data: &[u8]) -> u32 {
        Bytes::new(data, 0, self.bytes.order).u32().unwrap_or(0)
    }

    /// Reads the next tag.
    fn tag(&mut self) -> Result<Tag<'a>, Located> {
        let (first, second) = self.take(8)?.split_at(4);
        let kind = self.word(first);
        Ok(match kind >> 16 {
            0 => Tag { kind, length: self.word(second), inline: None },
            length => Tag { kind: kind & 0xffff, length, inline: Some(second) },
        })
    }

    /// Reads the data of an element and skips the padding after it.
    fn data(&mut self, tag: Tag<'a>) -> Result<&'a [u8], Located> {
        let length = tag.length as usize;
        if let Some(word) = tag.inline {
            return word.get(..length).ok_or_else(|| self.broken("a short element of 4 bytes at most"));
        }
        let data = self.take(length)?;
        self.take(length.wrapping_neg() % 8)?;
        Ok(data)
    }

    /// Reads the data of an element of a given kind.
    fn expect(&mut self, kind: u32, what: &'static str) -> Result<&'a [u8], Located> {
        match self.tag()? {
            tag if tag.kind == kind => self.data(tag),
            _ => Err(self.broken(what)),
        }
    }

    /// The fault that `expected` is missing here.
    fn broken(&self, expected: &'static str) -> Located {
        Fault::syntax(expected, "other data").at_byte(self.start)
    }

    /// The beginning of every matrix: its class, dimensions and name.
    fn matrix_head(&mut self) -> Result<(u32, Vec<u32>, &'a [u8]), Located> {
        let flags = self.expect(UINT32, "the flags of a matrix")?;
        let class = self.word(flags) & 0xff;
        let dimensions = self.expect(INT32, "the dimensions of a matrix")?;
        let dimensions = dimensions.as_chunks::<4>().0.iter().map(|word| self.word(word)).collect();
        Ok((class, dimensions, self.expect(INT8, "the name of a matrix")?))
    }
}

/// A numeric matrix, column by column.
struct Matrix {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

/// Those of the fields of a surface that are there.
type Fields = [Option<Matrix>; 4];

/// The fields of a variable that is a surface. The name of any other is added to those seen.
fn surface(
    elements: &mut Elements<'_>,
    seen: &mut Vec<String>,
    limits: &ReadLimits,
) -> Result<Option<Fields>, Located> {
    let (class, dimensions, name) = elements.matrix_head()?;
    let mut names = Vec::new();
    if class == STRUCT_CLASS && dimensions.iter().all(|&n| n == 1) {
        let length = elements.expect(INT32, "the length of field names")?;
        let length = elements.word(length).max(1) as usize;
        let trimmed = |name: &'_ [u8]| name.split(|&b| b == 0).next().unwrap_or_default().to_vec();
        names = elements.expect(INT8, "the names of the fields")?.chunks(length).map(trimmed).collect();
    }
    if !FIELDS.iter().all(|field| names.iter().any(|name| name == field.as_bytes())) {
        seen.push(excerpt(name));
        return Ok(None);
    }
    let mut fields = Fields::default();
    for name in names {
        let tag = elements.tag()?;
        match FIELDS.iter().position(|field| name == field.as_bytes()) {
            Some(i) if tag.kind == MATRIX => fields[i] = Some(Matrix::parse(elements, limits)?),
            Some(_) => return Err(elements.broken("a matrix in each field of the surface")),
            None => drop(elements.data(tag)?),
        }
    }
    Ok(Some(fields))
}

impl Matrix {
    /// Checks the number of entries, then reads them.
    fn parse(elements: &mut Elements<'_>, limits: &ReadLimits) -> Result<Self, Located> {
        let (class, dimensions, _) = elements.matrix_head()?;
        if !NUMERIC_CLASSES.contains(&class) {
            return Err(elements.broken("a full matrix of numbers in the fields X Y Z TRIV"));
        }
        let [rows, columns] = *dimensions else {
            return Err(elements.broken("matrices of two dimensions in the fields X Y Z TRIV"));
        };
        let tag = elements.tag()?;
        let scalar = scalar(tag.kind).ok_or_else(|| elements.broken("numbers in the fields X Y Z TRIV"))?;
        let promised = u64::from(rows) * u64::from(columns);
        let found = u64::from(tag.length) / scalar.size() as u64;
        if promised != found {
            return Err(Fault::truncated("numbers of a matrix", promised, found).at_byte(elements.start));
        }
        // TRIV has one row per face; X, Y and Z have one row or one column.
        let (n_vertices, n_faces) = if columns == 3 { (0, u64::from(rows)) } else { (promised, 0) };
        limits.check(n_vertices, n_faces).at_byte(elements.start)?;
        let mut data = Bytes::new(elements.data(tag)?, 0, elements.bytes.order);
        let values = std::iter::from_fn(|| data.number(scalar)).collect();
        Ok(Self { rows: rows as usize, columns: columns as usize, values })
    }
}

/// The type behind the number of a numeric element; `None` for any other element.
fn scalar(kind: u32) -> Option<Scalar> {
    use Scalar::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    let numbered =
        [(1, I8), (2, U8), (3, I16), (4, U16), (5, I32), (6, U32), (7, F32), (9, F64), (12, I64), (13, U64)];
    numbered.into_iter().find(|(number, _)| *number == kind).map(|(_, scalar)| scalar)
}

fn mesh_of(fields: Fields, at: usize, limits: &ReadLimits) -> Result<MeshFile, Located> {
    let syntax = |expected, found: String| Err(Fault::syntax(expected, found).at_byte(at));
    let [Some(x), Some(y), Some(z), Some(triv)] = fields else {
        return syntax("a matrix in each of the fields X Y Z TRIV", "an empty field".into());
    };
    let n = x.values.len();
    if [&x, &y, &z].iter().any(|m| m.values.len() != n || m.rows.min(m.columns) > 1) {
        let found = [x, y, z].map(|m| format!("{} x {}", m.rows, m.columns)).join(", ");
        return syntax("columns X Y Z of equal length", found);
    }
    if triv.columns != 3 && !triv.values.is_empty() {
        return syntax("three columns in TRIV", format!("{} x {}", triv.rows, triv.columns));
    }
    limits.check(n as u64, triv.rows as u64).at_byte(at)?;
    let vertex = |value: f64| match value.fract() == 0.0 && (1.0..=n as f64).contains(&value) {
        true => Ok(VertexId(value as u32 - 1)),
        false => Err(Fault::no_vertex(value, 1, n as u64).at_byte(at)),
    };
    let mut mesh = TriMesh::default();
    for i in 0..n {
        mesh.positions.push(finite([&x, &y, &z].map(|m| m.values[i]), i + 1).at_byte(at)?);
    }
    for face in 0..triv.values.len() / 3 {
        let corner = |slot: usize| vertex(triv.values[slot * triv.rows + face]);
        mesh.faces.push([corner(0)?, corner(1)?, corner(2)?]);
    }
    finish(mesh, limits)
}
