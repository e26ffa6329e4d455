//! The native layout of the TOSCA shapes: coordinates in `NAME.vert`, one-based faces in `NAME.tri`.

use std::io::{self, Write};

use nalgebra::Point3;
use surface::VertexId;

use crate::facts::MeshFile;
use crate::field::WrittenField;
use crate::limits::ReadLimits;
use crate::located::{At, Located};
use crate::polygons::finish;
use crate::text::{Lines, check_is_text, parse_position, parse_vertex, write_position};
use mesh::Fault;
use mesh::TriMesh;

/// The fewest bytes of a line: three digits, two separators, a line end.
const SHORTEST_LINE: usize = 6;

/// Checks that either file is text.
pub(super) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    check_is_text(start, "a file of numbers")
}

/// Reads the two files of a shape.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let positions = parse_positions(files[0], limits)?;
    let faces = parse_faces(files[1], positions.len(), limits).map_err(|fault| fault.of_file(1))?;
    finish(TriMesh { positions, faces }, limits).map_err(|fault| fault.of_file(1))
}

/// Reads three coordinates per line.
fn parse_positions(bytes: &[u8], limits: &ReadLimits) -> Result<Vec<Point3<f64>>, Located> {
    let mut positions = Vec::with_capacity(bytes.len() / (4 * SHORTEST_LINE));
    for line in Lines::new(bytes) {
        let mut tokens = line.tokens();
        positions.push(parse_position(line, &mut tokens, positions.len() + 1)?);
        if tokens.next().is_some() {
            return Err(line.expected("exactly three coordinates"));
        }
        limits.check(positions.len() as u64, 0).map_err(|fault| fault.in_line(line.number))?;
    }
    if positions.is_empty() {
        return Err(Fault::Empty.whole());
    }
    Ok(positions)
}

/// Reads three vertices per line, counted from one.
fn parse_faces(bytes: &[u8], n_vertices: usize, limits: &ReadLimits) -> Result<Vec<[VertexId; 3]>, Located> {
    let mut faces = Vec::with_capacity(bytes.len() / (2 * SHORTEST_LINE));
    for line in Lines::new(bytes) {
        let expected = "three vertices, counted from one";
        let mut tokens = line.tokens();
        let mut face = [VertexId(0); 3];
        for corner in &mut face {
            *corner = parse_vertex(line, &mut tokens, [1, n_vertices as u64], expected)?;
        }
        if tokens.next().is_some() {
            return Err(line.expected(expected));
        }
        faces.push(face);
        limits.check(0, faces.len() as u64).map_err(|fault| fault.in_line(line.number))?;
    }
    if faces.is_empty() {
        return Err(Fault::Empty.whole());
    }
    Ok(faces)
}

/// Writes the `.vert` half; coordinates read back bit for bit.
pub(super) fn write_positions(out: &mut dyn Write, mesh: &TriMesh, _: WrittenField<'_>) -> io::Result<()> {
    mesh.positions.iter().try_for_each(|p| write_position(out, "", p))
}

/// Writes the `.tri` half.
pub(super) fn write_faces(out: &mut dyn Write, mesh: &TriMesh, _: WrittenField<'_>) -> io::Result<()> {
    mesh.faces.iter().try_for_each(|face| {
        let [a, b, c] = face.map(|v| u64::from(v.0) + 1);
        writeln!(out, "{a} {b} {c}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::located::{At, Located};
    use mesh::Place;

    fn parse_positions(bytes: &[u8]) -> Result<Vec<Point3<f64>>, Located> {
        super::parse_positions(bytes, &ReadLimits::default())
    }

    fn parse_faces(bytes: &[u8], n_vertices: usize) -> Result<Vec<[VertexId; 3]>, Located> {
        super::parse_faces(bytes, n_vertices, &ReadLimits::default())
    }

    #[test]
    fn both_halves_parse_with_any_line_end_and_notation() {
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
