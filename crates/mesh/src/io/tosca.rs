//! The native layout of the TOSCA shapes: coordinates in `NAME.vert`, one-based faces in `NAME.tri`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use nalgebra::Point3;

use crate::TriMesh;
use crate::error::{Fault, Located, MeshError};
use surface::VertexId;

use super::ReadLimits;
use super::assembly::finish;
use super::source::Source;
use super::text::{Lines, excerpt, parse_integer, parse_position};

/// The fewest bytes of a line: three digits, two separators, a line end.
const SHORTEST_LINE: usize = 6;

/// The two files of a shape.
pub(super) struct Pair {
    pub(super) vert: PathBuf,
    pub(super) tri: PathBuf,
}

impl Pair {
    /// The pair that `path`, either half, belongs to. The other half's extension is in upper case
    /// where this one's is, unless only the lower-case file exists.
    pub(super) fn of(path: &Path, source: &dyn Source) -> Self {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        let is_vert = extension.eq_ignore_ascii_case("vert");
        let other = if is_vert { "tri" } else { "vert" };
        let lower = path.with_extension(other);
        let upper = path.with_extension(other.to_ascii_uppercase());
        let prefers_upper = extension.chars().all(|c| c.is_ascii_uppercase());
        let partner = match prefers_upper {
            true if source.holds(&upper) || !source.holds(&lower) => upper,
            false if source.holds(&upper) && !source.holds(&lower) => upper,
            _ => lower,
        };
        let this = path.to_path_buf();
        if is_vert { Self { vert: this, tri: partner } } else { Self { vert: partner, tri: this } }
    }
}

/// Reads a pair; `path` is the half that was asked for.
pub(super) fn read(path: &Path, source: &dyn Source, limits: &ReadLimits) -> Result<TriMesh, MeshError> {
    let pair = Pair::of(path, source);
    let half = |half: &Path| {
        if half != path && !source.holds(half) {
            let partner = half.file_name().unwrap_or_default().to_string_lossy().into_owned();
            return Err(Fault::NoPartner { partner }.whole().in_file(path));
        }
        source.load(half)
    };
    let positions = parse_positions(&half(&pair.vert)?, limits).map_err(|fault| fault.in_file(&pair.vert))?;
    let faces =
        parse_faces(&half(&pair.tri)?, positions.len(), limits).map_err(|fault| fault.in_file(&pair.tri))?;
    finish(positions, faces, limits).map_err(|fault| fault.in_file(&pair.tri))
}

/// One vertex a line, three coordinates.
pub(super) fn parse_positions(bytes: &[u8], limits: &ReadLimits) -> Result<Vec<Point3<f64>>, Located> {
    let mut positions = Vec::with_capacity(bytes.len() / (4 * SHORTEST_LINE));
    for line in Lines::new(bytes) {
        let mut tokens = line.tokens();
        positions.push(parse_position(line, &mut tokens, positions.len() + 1)?);
        if tokens.next().is_some() {
            return Err(line.expected("three coordinates and no more"));
        }
        limits.check(positions.len() as u64, 0).map_err(|fault| fault.in_line(line.number))?;
    }
    if positions.is_empty() {
        return Err(Fault::Empty.whole());
    }
    Ok(positions)
}

/// One triangle a line, three vertices counted from one.
pub(super) fn parse_faces(
    bytes: &[u8],
    n_vertices: usize,
    limits: &ReadLimits,
) -> Result<Vec<[VertexId; 3]>, Located> {
    let mut faces = Vec::with_capacity(bytes.len() / (2 * SHORTEST_LINE));
    for line in Lines::new(bytes) {
        let expected = || line.expected("three vertices, counted from one");
        let mut tokens = line.tokens();
        let mut face = [VertexId(0); 3];
        for corner in &mut face {
            let token = tokens.next().ok_or_else(expected)?;
            let index = parse_integer(token).ok_or_else(expected)?;
            if !(1..=n_vertices as i64).contains(&index) {
                let (index, last) = (excerpt(token), n_vertices as u64);
                return Err(Fault::IndexOutOfRange { index, first: 1, last }.in_line(line.number));
            }
            *corner = VertexId((index - 1) as u32);
        }
        if tokens.next().is_some() {
            return Err(expected());
        }
        faces.push(face);
        limits.check(0, faces.len() as u64).map_err(|fault| fault.in_line(line.number))?;
    }
    if faces.is_empty() {
        return Err(Fault::Empty.whole());
    }
    Ok(faces)
}

/// Writes the `.vert` half; coordinates are read back bit for bit.
pub(super) fn write_positions(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    mesh.positions.iter().try_for_each(|p| writeln!(out, "{:?} {:?} {:?}", p.x, p.y, p.z))
}

/// Writes the `.tri` half.
pub(super) fn write_faces(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    mesh.faces.iter().try_for_each(|face| {
        let [a, b, c] = face.map(|v| u64::from(v.0) + 1);
        writeln!(out, "{a} {b} {c}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;

    fn parse_positions(bytes: &[u8]) -> Result<Vec<Point3<f64>>, Located> {
        super::parse_positions(bytes, &ReadLimits::default())
    }

    fn parse_faces(bytes: &[u8], n_vertices: usize) -> Result<Vec<[VertexId; 3]>, Located> {
        super::parse_faces(bytes, n_vertices, &ReadLimits::default())
    }

    #[test]
    fn both_halves_in_either_line_end_and_notation() {
        let positions = parse_positions(b"0 0 0\r\n1.5 -2e-1 3\r\n\r\n.5 1. 0").unwrap();
        assert_eq!(positions[1], Point3::new(1.5, -0.2, 3.0));
        assert_eq!(positions.len(), 3);
        let faces = parse_faces(b"1 2 3\r\n   3.0000000e+00   2.0000000e+00   1.0000000e+00\n", 3).unwrap();
        assert_eq!(faces, [[0, 1, 2].map(VertexId), [2, 1, 0].map(VertexId)]);
    }

    #[test]
    fn faults_name_the_line() {
        let index = |index: &str| Fault::IndexOutOfRange { index: index.into(), first: 1, last: 3 };
        assert_eq!(parse_faces(b"1 2 3\n\n1 2 4", 3), Err(index("4").in_line(3)));
        assert_eq!(parse_faces(b"0 2 3\n", 3), Err(index("0").in_line(1)));
        assert_eq!(parse_faces(b"-1 2 3\n", 3), Err(index("-1").in_line(1)));
        assert!(matches!(parse_faces(b"1 2\n", 3), Err(Located { place: Place::Line(1), .. })));
        assert!(matches!(parse_faces(b"1 2 3 1\n", 3), Err(Located { place: Place::Line(1), .. })));
        assert!(matches!(parse_positions(b"1 2 3 4\n"), Err(Located { place: Place::Line(1), .. })));
        assert_eq!(parse_faces(b" \r\n", 3), Err(Fault::Empty.whole()));
        assert_eq!(parse_positions(b""), Err(Fault::Empty.whole()));
        let nan = parse_positions(b"0 0 0\n1 NaN 0\n").unwrap_err();
        assert_eq!(nan.place, Place::Line(2));
        assert!(matches!(nan.fault, Fault::NonFinite { vertex: 2, .. }));
    }
}
