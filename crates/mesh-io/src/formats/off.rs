//! OFF, the Object File Format of Geomview, as text.

use crate::prelude::*;

/// Checks the keyword, and that text follows.
pub(super) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    check_is_not_utf16(start)?;
    Lines::new(start).next().map_or(Ok(()), |header| after_keyword(header).map(drop))?;
    check_is_text(start, "an OFF file")
}

/// Reads OFF, COFF, NOFF, STOFF and their combinations. Normals, colors and texture coordinates, which
/// follow the position of a vertex, are ignored.
///
/// A vertex or a face has a line. Without colors and normals, lines may end elsewhere: words alone tell where it ends.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    parse_words(files[0], false, limits)
        .or_else(|fault| parse_words(files[0], true, limits).map_err(|_| fault))
}

fn parse_words(bytes: &[u8], crosses_lines: bool, limits: &ReadLimits) -> Result<MeshFile, Located> {
    let mut words = Words::new(Lines::new(bytes), crosses_lines);
    let header = words.row().ok_or_else(|| Fault::Empty.whole())?;
    let (prefix, rest) = after_keyword(header)?;
    words.rest = rest;
    if rest.is_empty() && words.row().is_none() {
        return Err(Fault::cut_short("the counts of vertices and faces").in_line(words.lines.number));
    }
    let counts = words.line.number;
    let expected =
        Line { text: words.rest, number: counts }.expected("the counts of vertices, faces and edges");
    let parse_count = |word| parse_integer(word).and_then(|n| u64::try_from(n).ok());
    let found = words.by_ref().take(if crosses_lines { 3 } else { 4 }).map(parse_count);
    let (n_vertices, n_faces) = match *found.collect::<Vec<_>>() {
        // The number of edges is ignored.
        [Some(n_vertices), Some(n_faces)] | [Some(n_vertices), Some(n_faces), Some(_)]
            if prefix.is_empty() || !crosses_lines =>
        {
            (n_vertices, n_faces)
        }
        _ => return Err(expected),
    };
    limits.check(n_vertices, n_faces).in_line(counts)?;

    let truncated = |words: &Words<'_>, items: &str, promised, found| {
        Fault::truncated(items, promised, found).in_line(words.lines.number)
    };
    let mut positions = Vec::new();
    for found in 0..n_vertices {
        let line = words.row().ok_or_else(|| truncated(&words, "vertices", n_vertices, found))?;
        positions.push(parse_position(line, &mut words, found as usize)?);
    }
    let (mut polygons, mut corners) = (Polygons::default(), Vec::new());
    for found in 0..n_faces {
        let line = words.row().ok_or_else(|| truncated(&words, "faces", n_faces, found))?;
        let expected = "a number of corners and that many vertices";
        let n_corners = words.next().and_then(parse_integer).filter(|n| *n >= 0);
        corners.clear();
        for _ in 0..n_corners.ok_or_else(|| line.expected(expected))? {
            corners.push(parse_vertex(line, &mut words, [0, n_vertices], expected)?);
        }
        polygons.push(&positions, &corners, limits).in_line(line.number)?;
    }
    match words.row() {
        Some(line) => Err(Fault::leftover("faces", n_faces).in_line(line.number)),
        None => polygons.finish(positions, limits),
    }
}

/// What is before the keyword `OFF` in the header, and the rest of the line: nothing, or the counts, even without a space
/// between.
fn after_keyword(header: Line<'_>) -> Result<(&[u8], &[u8]), Located> {
    let not_off = || other_format("an OFF file", header.text).in_line(header.number);
    let at =
        header.text.windows(3).take(6).position(|w| w.eq_ignore_ascii_case(b"OFF")).ok_or_else(not_off)?;
    let (prefix, rest) = (&header.text[..at], header.text[at + 3..].trim_ascii());
    // The order is ST, C, N, but MeshLab writes NCOFF.
    let (mut unknown, mut parts) = (prefix, vec![&b"ST"[..], b"C", b"N"]);
    while let Some(found) = parts.iter().position(|part| unknown.starts_with(part)) {
        unknown = &unknown[parts.remove(found).len()..];
    }
    let (what, remedy) = match unknown {
        b"4" | b"n" | b"4n" => {
            ("vertices of four or more dimensions", "project them to three and save as OFF")
        }
        [_, ..] => return Err(not_off()),
        [] if rest.starts_with(b"BINARY") => ("a binary OFF file", "save it as text OFF or as binary PLY"),
        [] => return Ok((prefix, rest)),
    };
    Err(Fault::unsupported(what, remedy).in_line(header.number))
}

/// Writes OFF; coordinates read back bit for bit. With a color per vertex it is COFF, which has no place for values.
pub(super) fn write(out: &mut dyn Write, mesh: &TriMesh, field: Field<'_>) -> io::Result<()> {
    let keyword = if field.is_some() { "COFF" } else { "OFF" };
    writeln!(out, "{keyword}\n{} {} 0", mesh.n_vertices(), mesh.n_faces())?;
    for (v, p) in mesh.positions.iter().enumerate() {
        write_position(out, "", p)?;
        match field.map(|field| field.colors[v]) {
            Some([r, g, b]) => writeln!(out, " {r} {g} {b} 255")?,
            None => writeln!(out)?,
        }
    }
    mesh.faces.iter().try_for_each(|[a, b, c]| writeln!(out, "3 {a} {b} {c}"))
}
