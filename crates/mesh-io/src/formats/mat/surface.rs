//! The surface in a MATLAB file.

use surface::VertexId;

use super::container::{
    COMPRESSED, Elements, HEADER, MATRIX, Tag, cut_short, inflated, parse_header, scalar,
};
use crate::facts::MeshFile;
use crate::limits::ReadLimits;
use crate::located::{At, Located};
use crate::polygons::{finish, finite};
use crate::text::excerpt;
use mesh::Fault;
use mesh::TriMesh;

/// The fields of the struct.
const FIELDS: [&str; 4] = ["X", "Y", "Z", "TRIV"];

/// Types of the elements of a matrix, and classes of matrices.
const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const STRUCT_CLASS: u8 = 2;
const NUMERIC_CLASSES: std::ops::RangeInclusive<u8> = 6..=15;

/// Limits of the decompressed size, per byte of the file and for small files. Meshes compress by a factor of
/// three to ten; deflate can reach a thousand.
const INFLATION: u64 = 32;
const SMALL_FILE: u64 = 16 << 20;

/// The most variables that a message lists.
const NAMED: usize = 8;

/// Checks the header.
pub(crate) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    parse_header(start).map(drop)
}

/// Reads the first struct in the file with the numeric fields `X`, `Y`, `Z` (one column each) and `TRIV`
/// (three columns, one-based). Other variables and fields are ignored.
pub(crate) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let bytes = files[0];
    let order = parse_header(bytes)?;
    let limit = SMALL_FILE + INFLATION * bytes.len() as u64;
    let mut at = HEADER;
    let mut seen = Vec::new();
    while at < bytes.len() {
        let elements = |rest, start, end| Elements { rest, order, start, end };
        let Tag { kind, length, .. } = elements(&bytes[at..], at, cut_short()).tag()?;
        let begin = at + 8;
        let end = begin + length as usize;
        let Some(data) = bytes.get(begin..end) else {
            let found = (bytes.len() - begin) as u64;
            return Err(Fault::truncated("bytes of a variable", u64::from(length), found).at_byte(at));
        };
        let (content, fault);
        let mut variable = elements(data, begin, cut_short());
        let mut kind = kind;
        if kind == COMPRESSED {
            (content, fault) = inflated(data, limit);
            variable = elements(&content, begin, fault);
            kind = variable.tag()?.kind;
        }
        if kind == MATRIX {
            match Variable::parse(variable, limits)? {
                Variable::Surface(fields) => return mesh_of(fields, begin, limits),
                Variable::Other(name) => seen.push(name),
            }
        }
        at = end;
    }
    let seen = match seen.split_at_checked(NAMED) {
        _ if seen.is_empty() => "none".to_owned(),
        Some((named, more @ [_, ..])) => format!("{} and {} more", named.join(", "), more.len()),
        _ => seen.join(", "),
    };
    let what = format!("the file has no struct with the fields X Y Z TRIV (its variables: {seen})");
    Err(Fault::unsupported(what, "save one, as `surface.X = ...; save(file, 'surface', '-v7')`").whole())
}

/// A variable of the file.
enum Variable {
    /// The fields of a surface.
    Surface(Fields),
    /// Anything else: its name.
    Other(String),
}

