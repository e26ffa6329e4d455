//! Lines and numbers straight from bytes, without a string per token.

use nalgebra::Point3;

use crate::error::{Fault, Located};

/// The lines of a text that hold something, with comments, blanks and line ends of any system
/// taken off.
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

    /// Number of bytes not read yet.
    pub(super) fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// The number of the line read last.
    pub(super) fn number(&self) -> usize {
        self.number
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(self.rest.len());
            let (line, tail) = self.rest.split_at(end);
            self.rest = tail.strip_prefix(b"\r\n").or_else(|| tail.get(1..)).unwrap_or_default();
            self.number += 1;
            let text = line.split(|&b| b == b'#').next().unwrap_or_default().trim_ascii();
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
        tokens(self.text)
    }

    /// The fault that this line should read otherwise.
    pub(super) fn expected(self, expected: &'static str) -> Located {
        Fault::Syntax { expected, found: excerpt(self.text) }.in_line(self.number)
    }
}

/// The words of a text.
pub(super) fn tokens(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace).filter(|token| !token.is_empty())
}

/// The beginning of a text, fit for an error message.
pub(super) fn excerpt(text: &[u8]) -> String {
    const LONGEST: usize = 40;
    let lossy = String::from_utf8_lossy(&text[..text.len().min(4 * LONGEST)]);
    let clean: String =
        lossy.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).take(LONGEST).collect();
    if clean.len() < text.len() { clean + "..." } else { clean }
}

/// A floating-point number; NaN and infinities are numbers here.
pub(super) fn parse_f64(token: &[u8]) -> Option<f64> {
    std::str::from_utf8(token).ok()?.parse().ok()
}

/// A whole number, also where a program has written it as `3.0` or `3.000e+00`.
pub(super) fn parse_integer(token: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(token).ok()?;
    text.parse().ok().or_else(|| {
        let value: f64 = text.parse().ok()?;
        (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
    })
}

/// The first three words of a line as the position of vertex `vertex`, which only serves messages.
pub(super) fn parse_position<'a>(
    line: Line<'a>,
    tokens: &mut impl Iterator<Item = &'a [u8]>,
    vertex: usize,
) -> Result<Point3<f64>, Located> {
    let mut p = [0.0; 3];
    for x in &mut p {
        *x = tokens.next().and_then(parse_f64).ok_or_else(|| line.expected("three coordinates"))?;
        if !x.is_finite() {
            return Err(Fault::NonFinite { vertex: vertex as u64, value: *x }.in_line(line.number));
        }
    }
    Ok(Point3::from(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_every_system_are_numbered_alike() {
        for text in
            ["a\n\n#x\nb c # d", "a\r\n\r\n#x\r\nb c # d\r\n", "a\r\r#x\rb c\r", "\u{feff}a\n\n\n b c"]
        {
            let found: Vec<_> = Lines::new(text.as_bytes()).map(|l| (l.number, l.text)).collect();
            assert_eq!(found, [(1, &b"a"[..]), (4, &b"b c"[..])], "{text:?}");
        }
    }

    #[test]
    fn numbers_in_every_notation() {
        assert_eq!(parse_f64(b"-1.5e3"), Some(-1500.0));
        assert_eq!(parse_f64(b".5"), Some(0.5));
        assert_eq!(parse_f64(b"5."), Some(5.0));
        assert!(parse_f64(b"nan").is_some_and(f64::is_nan));
        assert_eq!(parse_f64(b"1,5"), None);
        assert_eq!(parse_f64(b"\xff"), None);
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
