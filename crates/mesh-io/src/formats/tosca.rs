//! The native layout of the TOSCA shapes: coordinates in `NAME.vert`, one-based faces in `NAME.tri`.

use crate::prelude::*;

/// Reads the two files of a shape: three coordinates, or three vertices counted from one, in each line.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let mut mesh = TriMesh::default();
    let mut words = Words::new(Lines::new(files[0]), false);
    while let Some(line) = words.row() {
        mesh.positions.push(parse_position(line, &mut words, mesh.n_vertices() + 1)?);
        check_end(&mut words, "exactly three coordinates")?;
        limits.check(mesh.n_vertices() as u64, 0).in_line(line.number)?;
    }
    if mesh.positions.is_empty() {
        return Err(Fault::Empty.whole());
    }
    mesh.faces = parse_faces(files[1], mesh.n_vertices() as u64, limits)
        .map_err(|fault| Located { file: 1, ..fault })?;
    finish(mesh, limits)
}

fn parse_faces(bytes: &[u8], n_vertices: u64, limits: &ReadLimits) -> Result<Vec<[VertexId; 3]>, Located> {
    let expected = "three vertices, counted from one";
    let mut faces = Vec::new();
    let mut words = Words::new(Lines::new(bytes), false);
    while let Some(line) = words.row() {
        let mut face = [VertexId(0); 3];
        for corner in &mut face {
            *corner = parse_vertex(line, &mut words, [1, n_vertices], expected)?;
        }
        check_end(&mut words, expected)?;
        faces.push(face);
        limits.check(0, faces.len() as u64).in_line(line.number)?;
    }
    if faces.is_empty() { Err(Fault::Empty.whole()) } else { Ok(faces) }
}

fn check_end(words: &mut Words<'_>, expected: &'static str) -> Result<(), Located> {
    words.next().map_or(Ok(()), |_| Err(words.line.expected(expected)))
}

/// Writes the `.vert` half; coordinates read back bit for bit.
pub(super) fn write_positions(out: &mut dyn Write, mesh: &TriMesh, _: Field<'_>) -> io::Result<()> {
    mesh.positions.iter().try_for_each(|p| write_position(out, "", p).and_then(|()| writeln!(out)))
}

/// Writes the `.tri` half.
pub(super) fn write_faces(out: &mut dyn Write, mesh: &TriMesh, _: Field<'_>) -> io::Result<()> {
    let from_one = |face: &[VertexId; 3]| face.map(|v| u64::from(v.0) + 1);
    mesh.faces.iter().map(from_one).try_for_each(|[a, b, c]| writeln!(out, "{a} {b} {c}"))
}
