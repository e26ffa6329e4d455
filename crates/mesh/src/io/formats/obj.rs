//! Wavefront OBJ, parsed by `tobj`.
//!
//! `tobj` numbers vertices in the order in which faces first use them, drops the others, and starts a new
//! mesh at each object, group and material. The numbers of the file survive because it is given the `v` and
//! `f` lines only, after one face over all vertices: that face uses them in the order of the file.

use std::io::{self, Read, Write};
use std::path::Path;

use nalgebra::Point3;
use surface::VertexId;

use crate::error::{Fault, Located};
use crate::io::limits::ReadLimits;
use crate::io::polygons::{finish, push_polygon};
use crate::io::text::{Line, Lines, excerpt, parse_integer, write_position};
use crate::tri_mesh::TriMesh;

/// Reads all objects and groups of an OBJ file as one mesh: vertices in the order of the `v` lines, faces in
/// the order of the `f` lines. Negative indices count back from the last vertex so far. Colours, normals,
/// texture coordinates, materials, lines and points are ignored.
pub(super) fn parse(bytes: &[u8], limits: &ReadLimits) -> Result<TriMesh, Located> {
    if Lines::new(bytes).next().is_none() {
        return Err(Fault::Empty.whole());
    }
    let Statements { n_vertices, n_faces, text } = Statements::of(bytes, limits)?;
    let mut all_vertices = b"f".to_vec();
    for vertex in 1..=n_vertices {
        // Writing to memory cannot fail.
        let _ = write!(all_vertices, " {vertex}");
    }
    all_vertices.push(b'\n');
    let mut reader = all_vertices.as_slice().chain(text.as_slice());
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let loaded = tobj::load_obj_buf(&mut reader, &tobj::LoadOptions::default(), no_materials);
    let (models, _) = loaded.map_err(|error| {
        let n_read = text.len() - reader.into_inner().1.len();
        diagnose(error, bytes, &text[..n_read], n_vertices)
    })?;

    let (mut positions, mut faces) = (Vec::with_capacity(n_vertices), Vec::with_capacity(n_faces));
    for mesh in models.into_iter().map(|model| model.mesh) {
        positions.extend(mesh.positions.as_chunks().0.iter().map(|&p| Point3::from(p)));
        // Without arities all faces are triangles.
        let mut arities = mesh.face_arities.iter().skip(1);
        let (mut rest, mut corners) = (&mesh.indices[n_vertices..], Vec::new());
        while !rest.is_empty() {
            let (face, others) = rest.split_at(arities.next().map_or(3, |&arity| arity as usize));
            corners.clear();
            corners.extend(face.iter().copied().map(VertexId));
            push_polygon(&positions, &corners, &mut faces, limits).map_err(Fault::whole)?;
            rest = others;
        }
    }
    check_finite(&positions, bytes)?;
    finish(positions, faces, limits)
}

/// What `f` and `v` lines hold.
const EXPECTED: [&str; 2] = [
    "a face such as `f 1 2 3` or `f 1/1/1 2/2/2 3/3/3`",
    "three coordinates, optionally followed by a weight other than zero",
];

/// The `v` and `f` lines of a file.
struct Statements {
    n_vertices: usize,
    /// Triangles after triangulation.
    n_faces: usize,
    /// The lines without colours, which `tobj` rejects unless all vertices have one.
    text: Vec<u8>,
}

impl Statements {
    fn of(bytes: &[u8], limits: &ReadLimits) -> Result<Self, Located> {
        let mut all = Self { n_vertices: 0, n_faces: 0, text: Vec::with_capacity(bytes.len()) };
        for (is_vertex, line) in statements(bytes) {
            let (mut n_words, mut is_foreign, mut previous) = (0, false, b' ');
            for &byte in line.text {
                n_words += usize::from(previous <= b' ' && byte > b' ');
                is_foreign |= !matches!(byte, b'\t' | b' '..=b'~');
                previous = byte;
            }
            // `tobj` takes some other characters for spaces.
            if is_foreign {
                return Err(line.expected(EXPECTED[usize::from(is_vertex)]));
            }
            let n_values = n_words - 1;
            if is_vertex {
                all.n_vertices += 1;
            } else if n_values < 3 {
                return Err(Fault::TooFewCorners { corners: n_values }.in_line(line.number));
            } else {
                all.n_faces += n_values - 2;
            }
            let checked = limits.check(all.n_vertices as u64, all.n_faces as u64);
            checked.map_err(|fault| fault.in_line(line.number))?;
            // A fourth value is a weight; more are a colour.
            if is_vertex && n_values > 4 {
                all.text.extend(line.tokens().take(4).collect::<Vec<_>>().join(&b' '));
            } else {
                all.text.extend_from_slice(line.text);
            }
            all.text.push(b'\n');
        }
        Ok(all)
    }
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

/// Locates an error of `tobj` after it has read the statements `read`.
fn diagnose(error: tobj::LoadError, bytes: &[u8], read: &[u8], n_vertices: usize) -> Located {
    if error == tobj::LoadError::FaceVertexOutOfBounds {
        return first_index_out_of_range(bytes, n_vertices);
    }
    let n_read = read.iter().filter(|&&b| b == b'\n').count();
    match statements(bytes).take(n_read).last() {
        Some((is_vertex, line)) => line.expected(EXPECTED[usize::from(is_vertex)]),
        None => Fault::Syntax { expected: EXPECTED[0], found: error.to_string() }.whole(),
    }
}

/// `tobj` checks indices after it has read the whole file.
fn first_index_out_of_range(bytes: &[u8], n_vertices: usize) -> Located {
    let last = n_vertices as u64;
    let mut n_before = 0;
    for (is_vertex, line) in statements(bytes) {
        n_before += i64::from(is_vertex);
        let in_range = |token: &&[u8]| {
            let index = token.split(|&b| b == b'/').next().and_then(parse_integer);
            index.is_some_and(|i| (1..=n_vertices as i64).contains(&if i < 0 { n_before + 1 + i } else { i }))
        };
        if !is_vertex && let Some(token) = line.tokens().skip(1).find(|token| !in_range(token)) {
            return Fault::IndexOutOfRange { index: excerpt(token), first: 1, last }.in_line(line.number);
        }
    }
    Fault::IndexOutOfRange { index: "beyond the last".into(), first: 1, last }.whole()
}

fn check_finite(positions: &[Point3<f64>], bytes: &[u8]) -> Result<(), Located> {
    for (v, p) in positions.iter().enumerate() {
        if let Some(&value) = p.iter().find(|x| !x.is_finite()) {
            let fault = Fault::NonFinite { vertex: v as u64 + 1, value };
            let line = statements(bytes).filter(|(is_vertex, _)| *is_vertex).nth(v);
            return Err(line.map_or(fault.clone().whole(), |(_, line)| fault.in_line(line.number)));
        }
    }
    Ok(())
}

/// Writes OBJ; coordinates read back bit for bit.
pub(super) fn write(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    mesh.positions.iter().try_for_each(|p| write_position(out, "v ", p))?;
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
