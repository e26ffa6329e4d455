//! The MAT-file level 5 container: a 128-byte header, then tagged elements, each compressed or not.
//!
//! Everything is read as a stream with a budget, so a length that lies costs no memory and data
//! that inflates without end is cut off.

use std::io::{self, Read};

use crate::error::{Fault, Located};

pub(super) const HEADER: usize = 128;

/// Types of elements.
pub(super) const MATRIX: u32 = 14;
pub(super) const COMPRESSED: u32 = 15;

/// The order of the bytes of every number, from the header.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// Type and length in bytes of an element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tag {
    pub(super) kind: u32,
    pub(super) length: u32,
    /// Lengths up to four sit in the tag itself, together with their data.
    inline: Option<[u8; 4]>,
}

/// A stream of elements.
pub(super) struct Elements<'a> {
    source: Box<dyn Read + 'a>,
    order: ByteOrder,
    /// Bytes that may still be read.
    budget: u64,
    limit: u64,
    /// Where in the file the stream begins, for messages.
    pub(super) start: usize,
}

/// Reads the file's header.
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
        Some(_) => Err(wrong("its header has no version and byte order of one")),
        None => Err(wrong("it is shorter than the header of one")),
    }
}

impl<'a> Elements<'a> {
    /// The elements in `source`, of which at most `limit` bytes are read.
    pub(super) fn new(source: impl Read + 'a, order: ByteOrder, limit: u64, start: usize) -> Self {
        Self { source: Box::new(source), order, budget: limit, limit, start }
    }

    /// Lowers the number of bytes that may still be read to what an element declares.
    pub(super) fn limit_to(&mut self, declared: u64) {
        self.budget = self.budget.min(declared);
    }

    /// The next tag.
    pub(super) fn tag(&mut self) -> Result<Tag, Located> {
        let mut word = [0; 4];
        self.fill(&mut word, "the tag of an element")?;
        let first = self.order.u32(word);
        self.fill(&mut word, "the tag of an element")?;
        Ok(match first >> 16 {
            0 => Tag { kind: first, length: self.order.u32(word), inline: None },
            length => Tag { kind: first & 0xffff, length, inline: Some(word) },
        })
    }

    /// The data of an element, with the padding after it taken off.
    pub(super) fn data(&mut self, tag: Tag) -> Result<Vec<u8>, Located> {
        if let Some(word) = tag.inline {
            let data = word.get(..tag.length as usize);
            return data.map(<[u8]>::to_vec).ok_or_else(|| self.broken("a short element of 4 bytes at most"));
        }
        self.spend(u64::from(tag.length))?;
        let mut data = Vec::new();
        // Grows with what arrives, not with what is promised.
        let read = self.source.by_ref().take(u64::from(tag.length)).read_to_end(&mut data);
        self.check(read.map(|n| n == tag.length as usize), "the rest of an element")?;
        self.skip(u64::from(tag.length.wrapping_neg() % 8))?;
        Ok(data)
    }

    /// Passes over the data of an element.
    pub(super) fn pass(&mut self, tag: Tag) -> Result<(), Located> {
        match tag.inline {
            Some(_) => Ok(()),
            None => self.skip(u64::from(tag.length).next_multiple_of(8)),
        }
    }

    /// Data of an element that must be of one kind and whose length is small.
    pub(super) fn expect(&mut self, kind: u32, what: &'static str) -> Result<Vec<u8>, Located> {
        const LONGEST: u32 = 1 << 16;
        let tag = self.tag()?;
        if tag.kind != kind || tag.length > LONGEST {
            return Err(self.broken(what));
        }
        self.data(tag)
    }

    /// The fault that something else should stand here.
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

    /// A short read is the end of the file, any other error damaged compression.
    fn check(&self, outcome: io::Result<bool>, what: &str) -> Result<(), Located> {
        match outcome {
            Ok(true) => Ok(()),
            Err(e) if e.kind() != io::ErrorKind::UnexpectedEof => {
                Err(Fault::Syntax { expected: "compressed data", found: e.to_string() }.at_byte(self.start))
            }
            _ => Err(Fault::CutShort { expected: what.into() }.at_byte(self.start)),
        }
    }

    /// The order of the bytes.
    pub(super) fn order(&self) -> ByteOrder {
        self.order
    }
}

impl ByteOrder {
    pub(super) fn u32(self, bytes: [u8; 4]) -> u32 {
        match self {
            Self::Little => u32::from_le_bytes(bytes),
            Self::Big => u32::from_be_bytes(bytes),
        }
    }

    /// Bytes of a number of this type; `None` for a type that is no number.
    pub(super) fn size_of(kind: u32) -> Option<u32> {
        match kind {
            1 | 2 => Some(1),
            3 | 4 => Some(2),
            5..=7 => Some(4),
            9 | 12 | 13 => Some(8),
            _ => None,
        }
    }

    /// The numbers of an element of any numeric type; `None` for another type.
    pub(super) fn numbers(self, kind: u32, data: &[u8]) -> Option<Vec<f64>> {
        macro_rules! decode {
            ($type:ty) => {{
                let (chunks, _) = data.as_chunks::<{ size_of::<$type>() }>();
                let number = |&bytes: &[u8; size_of::<$type>()]| match self {
                    Self::Little => <$type>::from_le_bytes(bytes) as f64,
                    Self::Big => <$type>::from_be_bytes(bytes) as f64,
                };
                Some(chunks.iter().map(number).collect())
            }};
        }
        match kind {
            1 => decode!(i8),
            2 => decode!(u8),
            3 => decode!(i16),
            4 => decode!(u16),
            5 => decode!(i32),
            6 => decode!(u32),
            7 => decode!(f32),
            9 => decode!(f64),
            12 => decode!(i64),
            13 => decode!(u64),
            _ => None,
        }
    }
}
