//! Lines and numbers of text files, straight from bytes.

use std::io::{self, Write};
use std::str::FromStr;

use nalgebra::Point3;
use surface::VertexId;

use crate::error::{Fault, Located};

/// The non-blank lines of a text, without comments, surrounding blanks and line ends of any system.
#[derive(Debug, Clone)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

/// One line; never empty.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    /// Counted from one.
    pub(super) number: usize,
    pub(super) text: &'a [u8],
}

impl<'a> Lines<'a> {
    /// The lines of `bytes`; `#` begins a comment.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), number: 0 }
    }

    /// Number of unread bytes.
    pub(super) fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// Number of the last line read.
    pub(super) fn number(&self) -> usize {
        self.number
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        while !self.rest.is_empty() {
            let end_of_text = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r' | b'#'));
            let (text, mut tail) = self.rest.split_at(end_of_text.unwrap_or(self.rest.len()));
            if tail.first() == Some(&b'#') {
                let end_of_line = tail.iter().position(|b| matches!(b, b'\n' | b'\r'));
                tail = &tail[end_of_line.unwrap_or(tail.len())..];
            }
            self.rest = tail.strip_prefix(b"\r\n").or_else(|| tail.get(1..)).unwrap_or_default();
            self.number += 1;
            let text = text.trim_ascii();
            if !text.is_empty() {
                return Some(Line { number: self.number, text });
            }
        }
        None
    }
}

impl<'a> Line<'a> {
    /// The words of the line.
    pub(super) fn tokens(self) -> impl Iterator<Item = &'a [u8]> {
        self.text.split(u8::is_ascii_whitespace).filter(|token| !token.is_empty())
    }

    /// The fault that this line is not what the format requires.
    pub(super) fn expected(self, expected: &'static str) -> Located {
        Fault::syntax(expected, excerpt(self.text)).in_line(self.number)
    }
}

/// Refuses the start of a text file that holds zero bytes, as binary data and files with holes do.
pub(super) fn check_is_text(start: &[u8], expected: &'static str) -> Result<(), Located> {
    match start.iter().position(|byte| *byte == 0) {
        Some(at) => Err(Fault::wrong_format(expected, "it is not text but has zero bytes").at_byte(at)),
        None => Ok(()),
    }
}

/// The beginning of a text, fit for an error message.
pub(super) fn excerpt(text: &[u8]) -> String {
    const LONGEST: usize = 40;
    let lossy = String::from_utf8_lossy(&text[..text.len().min(4 * LONGEST)]);
    let clean: String =
        lossy.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).take(LONGEST).collect();
    if clean.len() < text.len() { clean + "..." } else { clean }
}

/// A number; a floating-point one may be NaN or infinite.
pub(super) fn parse_number<T: FromStr>(token: &[u8]) -> Option<T> {
    std::str::from_utf8(token).ok()?.parse().ok()
}

/// An integer, also one written as `3.0` or `3.000e+00`.
pub(super) fn parse_integer(token: &[u8]) -> Option<i64> {
    parse_number(token).or_else(|| {
        let value: f64 = parse_number(token)?;
        (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
    })
}

/// The next word of a line as a vertex, counted from `first`.
pub(super) fn parse_vertex<'a>(
    line: Line<'a>,
    tokens: &mut impl Iterator<Item = &'a [u8]>,
    [first, n_vertices]: [u64; 2],
    expected: &'static str,
) -> Result<VertexId, Located> {
    let token = tokens.next().ok_or_else(|| line.expected(expected))?;
    let index = parse_integer(token).ok_or_else(|| line.expected(expected))?;
    let vertex = index.checked_sub_unsigned(first).and_then(|vertex| u64::try_from(vertex).ok());
    match vertex.filter(|vertex| *vertex < n_vertices) {
        Some(vertex) => Ok(VertexId(vertex as u32)),
        None => Err(Fault::no_vertex(excerpt(token), first, n_vertices).in_line(line.number)),
    }
}

/// The first three words of a line as a position; `vertex` only appears in messages.
pub(super) fn parse_position<'a>(
    line: Line<'a>,
    tokens: &mut impl Iterator<Item = &'a [u8]>,
    vertex: usize,
) -> Result<Point3<f64>, Located> {
    let mut p = [0.0f64; 3];
    for x in &mut p {
        *x = tokens.next().and_then(parse_number).ok_or_else(|| line.expected("three coordinates"))?;
        if !x.is_finite() {
            return Err(Fault::NonFinite { vertex: vertex as u64, value: *x }.in_line(line.number));
        }
    }
    Ok(Point3::from(p))
}

/// Writes a line with a position after `prefix`; it reads back bit for bit.
pub(super) fn write_position(out: &mut dyn Write, prefix: &str, p: &Point3<f64>) -> io::Result<()> {
    writeln!(out, "{prefix}{:?} {:?} {:?}", p.x, p.y, p.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_numbers_do_not_depend_on_the_line_ends() {
        for text in
            ["a\n\n#x\nb c # d", "a\r\n\r\n#x\r\nb c # d\r\n", "a\r\r#x\rb c\r", "\u{feff}a\n\n\n b c"]
        {
            let found: Vec<_> = Lines::new(text.as_bytes()).map(|l| (l.number, l.text)).collect();
            assert_eq!(found, [(1, &b"a"[..]), (4, &b"b c"[..])], "{text:?}");
        }
    }

    #[test]
    fn numbers_parse_in_every_notation() {
        assert_eq!(parse_number(b"-1.5e3"), Some(-1500.0));
        assert_eq!(parse_number(b".5"), Some(0.5));
        assert_eq!(parse_number(b"5."), Some(5.0));
        assert!(parse_number(b"nan").is_some_and(f64::is_nan));
        assert_eq!(parse_number::<f64>(b"1,5"), None);
        assert_eq!(parse_number::<f64>(b"\xff"), None);
        assert_eq!(parse_integer(b"12"), Some(12));
        assert_eq!(parse_integer(b"1.2000e+01"), Some(12));
        assert_eq!(parse_integer(b"1.5"), None);
        assert_eq!(parse_integer(b"nan"), None);
    }

    #[test]
    fn excerpts_are_short_and_printable() {
        assert_eq!(excerpt(b"1 2"), "1 2");
        assert_eq!(excerpt(b"\x00\xff"), "\u{fffd}\u{fffd}");
        assert!(excerpt(&[b'7'; 1000]).ends_with("777..."));
    }
}
