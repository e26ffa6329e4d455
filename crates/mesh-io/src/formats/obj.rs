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
    let mut polygons = Polygons::default();
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
        let first = *lines.peek().ok_or_else(|| Fault::Empty.whole())?;
        let (mut text, mut starts) = (Vec::new(), Vec::new());
        let (mut words, mut counts) = (Vec::new(), [0; 2]);
        while let Some(line) = lines.next() {
            words.clear();
            words.extend(line.tokens());
            // A line that ends with `\` continues in the next one.
            while words.pop_if(|word| *word == b"\\").is_some() {
                words.extend(lines.next().into_iter().flat_map(Line::tokens));
            }
            // An old spelling.
            if words.first() == Some(&&b"fo"[..]) {
                words[0] = b"f";
            }
            let (kind, kept) = match (words.first(), words.len()) {
                (Some(&b"v"), 5) => (0, 5),
                (Some(&b"v"), _) => (0, 4),
                (Some(&b"f"), n @ 4..) => (1, n),
                (Some(&b"f"), n) => return Err(Fault::too_few_corners(n - 1).in_line(line.number)),
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
        match starts.is_empty() {
            true => Err(other_format("an OBJ file with vertices", first.text).whole()),
            false => Ok(Self { text, starts }),
        }
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
