//! Wavefront OBJ. Faces are parsed by `tobj`, vertices here.
//!
//! `tobj` numbers vertices anew in the order of their first use and drops those that no face uses,
//! while everything downstream needs the input's order. So it is fed a thinned file in which vertex
//! `i` stands at (i, 0, 0): the positions it hands back then are the original indices.

use std::io::{self, BufRead, Read, Write};

use nalgebra::Point3;

use crate::TriMesh;
use crate::error::{Fault, Located};
use surface::VertexId;

use super::ReadLimits;
use super::assembly::{finish, push_polygon};
use super::text::{Line, Lines, excerpt, parse_f64, parse_integer, parse_position};

/// Reads all objects and groups of an OBJ file as one mesh: vertices in the order of the `v` lines,
/// used or not, faces in the order of the `f` lines. Negative indices count back from the last
/// vertex; normals, texture coordinates, materials, lines and points are passed over.
pub(super) fn parse(bytes: &[u8], limits: &ReadLimits) -> Result<TriMesh, Located> {
    let mut feed = Feed::new(bytes, *limits);
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let outcome = tobj::load_obj_buf(&mut feed, &tobj::LoadOptions::default(), no_materials);
    let models = match outcome {
        Ok((models, _)) => models,
        Err(error) => return Err(feed.diagnose(error)),
    };
    let positions = feed.positions;
    if feed.line == 0 {
        return Err(Fault::Empty.whole());
    }
    let mut faces = Vec::with_capacity(feed.n_faces);
    let mut corners = Vec::new();
    for mesh in models.into_iter().map(|model| model.mesh) {
        let mut rest = mesh.indices.as_slice();
        let triangles_only = mesh.face_arities.is_empty();
        let n_faces = if triangles_only { rest.len() / 3 } else { mesh.face_arities.len() };
        for face in 0..n_faces {
            let n_corners = if triangles_only { 3 } else { mesh.face_arities[face] as usize };
            let (these, others) = rest.split_at(n_corners);
            rest = others;
            corners.clear();
            corners.extend(these.iter().map(|&i| VertexId(mesh.positions[3 * i as usize] as u32)));
            push_polygon(&positions, &corners, &mut faces, limits).map_err(Fault::whole)?;
        }
    }
    finish(positions, faces, limits)
}

/// The thinned file, produced line by line so that the line number at an error is known.
struct Feed<'a> {
    bytes: &'a [u8],
    limits: ReadLimits,
    lines: Lines<'a>,
    /// The line being handed out and how much of it is gone.
    current: Vec<u8>,
    taken: usize,
    line: usize,
    positions: Vec<Point3<f64>>,
    /// Triangles that the faces so far become.
    n_faces: usize,
    fault: Option<Located>,
}

impl<'a> Feed<'a> {
    fn new(bytes: &'a [u8], limits: ReadLimits) -> Self {
        Self {
            bytes,
            limits,
            lines: Lines::new(bytes),
            current: Vec::new(),
            taken: 0,
            line: 0,
            positions: Vec::new(),
            n_faces: 0,
            fault: None,
        }
    }

