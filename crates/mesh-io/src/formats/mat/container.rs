//! The MAT-file level 5 container: a 128-byte header, then tagged elements, compressed or not.

use std::io::{self, Read};

use flate2::read::ZlibDecoder;

use crate::binary::{ByteOrder, Scalar};
use crate::located::{At, Located};
use mesh::Fault;

pub(super) const HEADER: usize = 128;

/// Types of elements.
pub(super) const MATRIX: u32 = 14;
pub(super) const COMPRESSED: u32 = 15;

/// Type and length in bytes of an element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tag<'a> {
    pub(super) kind: u32,
    pub(super) length: u32,
    /// Up to four bytes of data are stored in the tag itself.
    inline: Option<&'a [u8]>,
}

/// A sequence of elements.
pub(super) struct Elements<'a> {
    pub(super) rest: &'a [u8],
    pub(super) order: ByteOrder,
    /// Byte of the file at which the sequence begins, for messages.
    pub(super) start: usize,
    /// Why there is no more.
    pub(super) end: Fault,
}

/// Reads the header of the file.
pub(super) fn parse_header(bytes: &[u8]) -> Result<ByteOrder, Located> {
    let wrong = |found: &str| Fault::wrong_format("a MATLAB 5 file", found).whole();
    if bytes.starts_with(b"MATLAB 7.3") || bytes.starts_with(b"\x89HDF") {
        return Err(Fault::unsupported("this is a MATLAB 7.3 file", "save it with `save -v7`").whole());
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

/// The fault of data that ends too early.
pub(super) fn cut_short() -> Fault {
    Fault::cut_short("the rest of an element")
}

/// Decompresses at most `limit` bytes; also returns why there are no more.
pub(super) fn inflated(data: &[u8], limit: u64) -> (Vec<u8>, Fault) {
    let mut bytes = Vec::new();
    let read = ZlibDecoder::new(data).take(limit).read_to_end(&mut bytes);
    let end = match read {
        Err(e) if e.kind() != io::ErrorKind::UnexpectedEof => Fault::syntax("compressed data", e.to_string()),
        _ if bytes.len() as u64 == limit => Fault::Inflates { limit },
        _ => cut_short(),
    };
    (bytes, end)
}

impl<'a> Elements<'a> {
    /// Reads the next tag.
    pub(super) fn tag(&mut self) -> Result<Tag<'a>, Located> {
        let words = self.take(8)?;
        let word = |at: usize| words[at..].first_chunk().map_or(0, |&word| self.u32(word));
        let first = word(0);
        Ok(match first >> 16 {
            0 => Tag { kind: first, length: word(4), inline: None },
            length => Tag { kind: first & 0xffff, length, inline: Some(&words[4..]) },
        })
    }

    /// Reads the data of an element and skips the padding after it.
    pub(super) fn data(&mut self, tag: Tag<'a>) -> Result<&'a [u8], Located> {
        let length = tag.length as usize;
        if let Some(word) = tag.inline {
            return word.get(..length).ok_or_else(|| self.broken("a short element of 4 bytes at most"));
        }
        let data = self.take(length)?;
        self.take(length.wrapping_neg() % 8)?;
        Ok(data)
    }

    /// Reads the data of an element of a given kind.
    pub(super) fn expect(&mut self, kind: u32, what: &'static str) -> Result<&'a [u8], Located> {
        let tag = self.tag()?;
        if tag.kind != kind {
            return Err(self.broken(what));
        }
        self.data(tag)
    }

    /// The fault that `expected` is missing here.
    pub(super) fn broken(&self, expected: &'static str) -> Located {
        Fault::syntax(expected, "other data").at_byte(self.start)
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], Located> {
        let (taken, rest) =
            self.rest.split_at_checked(length).ok_or_else(|| self.end.clone().at_byte(self.start))?;
        self.rest = rest;
        Ok(taken)
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