/// A numeric matrix, column by column.
struct Matrix {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

/// Those of the fields of a surface that are there.
type Fields = [Option<Matrix>; 4];

/// The beginning of every matrix.
struct MatrixHead {
    class: u8,
    dimensions: Vec<u32>,
    name: String,
}

impl MatrixHead {
    fn parse(elements: &mut Elements<'_>) -> Result<Self, Located> {
        let flags = elements.expect(UINT32, "the flags of a matrix")?;
        let class = flags.first_chunk().map_or(0, |&word| (elements.u32(word) & 0xff) as u8);
        let dimensions = elements.expect(INT32, "the dimensions of a matrix")?;
        let dimensions = dimensions.as_chunks().0.iter().map(|&word| elements.u32(word)).collect();
        let name = elements.expect(INT8, "the name of a matrix")?;
        Ok(Self { class, dimensions, name: excerpt(name) })
    }
}

impl Variable {
    fn parse(mut elements: Elements<'_>, limits: &ReadLimits) -> Result<Self, Located> {
        let head = MatrixHead::parse(&mut elements)?;
        if head.class != STRUCT_CLASS || head.dimensions.iter().any(|&n| n != 1) {
            return Ok(Self::Other(head.name));
        }
        let name_length = elements.expect(INT32, "the length of field names")?;
        let name_length = name_length.first_chunk().map_or(0, |&word| elements.u32(word)) as usize;
        let names = elements.expect(INT8, "the names of the fields")?;
        if name_length == 0 {
            return Ok(Self::Other(head.name));
        }
        let trimmed = |name: &[u8]| name.split(|&b| b == 0).next().unwrap_or_default().to_vec();
        let names: Vec<Vec<u8>> = names.chunks(name_length).map(trimmed).collect();
        if !FIELDS.iter().all(|field| names.iter().any(|name| name == field.as_bytes())) {
            return Ok(Self::Other(head.name));
        }
        let mut fields = Fields::default();
        for name in names {
            let tag = elements.tag()?;
            match FIELDS.iter().position(|field| name == field.as_bytes()) {
                Some(i) if tag.kind == MATRIX => fields[i] = Some(Matrix::parse(&mut elements, limits)?),
                Some(_) => return Err(elements.broken("a matrix in each field of the surface")),
                None => drop(elements.data(tag)?),
            }
        }
        Ok(Self::Surface(fields))
    }
}

impl Matrix {
    /// Checks the number of entries, then reads them.
    fn parse(elements: &mut Elements<'_>, limits: &ReadLimits) -> Result<Self, Located> {
        let head = MatrixHead::parse(elements)?;
        if !NUMERIC_CLASSES.contains(&head.class) {
            return Err(elements.broken("a full matrix of numbers in the fields X Y Z TRIV"));
        }
        let (rows, columns) = match *head.dimensions {
            [rows, columns] => (rows as usize, columns as usize),
            _ => return Err(elements.broken("matrices of two dimensions in the fields X Y Z TRIV")),
        };
        let tag = elements.tag()?;
        let scalar = scalar(tag.kind).ok_or_else(|| elements.broken("numbers in the fields X Y Z TRIV"))?;
        let promised = rows as u64 * columns as u64;
        let found = u64::from(tag.length) / scalar.size() as u64;
        if promised != found {
            return Err(Fault::truncated("numbers of a matrix", promised, found).at_byte(elements.start));
        }
        // TRIV has one row per face; X, Y and Z have one row or one column.
        let fault = |fault: Fault| fault.at_byte(elements.start);
        match (rows, columns) {
            (_, 3) => limits.check(0, rows as u64).map_err(fault)?,
            _ => limits.check(promised, 0).map_err(fault)?,
        }
        let data = elements.data(tag)?;
        let number = |bytes: &[u8]| scalar.decode(elements.order, bytes);
        let values = data.chunks_exact(scalar.size()).filter_map(number).collect();
        Ok(Self { rows, columns, values })
    }
}

fn mesh_of(fields: Fields, at: usize, limits: &ReadLimits) -> Result<MeshFile, Located> {
    let syntax = |expected, found: String| Fault::syntax(expected, found).at_byte(at);
    let [Some(x), Some(y), Some(z), Some(triv)] = fields else {
        return Err(syntax("a matrix in each of the fields X Y Z TRIV", "an empty field".into()));
    };
    let n = x.values.len();
    if [&x, &y, &z].iter().any(|m| m.values.len() != n || m.rows.min(m.columns) > 1) {
        let found = [x, y, z].map(|m| format!("{} x {}", m.rows, m.columns)).join(", ");
        return Err(syntax("columns X Y Z of equal length", found));
    }
    if triv.columns != 3 && !triv.values.is_empty() {
        return Err(syntax("three columns in TRIV", format!("{} x {}", triv.rows, triv.columns)));
    }
    limits.check(n as u64, triv.rows as u64).map_err(|fault| fault.at_byte(at))?;
    let mut positions = Vec::with_capacity(n);
    for (i, ((x, y), z)) in x.values.iter().zip(&y.values).zip(&z.values).enumerate() {
        positions.push(finite([*x, *y, *z], i + 1).map_err(|fault| fault.at_byte(at))?);
    }
    let vertex = |value: f64| match value.fract() == 0.0 && (1.0..=n as f64).contains(&value) {
        true => Ok(VertexId(value as u32 - 1)),
        false => Err(Fault::no_vertex(value.to_string(), 1, n as u64).at_byte(at)),
    };
    let corner = |face: usize, slot: usize| vertex(triv.values[slot * triv.rows + face]);
    let faces = (0..if triv.values.is_empty() { 0 } else { triv.rows })
        .map(|face| Ok([corner(face, 0)?, corner(face, 1)?, corner(face, 2)?]))
        .collect::<Result<_, Located>>()?;
    finish(TriMesh { positions, faces }, limits)
}
