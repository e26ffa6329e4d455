//! OFF, the Object File Format of Geomview, as text.

use std::io::{self, Write};

use surface::VertexId;

use crate::facts::MeshFile;
use crate::field::WrittenField;
use crate::limits::ReadLimits;
use crate::located::{At, Located};
use crate::polygons::Polygons;
use crate::text::{
    Line, Lines, Words, check_is_not_utf16, check_is_text, excerpt, parse_integer, parse_position,
    parse_vertex,
};
use mesh::Fault;
use mesh::TriMesh;

/// The fewest bytes of a vertex, `0 0 0` and a line end, and of a face, `3 0 1 2` and a line end.
const SHORTEST_VERTEX: usize = 6;
const SHORTEST_FACE: usize = 8;

/// Checks the keyword, and that text follows.
pub(super) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    check_is_not_utf16(start)?;
    if let Some(header) = Lines::new(start).next() {
        after_keyword(header)?;
    }
    check_is_text(start, "an OFF file")
}

/// Reads OFF, COFF, NOFF, STOFF and their combinations. Normals, colours and texture coordinates, which
/// follow the position of a vertex, are ignored.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let bytes = files[0];
    parse_lines(bytes, limits).or_else(|fault| parse_words(bytes, limits).ok_or(fault))
}

/// Reads a file with a line for each vertex and each face.
fn parse_lines(bytes: &[u8], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let mut lines = Lines::new(bytes);
    let header = lines.next().ok_or_else(|| Fault::Empty.whole())?;
    let counts = match after_keyword(header)? {
        [] => lines
            .next()
            .ok_or_else(|| Fault::cut_short("the counts of vertices and faces").in_line(lines.number()))?,
        rest => Line { text: rest, ..header },
    };
    let (n_vertices, n_faces) = parse_counts(counts)?;
    limits.check(n_vertices, n_faces).map_err(|fault| fault.in_line(counts.number))?;
    parse_rows(Words::new(lines, false), n_vertices, n_faces, limits)
}

/// Reads a file whose lines end elsewhere. Without colours and normals, words alone tell where a vertex and a face end.
fn parse_words(bytes: &[u8], limits: &ReadLimits) -> Option<MeshFile> {
    let mut words = Words::new(Lines::new(bytes), true);
    words.next().filter(|keyword| keyword.eq_ignore_ascii_case(b"OFF"))?;
    let mut count = || u64::try_from(parse_integer(words.next()?)?).ok();
    let [n_vertices, n_faces, _] = [count()?, count()?, count()?];
    limits.check(n_vertices, n_faces).ok()?;
    parse_rows(words, n_vertices, n_faces, limits).ok()
}

/// Reads the vertices and the faces that the header promises.
fn parse_rows(
    mut words: Words<'_>,
    n_vertices: u64,
    n_faces: u64,
    limits: &ReadLimits,
) -> Result<MeshFile, Located> {
    let room = words.lines.remaining();
    let mut positions = Vec::with_capacity((n_vertices as usize).min(room / SHORTEST_VERTEX));
    for found in 0..n_vertices {
        let line = words.row().ok_or_else(|| truncated(&words, "vertices", n_vertices, found))?;
        positions.push(parse_position(line, &mut words, found as usize)?);
    }
    let room = words.lines.remaining();
    let mut polygons = Polygons::with_room_for((n_faces as usize).min(room / SHORTEST_FACE));
    let mut corners = Vec::new();
    for found in 0..n_faces {
        let line = words.row().ok_or_else(|| truncated(&words, "faces", n_faces, found))?;
        parse_corners(line, &mut words, n_vertices, &mut corners)?;
        polygons.push(&positions, &corners, limits).map_err(|fault| fault.in_line(line.number))?;
    }
    if let Some(line) = words.row() {
        return Err(Fault::Leftover { items: "faces", promised: n_faces }.in_line(line.number));
    }
    polygons.finish(positions, limits)
}

fn truncated(words: &Words<'_>, items: &str, promised: u64, found: u64) -> Located {
    Fault::truncated(items, promised, found).in_line(words.lines.number())
}

/// The rest of the header line after the keyword: nothing, or the counts, even without a space between.
fn after_keyword(header: Line<'_>) -> Result<&[u8], Located> {
    let text = header.text;
    let not_off = || {
        let found = format!("it begins with `{}`", excerpt(text));
        Fault::wrong_format("an OFF file", found).in_line(header.number)
    };
    let at = text.windows(3).take(6).position(|w| w.eq_ignore_ascii_case(b"OFF")).ok_or_else(not_off)?;
    let (mut prefix, rest) = (&text[..at], text[at + 3..].trim_ascii());
    // The order is ST, C, N, but MeshLab writes NCOFF.
    let mut parts = vec![&b"ST"[..], b"C", b"N"];
    while let Some(found) = parts.iter().position(|part| prefix.starts_with(part)) {
        prefix = &prefix[parts.remove(found).len()..];
    }
    let unsupported = |what, remedy| Err(Fault::unsupported(what, remedy).in_line(header.number));
    if matches!(prefix, b"4" | b"n" | b"4n") {
        let remedy = "project them to three and save as OFF";
        return unsupported("vertices of four or more dimensions", remedy);
    }
    if !prefix.is_empty() {
        return Err(not_off());
    }
    if rest.starts_with(b"BINARY") {
        return unsupported("a binary OFF file", "save it as text OFF or as binary PLY");
    }
    Ok(rest)
}

/// Numbers of vertices and faces; the number of edges may follow and is ignored.
fn parse_counts(line: Line<'_>) -> Result<(u64, u64), Located> {
    let expected = || line.expected("the counts of vertices, faces and edges");
    let counts: Option<Vec<u64>> =
        line.tokens().take(4).map(|t| parse_integer(t).and_then(|n| u64::try_from(n).ok())).collect();
    match *counts.ok_or_else(expected)? {
        [vertices, faces] | [vertices, faces, _] => Ok((vertices, faces)),
        _ => Err(expected()),
    }
}

/// Reads the corners of one face into `corners`; colours may follow and are ignored.
fn parse_corners<'a>(
    line: Line<'a>,
    words: &mut Words<'a>,
    n_vertices: u64,
    corners: &mut Vec<VertexId>,
) -> Result<(), Located> {
    let expected = "a number of corners and that many vertices";
    let n_corners = words.next().and_then(parse_integer).filter(|n| *n >= 0);
    corners.clear();
    for _ in 0..n_corners.ok_or_else(|| line.expected(expected))? {
        corners.push(parse_vertex(line, words, [0, n_vertices], expected)?);
    }
    Ok(())
}

/// Writes OFF; coordinates read back bit for bit. With a colour per vertex it is COFF, which has no place for values.
pub(super) fn write(out: &mut dyn Write, mesh: &TriMesh, field: WrittenField<'_>) -> io::Result<()> {
    let keyword = if field.is_some() { "COFF" } else { "OFF" };
    writeln!(out, "{keyword}\n{} {} 0", mesh.n_vertices(), mesh.n_faces())?;
    for (v, p) in mesh.positions.iter().enumerate() {
        write!(out, "{:?} {:?} {:?}", p.x, p.y, p.z)?;
        if let Some([r, g, b]) = field.map(|field| field.colors[v]) {
            write!(out, " {r} {g} {b} 255")?;
        }
        writeln!(out)?;
    }
    mesh.faces.iter().try_for_each(|[a, b, c]| writeln!(out, "3 {a} {b} {c}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::located::Located;
    use mesh::Place;

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
