//! Lines and numbers of text files, straight from bytes.

use std::io::{self, Write};
use std::str::FromStr;

use mesh::Fault;
use nalgebra::Point3;
use surface::VertexId;

use crate::located::{At, Located};
use crate::polygons::finite;

/// The non-blank lines of a text, without comments, surrounding blanks and line ends of any system.
#[derive(Debug, Clone)]
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    /// Number of the last line read.
    pub(crate) number: usize,
}

/// One line; never empty.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line<'a> {
    /// Counted from one.
    pub(crate) number: usize,
    pub(crate) text: &'a [u8],
}

impl<'a> Lines<'a> {
    /// The lines of `bytes`.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), number: 0 }
    }

    /// Number of unread bytes.
    pub(crate) fn remaining(&self) -> usize {
        self.rest.len()
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        while !self.rest.is_empty() {
            let is_end = |b: &u8| matches!(b, b'\n' | b'\r');
            let end = self.rest.iter().position(is_end).unwrap_or(self.rest.len());
            let (text, tail) = self.rest.split_at(end);
            self.rest = tail.strip_prefix(b"\r\n").or_else(|| tail.get(1..)).unwrap_or_default();
            self.number += 1;
            let text = without_comment(text).trim_ascii();
            if !text.is_empty() {
                return Some(Line { number: self.number, text });
            }
        }
        None
    }
}

/// A comment begins at a `#` that begins a word: within a word, as in the `1.#QNAN` of older C libraries, it is no comment.
fn without_comment(text: &[u8]) -> &[u8] {
    let begins_word = |at: &usize| text[*at] == b'#' && (*at == 0 || text[at - 1].is_ascii_whitespace());
    &text[..(0..text.len()).find(begins_word).unwrap_or(text.len())]
}

impl<'a> Line<'a> {
    /// The words of the line.
    pub(crate) fn tokens(self) -> impl Iterator<Item = &'a [u8]> {
        self.text.split(u8::is_ascii_whitespace).filter(|token| !token.is_empty())
    }

    /// The fault that this line is not what the format requires.
    pub(crate) fn expected(self, expected: &'static str) -> Located {
        Fault::syntax(expected, excerpt(self.text)).in_line(self.number)
    }
}

/// Words of a text one after the other, within a line or across lines.
#[derive(Debug, Clone)]
pub(crate) struct Words<'a> {
    pub(crate) lines: Lines<'a>,
    /// The line of the last word.
    pub(crate) line: Line<'a>,
    /// What is left of it.
    pub(crate) rest: &'a [u8],
    /// Whether words of the next line follow those of a line.
    crosses_lines: bool,
}

impl<'a> Words<'a> {
    pub(crate) fn new(lines: Lines<'a>, crosses_lines: bool) -> Self {
        Self { line: Line { number: lines.number, text: &[] }, rest: &[], lines, crosses_lines }
    }

    /// Begins a row: in the next line, or right after the last word if words cross lines. `None` at the end of the text.
    pub(crate) fn row(&mut self) -> Option<Line<'a>> {
        if !self.crosses_lines || self.rest.is_empty() {
            self.line = self.lines.next()?;
            self.rest = self.line.text;
        }
        Some(self.line)
    }

    /// Whether the rest of the line begins with these words, in upper or lower case.
    pub(crate) fn begins_with(&self, phrase: &[&str]) -> bool {
        let mut rest = Line { text: self.rest, ..self.line }.tokens();
        phrase.iter().all(|word| rest.next().is_some_and(|found| found.eq_ignore_ascii_case(word.as_bytes())))
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() && self.crosses_lines {
            self.row()?;
        }
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest.trim_ascii_start();
        (!word.is_empty()).then_some(word)
    }
}

/// Refuses the start of a text file that is encoded as UTF-16 or holds zero bytes, as binary data and files with holes do.
pub(crate) fn check_is_text(start: &[u8], expected: &'static str) -> Result<(), Located> {
    check_is_not_utf16(start)?;
    start.iter().position(|byte| *byte == 0).map_or(Ok(()), |at| {
        Err(Fault::wrong_format(expected, "it is not text but has zero bytes").at_byte(at))
    })
}

/// Refuses text in UTF-16: it begins with a byte order mark, or every other byte is zero.
pub(crate) fn check_is_not_utf16(start: &[u8]) -> Result<(), Located> {
    let is_utf16 = match *start {
        [0xff, 0xfe, _, 0, ..] | [0xfe, 0xff, 0, _, ..] => true,
        [a, 0, b, 0, ..] | [0, a, 0, b, ..] => a > 0 && b > 0,
        _ => false,
    };
    match is_utf16 {
        true => Err(Fault::unsupported("the text is encoded as UTF-16", "save it as UTF-8").whole()),
        false => Ok(()),
    }
}

/// The fault that a file begins with something else than its name promises.
pub(crate) fn other_format(expected: &'static str, start: &[u8]) -> Fault {
    Fault::wrong_format(expected, format!("it begins with `{}`", excerpt(start)))
}

/// The beginning of a text, fit for an error message.
pub(crate) fn excerpt(text: &[u8]) -> String {
    const LONGEST: usize = 40;
    let lossy = String::from_utf8_lossy(&text[..text.len().min(4 * LONGEST)]);
    let clean: String =
        lossy.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).take(LONGEST).collect();
    if clean.len() < text.len() { clean + "..." } else { clean }
}

/// A number; a floating-point one may be NaN or infinite.
pub(crate) fn parse_number<T: FromStr>(token: &[u8]) -> Option<T> {
    std::str::from_utf8(token).ok()?.parse().ok()
}

/// An integer, also one written as `3.0` or `3.000e+00`.
pub(crate) fn parse_integer(token: &[u8]) -> Option<i64> {
    parse_number(token).or_else(|| {
        let value: f64 = parse_number(token)?;
        (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
    })
}

/// The next word of a line as a vertex, counted from `first`.
pub(crate) fn parse_vertex<'a>(
    line: Line<'a>,
    words: &mut impl Iterator<Item = &'a [u8]>,
    [first, n_vertices]: [u64; 2],
    expected: &'static str,
) -> Result<VertexId, Located> {
    let word = words.next().unwrap_or_default();
    let index = parse_integer(word).ok_or_else(|| line.expected(expected))?;
    let vertex = index.checked_sub_unsigned(first).and_then(|vertex| u64::try_from(vertex).ok());
    vertex.filter(|vertex| *vertex < n_vertices).map_or_else(
        || Err(Fault::no_vertex(excerpt(word), first, n_vertices).in_line(line.number)),
        |vertex| Ok(VertexId(vertex as u32)),
    )
}

/// The first three words of a line as a position; `vertex` only appears in messages.
pub(crate) fn parse_position<'a>(
    line: Line<'a>,
    words: &mut impl Iterator<Item = &'a [u8]>,
    vertex: usize,
) -> Result<Point3<f64>, Located> {
    let mut p = [0.0; 3];
    for x in &mut p {
        *x = words.next().and_then(parse_number).ok_or_else(|| line.expected("three coordinates"))?;
    }
    finite(p, vertex).in_line(line.number)
}

/// Writes a position after `prefix`; it reads back bit for bit.
pub(crate) fn write_position(out: &mut dyn Write, prefix: &str, p: &Point3<f64>) -> io::Result<()> {
    write!(out, "{prefix}{:?} {:?} {:?}", p.x, p.y, p.z)
}