    /// Puts the next vertex or face line into `current`; leaves it empty at the end.
    fn advance(&mut self) -> Result<(), Located> {
        self.current.clear();
        self.taken = 0;
        for line in self.lines.by_ref() {
            self.line = line.number;
            let mut tokens = line.tokens();
            match tokens.next() {
                Some(b"v") => {
                    self.limits
                        .check(self.positions.len() as u64 + 1, 0)
                        .map_err(|fault| fault.in_line(line.number))?;
                    self.positions.push(parse_vertex(line, tokens, self.positions.len() + 1)?);
                    let index = self.positions.len() - 1;
                    self.current.extend_from_slice(format!("v {index} 0 0\n").as_bytes());
                    return Ok(());
                }
                Some(b"f") => {
                    let corners = tokens.count();
                    if corners < 3 {
                        return Err(Fault::TooFewCorners { corners }.in_line(line.number));
                    }
                    self.n_faces += corners - 2;
                    self.limits.check(0, self.n_faces as u64).map_err(|fault| fault.in_line(line.number))?;
                    self.current.extend_from_slice(line.text);
                    self.current.push(b'\n');
                    return Ok(());
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// What `tobj` stumbled over, with its place.
    fn diagnose(self, error: tobj::LoadError) -> Located {
        if let Some(fault) = self.fault {
            return fault;
        }
        match error {
            // Found only once all faces are read: look for the line.
            tobj::LoadError::FaceVertexOutOfBounds => self.first_face_out_of_range(),
            _ => Fault::Syntax {
                expected: "a face such as `f 1 2 3` or `f 1/1/1 2/2/2 3/3/3`",
                found: excerpt(&self.current),
            }
            .in_line(self.line),
        }
    }

    fn first_face_out_of_range(&self) -> Located {
        let last = self.positions.len() as i64;
        let mut seen = 0;
        for line in Lines::new(self.bytes) {
            let mut tokens = line.tokens();
            match tokens.next() {
                Some(b"v") => seen += 1,
                Some(b"f") => {
                    let first_word = |t: &'_ [u8]| t.split(|&b| b == b'/').next().and_then(parse_integer);
                    let in_range = |i: i64| (1..=last).contains(&if i < 0 { seen + 1 + i } else { i });
                    if let Some(token) = tokens.find(|t| !first_word(t).is_some_and(in_range)) {
                        let last = last as u64;
                        return Fault::IndexOutOfRange { index: excerpt(token), first: 1, last }
                            .in_line(line.number);
                    }
                }
                _ => {}
            }
        }
        let last = last as u64;
        Fault::IndexOutOfRange { index: "beyond the last".into(), first: 1, last }.whole()
    }
}

/// The position of a `v` line: three coordinates, then nothing, a weight, or a colour.
fn parse_vertex<'a>(
    line: Line<'a>,
    mut tokens: impl Iterator<Item = &'a [u8]>,
    vertex: usize,
) -> Result<Point3<f64>, Located> {
    let p = parse_position(line, &mut tokens, vertex)?;
    let (Some(weight), None) = (tokens.next(), tokens.next()) else { return Ok(p) };
    match parse_f64(weight).map(|w| p / w) {
        Some(p) if p.iter().all(|x| x.is_finite()) => Ok(p),
        _ => Err(line.expected("three coordinates and a weight that is not zero")),
    }
}

impl BufRead for Feed<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.taken == self.current.len() {
            self.advance().map_err(|fault| {
                self.fault = Some(fault);
                io::Error::from(io::ErrorKind::InvalidData)
            })?;
        }
        Ok(&self.current[self.taken..])
    }

    fn consume(&mut self, amount: usize) {
        self.taken += amount;
    }
}

impl Read for Feed<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(buffer)?;
        self.consume(n);
        Ok(n)
    }
}

/// Writes OBJ; coordinates are read back bit for bit.
pub(super) fn write(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    for p in &mesh.positions {
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| u64::from(v.0) + 1);
        writeln!(out, "f {a} {b} {c}")?;
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
        let Located { place, fault } = parse(text.as_bytes()).unwrap_err();
        (place, fault)
    }

    const FOUR: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

    #[test]
    fn vertices_keep_the_order_of_their_lines_used_or_not() {
        let mesh = parse(b"v 9 9 9\nv 0 0 1\nv 5 5 5\nv 0 1 0\nf 4 2 5\nv 1 0 0\n").unwrap();
        let x: Vec<f64> = mesh.positions.iter().map(|p| p.x).collect();
        assert_eq!(x, [9.0, 0.0, 5.0, 0.0, 1.0]);
        assert_eq!(mesh.faces, [[3, 1, 4].map(VertexId)]);
    }

    #[test]
    fn every_way_to_name_a_corner() {
        let lines = "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1//1 2//1 4//1\nf 1/1 3/1 4/1\nf -3 -2 -1\n";
        let expected = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
        assert_eq!(faces(&format!("{FOUR}{lines}")), expected);
        // Negative indices count from where they stand.
        assert_eq!(faces("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -3\nv 7 7 7\n"), [[2, 1, 0]]);
    }

    #[test]
    fn groups_objects_materials_and_polygons_make_one_mesh_in_file_order() {
        let text = format!(
            "mtllib none.mtl\no first\n{FOUR}g a\nusemtl red\nf 4 3 2\ng b c\ns off\nl 1 2\np 1\n\
             usemtl blue\nf 2 1 3\no second\nv 1 1 1\nv 2 2 2 # comment\nf 3 5 6 4 2\n"
        );
        let expected = [[3, 2, 1], [1, 0, 2], [2, 4, 5], [2, 5, 3], [2, 3, 1]];
        assert_eq!(faces(&text), expected);
        assert_eq!(faces(&text.replace('\n', "\r\n")), expected);
    }

    #[test]
    fn weights_scale_and_colours_do_not() {
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
}
