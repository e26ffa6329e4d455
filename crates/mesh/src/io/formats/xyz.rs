//! Point clouds as text: a point per line, as in `.xyz` and `.pts` files.

use crate::error::{Fault, Located};
use crate::io::facts::MeshFile;
use crate::io::limits::ReadLimits;
use crate::io::polygons::finish;
use crate::io::text::{Line, Lines, check_is_text, parse_number, parse_position};
use crate::tri_mesh::TriMesh;

/// The fewest bytes of a line: three digits, two separators, a line end.
const SHORTEST_LINE: usize = 6;

/// Checks that the file is text.
pub(super) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    check_is_text(start, "a file of points")
}

/// Reads three coordinates per line, separated by blanks, commas or semicolons. What follows them (intensity, colour,
/// normal) is ignored, and so is a first line of names, such as `//X Y Z`. A line with a single integer, as `.pts` files
/// begin with, promises so many points.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let bytes = files[0];
    let mut positions = Vec::with_capacity(bytes.len() / (4 * SHORTEST_LINE));
    let mut promised: Option<u64> = None;
    let mut is_first = true;
    for line in Lines::new(bytes) {
        let begins_file = std::mem::replace(&mut is_first, false);
        if begins_file && is_names(line) {
            continue;
        }
        if let Some(count) = count(line) {
            promised = Some(promised.unwrap_or(0).saturating_add(count));
            continue;
        }
        positions.push(parse_position(line, &mut numbers(line), positions.len() + 1)?);
        limits.check(positions.len() as u64, 0).map_err(|fault| fault.in_line(line.number))?;
    }
    if is_first {
        return Err(Fault::Empty.whole());
    }
    let found = positions.len() as u64;
    match promised {
        Some(promised) if promised > found => Err(Fault::truncated("points", promised, found).whole()),
        Some(promised) if promised < found => Err(Fault::Leftover { items: "points", promised }.whole()),
        _ => finish(TriMesh { positions, faces: Vec::new() }, limits),
    }
}

fn numbers(line: Line<'_>) -> impl Iterator<Item = &[u8]> {
    let is_separator = |b: &u8| b.is_ascii_whitespace() || matches!(b, b',' | b';');
    line.text.split(is_separator).filter(|token| !token.is_empty())
}

/// The number of points that a line promises.
fn count(line: Line<'_>) -> Option<u64> {
    let mut numbers = numbers(line);
    numbers.next().filter(|_| numbers.next().is_none()).and_then(parse_number)
}

/// Whether a line names the columns.
fn is_names(line: Line<'_>) -> bool {
    line.text.starts_with(b"//") || numbers(line).next().is_some_and(|name| name.eq_ignore_ascii_case(b"x"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;

    /// Twelve lines of points.
    fn rows(separator: &str, rest: &str) -> String {
        (0..12).map(|i| format!("{i}{separator}0.5{separator}-1e1{rest}\n")).collect()
    }

    fn fault(text: &str) -> (Place, Fault) {
        let Located { place, fault, .. } = parse(&[text.as_bytes()], &ReadLimits::default()).unwrap_err();
        (place, fault)
    }

    #[test]
    fn points_parse_with_any_separator_names_counts_and_further_columns() {
        let texts = [
            rows(" ", ""),
            rows(", ", ""),
            rows(";", " 255 0 0"),
            format!("//X Y Z Intensity\n{}", rows("\t", "\t.7")),
            format!("x,y,z\n{}", rows(",", "")),
            format!("12\n{}", rows(" ", " -1000 10 20 30")),
            format!("# scan\n7\n{0}", rows(" ", "").replacen("7 0.5", "5\n7 0.5", 1)),
        ];
        for text in texts {
            let found = parse(&[text.as_bytes()], &ReadLimits::default()).unwrap().mesh;
            assert_eq!((found.n_vertices(), found.n_faces()), (12, 0), "{text}");
            assert_eq!(found.positions[11], nalgebra::Point3::new(11.0, 0.5, -10.0));
        }
    }

    #[test]
    fn faults_name_the_line() {
        assert!(matches!(fault("0 0 0\n1 a 0\n"), (Place::Line(2), Fault::Syntax { .. })));
        assert!(matches!(fault("0 0 0\n1 0\n"), (Place::Line(2), Fault::Syntax { .. })));
        assert!(matches!(fault("0 0 inf\n"), (Place::Line(1), Fault::NonFinite { .. })));
        assert_eq!(fault("0 0 0\n"), (Place::File, Fault::NoFaces { n_vertices: 1 }));
        assert_eq!(fault("\n"), (Place::File, Fault::Empty));
        let truncated = Fault::Truncated { items: "points".into(), promised: 13, found: 12 };
        assert_eq!(fault(&format!("13\n{}", rows(" ", ""))), (Place::File, truncated));
        let leftover = Fault::Leftover { items: "points", promised: 11 };
        assert_eq!(fault(&format!("11\n{}", rows(" ", ""))), (Place::File, leftover));
        // Chemists use the extension too.
        assert!(matches!(fault("2\nwater\nO 0 0 0\n"), (Place::Line(2), Fault::Syntax { .. })));
    }

    #[test]
    fn points_beyond_the_limit_are_refused() {
        let limits = ReadLimits::of_vertices(11);
        let fault = parse(&[rows(" ", "").as_bytes()], &limits).unwrap_err().fault;
        assert_eq!(fault, Fault::OverLimit { items: "vertices", limit: 11 });
    }
}
