//! OFF, the Object File Format of Geomview, as text.

use crate::prelude::*;

/// The fewest bytes of a vertex, `0 0 0` and a line end, and of a face, `3 0 1 2` and a line end.
const SHORTEST_VERTEX: usize = 6;
const SHORTEST_FACE: usize = 8;

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
    let room = words.lines.remaining() / SHORTEST_VERTEX;
    let mut positions = Vec::with_capacity(room.min(n_vertices as usize));
    for found in 0..n_vertices {
        let line = words.row().ok_or_else(|| truncated(&words, "vertices", n_vertices, found))?;
        positions.push(parse_position(line, &mut words, found as usize)?);
    }
    let room = words.lines.remaining() / SHORTEST_FACE;
    let mut polygons = Polygons::with_room_for(room.min(n_faces as usize));
    let mut corners = Vec::new();
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
        Some(line) => Err(Fault::Leftover { items: "faces", promised: n_faces }.in_line(line.number)),
        None => polygons.finish(positions, limits),
    }
}

/// What is before the keyword `OFF` in the header, and the rest of the line: nothing, or the counts, even without a space
/// between.
fn after_keyword(header: Line<'_>) -> Result<(&[u8], &[u8]), Located> {
    let not_off = || {
        let found = format!("it begins with `{}`", excerpt(header.text));
        Fault::wrong_format("an OFF file", found).in_line(header.number)
    };
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

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(bytes: &[u8]) -> Result<TriMesh, Located> {
        super::parse(&[bytes], &ReadLimits::default()).map(|file| file.mesh)
    }

    const SQUARE: &str = "4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

    fn fault(text: &str) -> (Place, Fault) {
        let Located { place, fault, .. } = parse(text.as_bytes()).unwrap_err();
        (place, fault)
    }

    #[test]
    fn headers_parse_in_every_dialect() {
        let expected = parse(format!("OFF\n{SQUARE}").as_bytes()).unwrap();
        assert_eq!(expected.faces.len(), 2);
        for header in ["OFF ", "OFF", "off\n", "# c\nOFF # c\n\n", "\u{feff}OFF\r\n"] {
            assert_eq!(parse(format!("{header}{SQUARE}").as_bytes()).unwrap(), expected, "{header:?}");
        }
        assert_eq!(parse(format!("OFF\n{}", SQUARE.replace('\n', "\r\n")).as_bytes()).unwrap(), expected);
        let two_counts = SQUARE.replace("4 1 4\n", "4 1\n");
        assert_eq!(parse(format!("OFF\n{two_counts}").as_bytes()).unwrap(), expected);
    }

    #[test]
    fn values_after_position_and_corners_are_ignored() {
        let plain = parse(b"OFF 3 1 3 \n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").unwrap();
        for text in [
            "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 0 0 255\n0 1 0 9 9 9 9\n3 0 1 2 0.5 0.5 0.5\n",
            "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n",
            "NCOFF\n3 1 0\n0 0 0 0 0 1 9 9 9 9\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2 7\n",
            "STCNOFF\n3 1 0\n0 0 0 0 0 1 9 9 9 9 .1 .2\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2 7\n",
        ] {
            assert_eq!(parse(text.as_bytes()).unwrap(), plain);
        }
    }

    #[test]
    fn faults_name_the_line() {
        let truncated =
            |items: &str, promised, found| Fault::Truncated { items: items.into(), promised, found };
        assert_eq!(fault("OFF\n4 1 0\n0 0 0\n"), (Place::Line(3), truncated("vertices", 4, 1)));
        assert_eq!(fault("OFF\n1 2 0\n0 0 0\n3 0 0 0\n"), (Place::Line(4), truncated("faces", 2, 1)));
        let index = Fault::IndexOutOfRange { index: "3".into(), first: 0, last: 2 };
        assert_eq!(fault("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), (Place::Line(6), index));
        assert!(matches!(
            fault("OFF\n1 1 0\n0 nan 0\n"),
            (Place::Line(3), Fault::NonFinite { vertex: 0, value }) if value.is_nan()
        ));
        assert!(matches!(fault("OFF\n1 1 0\n0 inf 0\n").1, Fault::NonFinite { .. }));
        assert_eq!(
            fault("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n"),
            (Place::Line(7), Fault::Leftover { items: "faces", promised: 1 })
        );
        assert!(matches!(fault("OFF\n3 1 0\n0 0\n"), (Place::Line(3), Fault::Syntax { .. })));
        assert!(matches!(fault("OFF\nthree\n"), (Place::Line(2), Fault::Syntax { .. })));
        assert!(matches!(fault("OFF\n-3 1 0\n"), (Place::Line(2), Fault::Syntax { .. })));
        assert!(matches!(fault("OFF\n"), (Place::Line(1), Fault::CutShort { .. })));
        assert_eq!(fault("OFF 1 0 0\n0 0 0\n"), (Place::File, Fault::NoFaces { n_vertices: 1 }));
        assert_eq!(
            fault("OFF 2 1 0\n0 0 0\n1 0 0\n2 0 1\n"),
            (Place::Line(4), Fault::TooFewCorners { corners: 2 })
        );
        assert_eq!(fault(" \n# nothing\n"), (Place::File, Fault::Empty));
    }

    #[test]
    fn other_formats_are_not_mistaken_for_off() {
        for text in ["ply\nformat", "v 0 0 0\n", "\u{0}\u{1}\u{2}", "XOFF\n", "CCOFF\n"] {
            assert!(matches!(fault(text), (Place::Line(1), Fault::WrongFormat { .. })), "{text:?}");
        }
        for text in ["4OFF\n", "nOFF 3\n", "OFF BINARY\n"] {
            assert!(matches!(fault(text), (Place::Line(1), Fault::Unsupported { .. })), "{text:?}");
        }
    }

    #[test]
    fn large_counts_in_the_header_allocate_nothing() {
        let text = "OFF\n4000000000 1000000000 0\n0 0 0\n";
        assert!(matches!(fault(text).1, Fault::Truncated { promised: 4_000_000_000, found: 1, .. }));
        assert!(matches!(fault("OFF\n5000000000 1 0\n").1, Fault::TooLarge { .. }));
    }
}
