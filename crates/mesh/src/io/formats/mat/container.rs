//! The MAT-file level 5 container: a 128-byte header, then tagged elements, compressed or not.
//!
//! Everything is read as a stream with a budget, so that a wrong length costs no memory and a
//! decompression bomb is cut off.

use std::io::{self, Read};

use crate::error::{Fault, Located};
use crate::io::binary::{ByteOrder, Scalar};

pub(super) const HEADER: usize = 128;

/// Types of elements.
pub(super) const MATRIX: u32 = 14;
pub(super) const COMPRESSED: u32 = 15;

/// Type and length in bytes of an element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tag {
    pub(super) kind: u32,
    pub(super) length: u32,
    /// Up to four bytes of data are stored in the tag itself.
    inline: Option<[u8; 4]>,
}

/// A stream of elements.
pub(super) struct Elements<'a> {
    source: Box<dyn Read + 'a>,
    pub(super) order: ByteOrder,
    /// Bytes that may still be read.
    budget: u64,
    limit: u64,
    /// Byte of the file at which the stream begins, for messages.
    pub(super) start: usize,
}

/// Reads the header of the file.
pub(super) fn parse_header(bytes: &[u8]) -> Result<ByteOrder, Located> {
    let wrong = |found: &str| Fault::WrongFormat { expected: "a MATLAB 5 file", found: found.into() }.whole();
    if bytes.starts_with(b"MATLAB 7.3") || bytes.starts_with(b"\x89HDF") {
        return Err(Fault::Unsupported {
            what: "this is a MATLAB 7.3 file".into(),
            remedy: "save it with `save -v7`",
        }
        .whole());
    }
    if bytes.trim_ascii().is_empty() {
        return Err(Fault::Empty.whole());
    }
    match bytes.get(124..HEADER) {
        Some([_, 1, b'I', b'M']) => Ok(ByteOrder::Little),
        Some([1, _, b'M', b'I']) => Ok(ByteOrder::Big),
        Some(_) => Err(wrong("its header lacks the version and byte order")),
        None => Err(wrong("it is shorter than the header")),
    }
}

impl<'a> Elements<'a> {
    /// The elements in `source`; reads at most `limit` bytes.
    pub(super) fn new(source: impl Read + 'a, order: ByteOrder, limit: u64, start: usize) -> Self {
        Self { source: Box::new(source), order, budget: limit, limit, start }
    }

    /// Lowers the number of bytes that may still be read to the declared length of an element.
    pub(super) fn limit_to(&mut self, declared: u64) {
        self.budget = self.budget.min(declared);
    }

    /// Reads the next tag.
    pub(super) fn tag(&mut self) -> Result<Tag, Located> {
        let mut word = [0; 4];
        self.fill(&mut word, "the tag of an element")?;
        let first = self.u32(word);
        self.fill(&mut word, "the tag of an element")?;
        Ok(match first >> 16 {
            0 => Tag { kind: first, length: self.u32(word), inline: None },
            length => Tag { kind: first & 0xffff, length, inline: Some(word) },
        })
    }

    /// Reads the data of an element and skips the padding after it.
    pub(super) fn data(&mut self, tag: Tag) -> Result<Vec<u8>, Located> {
        if let Some(word) = tag.inline {
            let data = word.get(..tag.length as usize);
            return data.map(<[u8]>::to_vec).ok_or_else(|| self.broken("a short element of 4 bytes at most"));
        }
        self.spend(u64::from(tag.length))?;
        let mut data = Vec::new();
        // Grows with the data, not with the declared length.
        let read = self.source.by_ref().take(u64::from(tag.length)).read_to_end(&mut data);
        self.check(read.map(|n| n == tag.length as usize), "the rest of an element")?;
        self.skip(u64::from(tag.length.wrapping_neg() % 8))?;
        Ok(data)
    }

    /// Skips the data of an element.
    pub(super) fn skip_data(&mut self, tag: Tag) -> Result<(), Located> {
        match tag.inline {
            Some(_) => Ok(()),
            None => self.skip(u64::from(tag.length).next_multiple_of(8)),
        }
    }

    /// Reads the data of a short element of a given kind.
    pub(super) fn expect(&mut self, kind: u32, what: &'static str) -> Result<Vec<u8>, Located> {
        const LONGEST: u32 = 1 << 16;
        let tag = self.tag()?;
        if tag.kind != kind || tag.length > LONGEST {
            return Err(self.broken(what));
        }
        self.data(tag)
    }

    /// The fault that `expected` is missing here.
    pub(super) fn broken(&self, expected: &'static str) -> Located {
        Fault::Syntax { expected, found: "other data".into() }.at_byte(self.start)
    }

    fn skip(&mut self, length: u64) -> Result<(), Located> {
        self.spend(length)?;
        let skipped = io::copy(&mut self.source.by_ref().take(length), &mut io::sink());
        self.check(skipped.map(|n| n == length), "the rest of an element")
    }

    fn fill(&mut self, buffer: &mut [u8], what: &str) -> Result<(), Located> {
        self.spend(buffer.len() as u64)?;
        let read = self.source.read_exact(buffer);
        self.check(read.map(|()| true), what)
    }

    fn spend(&mut self, length: u64) -> Result<(), Located> {
        let exceeded = Fault::Inflates { limit: self.limit }.at_byte(self.start);
        self.budget = self.budget.checked_sub(length).ok_or(exceeded)?;
        Ok(())
    }

    /// A short read means that the file ends early; any other error means damaged compression.
    fn check(&self, outcome: io::Result<bool>, what: &str) -> Result<(), Located> {
        match outcome {
            Ok(true) => Ok(()),
            Err(e) if e.kind() != io::ErrorKind::UnexpectedEof => {
                Err(Fault::Syntax { expected: "compressed data", found: e.to_string() }.at_byte(self.start))
            }
            _ => Err(Fault::CutShort { expected: what.into() }.at_byte(self.start)),
        }
    }

    /// A 32-bit word in the byte order of the file.
    pub(super) fn u32(&self, word: [u8; 4]) -> u32 {
        match self.order {
            ByteOrder::Little => u32::from_le_bytes(word),
            ByteOrder::Big => u32::from_be_bytes(word),
        }
    }
}

/// The type behind the number of a numeric element; `None` for any other element.
pub(super) fn scalar(kind: u32) -> Option<Scalar> {
    Some(match kind {
        1 => Scalar::I8,
        2 => Scalar::U8,
        3 => Scalar::I16,
        4 => Scalar::U16,
        5 => Scalar::I32,
        6 => Scalar::U32,
        7 => Scalar::F32,
        9 => Scalar::F64,
        12 => Scalar::I64,
        13 => Scalar::U64,
        _ => return None,
    })
}
