//! The record of one shape.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// SHA-256 hash of what a shape was made from.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ContentHash([u8; 32]);

impl ContentHash {
    /// Hashes several pieces of bytes in order, including where each of them ends.
    #[must_use]
    pub fn of<B: AsRef<[u8]>>(pieces: &[B]) -> Self {
        let mut hash = Sha256::new();
        for piece in pieces.iter().map(AsRef::as_ref) {
            hash.update((piece.len() as u64).to_le_bytes());
            hash.update(piece);
        }
        Self(hash.finalize().into())
    }
}

impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ContentHash({self})")
    }
}

impl FromStr for ContentHash {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let digits = text
            .as_bytes()
            .chunks(2)
            .map(|pair| std::str::from_utf8(pair).ok().and_then(|pair| u8::from_str_radix(pair, 16).ok()));
        let bytes: Option<Vec<u8>> = if text.len() == 64 { digits.collect() } else { None };
        let bytes: Option<[u8; 32]> = bytes.and_then(|bytes| bytes.try_into().ok());
        bytes.map(Self).ok_or_else(|| format!("`{text}` is not 64 hexadecimal digits"))
    }
}

/// Properties of a shape, without its vectors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapeEntry {
    /// Its class; empty if it has none.
    pub label: String,
    /// The file it was read from.
    pub path: String,
    /// Hash of what it was made from.
    pub content: ContentHash,
    /// Named numbers about it, in the order given.
    pub facts: Vec<(String, f64)>,
}

impl ShapeEntry {
    /// The fact of this name, if any.
    #[must_use]
    pub fn fact(&self, name: &str) -> Option<f64> {
        self.facts.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
    }
}

/// The vectors of a shape.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShapeVectors {
    /// The vector that is searched: similar shapes are near in the Euclidean norm. All vectors of an index have the
    /// same length.
    pub fused: Vec<f32>,
    /// Named signatures.
    pub signatures: Vec<(String, Vec<f32>)>,
    /// Points of its canonical form: `x y z` and weight.
    pub form: Vec<[f32; 4]>,
}

/// A shape in an index.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Its name, unique within an index.
    pub id: String,
    /// Its properties.
    pub entry: ShapeEntry,
    /// Its vectors.
    pub vectors: ShapeVectors,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_sha_256_and_depend_on_where_pieces_end() {
        let hash = ContentHash::of::<&[u8]>(&[]);
        let empty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
        assert_eq!(hash.to_string(), empty);
        assert_eq!(empty.parse(), Ok(hash));
        assert_ne!(ContentHash::of(&["ab", "c"]), ContentHash::of(&["a", "bc"]));
        for bad in ["", "e3", &empty[1..], &empty.replace('e', "x"), &format!("{empty}00")] {
            assert!(bad.parse::<ContentHash>().is_err(), "{bad}");
        }
    }
}
