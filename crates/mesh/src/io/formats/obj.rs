//! Wavefront OBJ.

use std::io::{self, Write};

use nalgebra::Point3;
use surface::VertexId;

use crate::error::{Fault, Located};
use crate::io::field::VertexField;
use crate::io::limits::ReadLimits;
use crate::io::polygons::{finish, push_polygon};
use crate::io::text::{Line, Lines, check_is_text, excerpt, parse_number, parse_position, write_position};
use crate::tri_mesh::TriMesh;

/// Checks that the file is text; any line may come first.
pub(super) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    check_is_text(start, "an OBJ file")
}

/// Reads all objects and groups of an OBJ file as one mesh: vertices in the order of the `v` lines, faces in
/// the order of the `f` lines. Negative indices count back from the last vertex so far. Colours, normals,
/// texture coordinates, materials, lines and points are ignored.
pub(super) fn parse(bytes: &[u8], limits: &ReadLimits) -> Result<TriMesh, Located> {
    if Lines::new(bytes).next().is_none() {
        return Err(Fault::Empty.whole());
    }
    let mut positions = Vec::new();
    for (_, line) in statements(bytes).filter(|(is_vertex, _)| *is_vertex) {
        positions.push(parse_vertex(line, positions.len() + 1)?);
        limits.check(positions.len() as u64, 0).map_err(|fault| fault.in_line(line.number))?;
    }
    // A face may precede its vertices.
    let (mut faces, mut corners, mut n_before) = (Vec::new(), Vec::new(), 0);
    for (is_vertex, line) in statements(bytes) {
        n_before += i64::from(is_vertex);
        if !is_vertex {
            corners.clear();
            for token in line.tokens().skip(1) {
                corners.push(parse_corner(line, token, n_before, positions.len())?);
            }
            let pushed = push_polygon(&positions, &corners, &mut faces, limits);
            pushed.map_err(|fault| fault.in_line(line.number))?;
        }
    }
    finish(positions, faces, limits)
}

/// The `v` and `f` lines, and whether each is a `v` line.
fn statements(bytes: &[u8]) -> impl Iterator<Item = (bool, Line<'_>)> {
    Lines::new(bytes).filter_map(|line| {
        let is_keyword = line.text.get(1).is_none_or(u8::is_ascii_whitespace);
        match line.text[0] {
            b'v' if is_keyword => Some((true, line)),
            b'f' if is_keyword => Some((false, line)),
            _ => None,
        }
    })
}

/// Reads three coordinates. A fourth value is a weight, which divides them; more values are a colour.
fn parse_vertex(line: Line<'_>, number: usize) -> Result<Point3<f64>, Located> {
    let mut tokens = line.tokens().skip(1);
    let position = parse_position(line, &mut tokens, number)?;
    let (Some(weight), None) = (tokens.next(), tokens.next()) else { return Ok(position) };
    let weight = parse_number(weight).filter(|weight: &f64| *weight != 0.0);
    let position = position / weight.ok_or_else(|| line.expected("a weight other than zero"))?;
    match position.iter().find(|x| !x.is_finite()) {
        Some(&value) => Err(Fault::NonFinite { vertex: number as u64, value }.in_line(line.number)),
        None => Ok(position),
    }
}

/// Reads the vertex of a corner, `VERTEX[/[TEXTURE][/NORMAL]]`, in a file of `n_vertices`, `n_before` of which
/// precede the line.
fn parse_corner(line: Line<'_>, token: &[u8], n_before: i64, n_vertices: usize) -> Result<VertexId, Located> {
    let mut parts = token.split(|&b| b == b'/');
    let index = parts.next().and_then(parse_number::<i64>);
    let index = index.filter(|_| parts.all(|part| part.is_empty() || parse_number::<i64>(part).is_some()));
    let index = index.ok_or_else(|| line.expected("a face such as `f 1 2 3` or `f 1/1/1 2/2/2 3/3/3`"))?;
    let vertex = if index < 0 { n_before.saturating_add(index) } else { index - 1 };
    if !(0..n_vertices as i64).contains(&vertex) {
        let fault = Fault::IndexOutOfRange { index: excerpt(token), first: 1, last: n_vertices as u64 };
        return Err(fault.in_line(line.number));
    }
    Ok(VertexId(vertex as u32))
}

/// Writes OBJ; coordinates read back bit for bit.
pub(super) fn write(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    mesh.positions.iter().try_for_each(|p| write_position(out, "v ", p))?;
    write_faces(out, mesh)
}

/// Writes OBJ with a colour per vertex, behind its position. The format has no place for values.
pub(super) fn write_field(out: &mut dyn Write, mesh: &TriMesh, field: &VertexField<'_>) -> io::Result<()> {
    for (p, color) in mesh.positions.iter().zip(field.colors) {
        let [r, g, b] = color.map(|channel| f64::from(channel) / 255.0);
        writeln!(out, "v {:?} {:?} {:?} {r:.4} {g:.4} {b:.4}", p.x, p.y, p.z)?;
    }
    write_faces(out, mesh)
}

