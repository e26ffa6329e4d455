//! Wavefront OBJ.

use std::io::Read;

use tobj::{LoadError, LoadOptions};

use crate::prelude::*;

/// Reads all objects and groups of an OBJ file as one mesh: vertices in the order of the `v` lines, faces in
/// the order of the `f` lines. Negative indices count back from the last vertex so far. Colors, normals,
/// texture coordinates, materials, lines and points are ignored.
///
/// tobj parses the statements. It numbers vertices in the order of their first use and drops the others, so a polygon
/// of all vertices comes first: after it, every vertex has its place in the file. tobj does not say where a fault is, but
/// it stops there.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let statements = Statements::of(files[0], limits)?;
    let n_vertices = statements.lines(b'v').count();
    let all = (1..=n_vertices).fold(String::from("f"), |all, vertex| all + " " + &vertex.to_string()) + "\n";
    let mut source = all.as_bytes().chain(statements.text.as_slice());
    // Positions have indices of their own, so that seams of texture stay closed, and polygons stay whole.
    let options = LoadOptions { single_index: false, triangulate: false, ..LoadOptions::default() };
    let loaded = tobj::load_obj_buf(&mut source, &options, |_| Err(LoadError::OpenFileFailed));
    let n_read = statements.text.len() - source.get_ref().1.len();
    let (models, _) = loaded.map_err(|fault| statements.locate(fault, n_read, n_vertices))?;
    let mesh = models.into_iter().next().map(|model| model.mesh).unwrap_or_default();

    let mut positions = Vec::with_capacity(n_vertices);
    for ((p, line), vertex) in mesh.positions.as_chunks::<3>().0.iter().zip(statements.lines(b'v')).zip(1..) {
        positions.push(finite(*p, vertex).in_line(line)?);
    }
    let corners: Vec<VertexId> = mesh.indices.into_iter().map(VertexId).collect();
    let mut rest = corners.get(n_vertices..).unwrap_or_default();
    // No arities mean triangles.
    let arities = mesh.face_arities.iter().skip(1).copied().chain(std::iter::repeat(3));
    let mut polygons = Polygons::with_room_for(statements.starts.len() - n_vertices);
    for (line, arity) in statements.lines(b'f').zip(arities) {
        let Some((polygon, others)) = rest.split_at_checked(arity as usize) else { break };
        polygons.push(&positions, polygon, limits).in_line(line)?;
        rest = others;
    }
    polygons.finish(positions, limits)
}

/// The `v` and `f` statements of a file, one in each line, without what tobj would refuse: comments, line ends behind `\`,
/// and colors, which it wants for all vertices or none.
struct Statements {
    text: Vec<u8>,
    /// The first letter of each, and its line in the file.
    starts: Vec<(u8, usize)>,
}

impl Statements {
    fn of(bytes: &[u8], limits: &ReadLimits) -> Result<Self, Located> {
        let mut lines = Lines::new(bytes).peekable();
        lines.peek().ok_or_else(|| Fault::Empty.whole())?;
        let (mut text, mut starts) = (Vec::new(), Vec::new());
        let (mut words, mut counts) = (Vec::new(), [0; 2]);
        while let Some(line) = lines.next() {
            words.clear();
            words.extend(line.tokens());
            // A line that ends with `\` continues in the next one.
            while words.pop_if(|word| *word == b"\\").is_some() {
                words.extend(lines.next().into_iter().flat_map(Line::tokens));
            }
            let (kind, kept) = match (words.first(), words.len()) {
                (Some(&b"v"), 5) => (0, 5),
                (Some(&b"v"), _) => (0, 4),
                (Some(&b"f"), n @ 4..) => (1, n),
                (Some(&b"f"), n) => return Err(Fault::TooFewCorners { corners: n - 1 }.in_line(line.number)),
                _ => continue,
            };
            counts[kind] += 1;
            limits.check(counts[0], counts[1]).in_line(line.number)?;
            starts.push((words[0][0], line.number));
            for word in words.iter().take(kept) {
                text.extend_from_slice(word);
                text.push(b' ');
            }
            text.push(b'\n');
        }
        Ok(Self { text, starts })
    }

    /// The lines of the statements that begin with this letter.
    fn lines(&self, letter: u8) -> impl Iterator<Item = usize> {
        self.starts.iter().filter(move |start| start.0 == letter).map(|start| start.1)
    }

    /// Places a fault that tobj found in the last statement of what it has read; a face that refers to a missing vertex is
    /// somewhere before.
    fn locate(&self, fault: LoadError, n_read: usize, n_vertices: usize) -> Located {
        let (mut n_before, mut last) = (0, Line { number: 0, text: b"" });
        for (statement, (letter, number)) in Lines::new(&self.text[..n_read]).zip(&self.starts) {
            last = Line { number: *number, ..statement };
            n_before += i64::from(*letter == b'v');
            let is_checked = *letter == b'f' && fault == LoadError::FaceVertexOutOfBounds;
            for corner in statement.tokens().skip(1).filter(|_| is_checked) {
                let index = corner.split(|b| *b == b'/').next().and_then(parse_number::<i64>).unwrap_or(0);
                let vertex = if index < 0 { index.saturating_add(n_before) } else { index - 1 };
                if !(0..n_vertices as i64).contains(&vertex) {
                    return Fault::no_vertex(excerpt(corner), 1, n_vertices as u64).in_line(*number);
                }
            }
        }
        last.expected(match fault {
            LoadError::ScalingByZeroError => "a weight other than zero",
            _ if last.text.starts_with(b"v") => "three coordinates",
            _ => "a face such as `f 1 2 3` or `f 1/1/1 2/2/2 3/3/3`",
        })
    }
}

/// Writes OBJ; coordinates read back bit for bit. A color follows the position of its vertex; the format has no place for
/// values.
pub(super) fn write(out: &mut dyn Write, mesh: &TriMesh, field: Field<'_>) -> io::Result<()> {
    for (v, p) in mesh.positions.iter().enumerate() {
        write_position(out, "v ", p)?;
        if let Some(field) = field {
            let [r, g, b] = field.colors[v].map(|channel| f64::from(channel) / 255.0);
            write!(out, " {r:.4} {g:.4} {b:.4}")?;
        }
        writeln!(out)?;
    }
    let from_one = |face: &[VertexId; 3]| face.map(|v| u64::from(v.0) + 1);
    mesh.faces.iter().map(from_one).try_for_each(|[a, b, c]| writeln!(out, "f {a} {b} {c}"))
}

/// Writes a `v` for each point and an `l` for each line; a line of one point is a `p`.
pub(super) fn write_lines(out: &mut dyn Write, lines: &[Vec<Point3<f64>>]) -> io::Result<()> {
    lines.iter().flatten().try_for_each(|p| write_position(out, "v ", p).and_then(|()| writeln!(out)))?;
    let mut first = 1;
    for line in lines.iter().filter(|line| !line.is_empty()) {
        write!(out, "{}", if line.len() == 1 { "p" } else { "l" })?;
        (first..first + line.len()).try_for_each(|vertex| write!(out, " {vertex}"))?;
        writeln!(out)?;
        first += line.len();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(bytes: &[u8]) -> Result<TriMesh, Located> {
        super::parse(&[bytes], &ReadLimits::default()).map(|file| file.mesh)
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
        let expected = [[3, 2, 1], [1, 0, 2], [3, 1, 2], [3, 2, 4], [3, 4, 5]];
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