fn write_faces(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| u64::from(v.0) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

/// Writes a `v` for each point and an `l` for each line; a line of one point is a `p`.
pub(super) fn write_lines(out: &mut dyn Write, lines: &[Vec<Point3<f64>>]) -> io::Result<()> {
    lines.iter().flatten().try_for_each(|p| write_position(out, "v ", p))?;
    let mut first = 1;
    for line in lines.iter().filter(|line| !line.is_empty()) {
        write!(out, "{}", if line.len() == 1 { "p" } else { "l" })?;
        for vertex in first..first + line.len() {
            write!(out, " {vertex}")?;
        }
        writeln!(out)?;
        first += line.len();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;

    fn parse(bytes: &[u8]) -> Result<TriMesh, Located> {
        super::parse(bytes, &ReadLimits::default())
    }

    fn faces(text: &str) -> Vec<[u32; 3]> {
        parse(text.as_bytes()).unwrap().faces.iter().map(|f| f.map(|v| v.0)).collect()
    }

    fn fault(text: &str) -> (Place, Fault) {
        let Located { place, fault, .. } = parse(text.as_bytes()).unwrap_err();
        (place, fault)
    }

    const FOUR: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

    #[test]
    fn vertices_keep_the_order_of_their_lines_whether_used_or_not() {
        let mesh = parse(b"v 9 9 9\nv 0 0 1\nv 5 5 5\nv 0 1 0\nf 4 2 5\nv 1 0 0\n").unwrap();
        let x: Vec<f64> = mesh.positions.iter().map(|p| p.x).collect();
        assert_eq!(x, [9.0, 0.0, 5.0, 0.0, 1.0]);
        assert_eq!(mesh.faces, [[3, 1, 4].map(VertexId)]);
    }

    #[test]
    fn corners_parse_in_every_notation() {
        let lines = "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1//1 2//1 4//1\nf 1/1 3/1 4/1\nf -3 -2 -1\n";
        let expected = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
        assert_eq!(faces(&format!("{FOUR}{lines}")), expected);
        // Negative indices count from where they stand.
        assert_eq!(faces("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -3\nv 7 7 7\n"), [[2, 1, 0]]);
    }

    #[test]
    fn objects_groups_and_materials_become_one_mesh_in_file_order() {
        let text = format!(
            "mtllib none.mtl\no first\n{FOUR}g a\nusemtl red\nf 4 3 2\ng b c\ns off\nl 1 2\np 1\n\
             usemtl blue\nf 2 1 3\no second\nv 1 1 1\nv 2 2 2 # comment\nf 3 5 6 4 2\n"
        );
        let expected = [[3, 2, 1], [1, 0, 2], [2, 4, 5], [2, 5, 3], [2, 3, 1]];
        assert_eq!(faces(&text), expected);
        assert_eq!(faces(&text.replace('\n', "\r\n")), expected);
    }

    #[test]
    fn weights_divide_and_colours_are_ignored() {
        let mesh = parse(b"v 2 4 6 2\nv 1 2 3 .1 .2 .3\nv 0 0 0\nf 1 2 3\n").unwrap();
        assert_eq!(mesh.positions[0], mesh.positions[1]);
        assert!(matches!(fault("v 2 4 6 0\n"), (Place::Line(1), Fault::Syntax { .. })));
    }

    #[test]
    fn faults_name_the_line() {
        let index = |index: &str| Fault::IndexOutOfRange { index: index.into(), first: 1, last: 4 };
        assert_eq!(fault(&format!("{FOUR}f 1 2 3\nf 1 2 5\n")), (Place::Line(6), index("5")));
        assert_eq!(fault(&format!("{FOUR}\nf 0/1 2 3\n")), (Place::Line(6), index("0/1")));
        assert_eq!(fault(&format!("{FOUR}f 1 2 -5\n")), (Place::Line(5), index("-5")));
        assert!(matches!(fault(&format!("{FOUR}f 1 2 x\n")), (Place::Line(5), Fault::Syntax { .. })));
        assert_eq!(fault(&format!("{FOUR}f 1 2\n")), (Place::Line(5), Fault::TooFewCorners { corners: 2 }));
        assert!(matches!(fault("v 0 0\n"), (Place::Line(1), Fault::Syntax { .. })));
        assert!(matches!(
            fault("# x\nv 0 -inf 0\n"),
            (Place::Line(2), Fault::NonFinite { vertex: 1, value: f64::NEG_INFINITY })
        ));
        assert_eq!(fault(FOUR), (Place::File, Fault::NoFaces { n_vertices: 4 }));
        assert_eq!(fault("hello\n"), (Place::File, Fault::NoFaces { n_vertices: 0 }));
        assert_eq!(fault("# only\n\n"), (Place::File, Fault::Empty));
        let binary = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \xff\n";
        assert_eq!(parse(binary).unwrap_err().place, Place::Line(4));
        let huge = format!("{FOUR}f 1/9223372036854775807/-9223372036854775808 2 3\n");
        assert_eq!(faces(&huge), [[0, 1, 2]]);
    }

    #[test]
    fn lines_have_a_statement_each() {
        let point = |x: f64| Point3::new(x, 0.1, -1e-9);
        let lines =
            [vec![point(0.0), point(1.0), point(2.5)], vec![point(7.0)], vec![point(3.0), point(4.0)]];
        let mut out = Vec::new();
        write_lines(&mut out, &lines).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert_eq!(text.lines().filter(|line| line.starts_with("v ")).count(), 6);
        assert!(text.ends_with("v 4.0 0.1 -1e-9\nl 1 2 3\np 4\nl 5 6\n"), "{text}");
    }
}
