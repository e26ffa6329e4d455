//! What identifies the content of files.

use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// SHA-256 hash of what a shape was made from.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ContentHash([u8; 32]);

impl ContentHash {
    /// Hashes several pieces of bytes in order, including where each of them ends.
    pub fn of<B: AsRef<[u8]>>(pieces: &[B]) -> Self {
        let mut hasher = ContentHasher::default();
        pieces.iter().for_each(|piece| hasher.add(piece.as_ref()));
        hasher.finish()
    }

    /// Its first 64 bits.
    pub fn start(&self) -> u64 {
        self.0.iter().take(8).fold(0, |bits, byte| bits << 8 | u64::from(*byte))
    }
}

/// Makes a [`ContentHash`] of one piece after the other.
#[derive(Debug, Default)]
pub struct ContentHasher(Sha256);

impl ContentHasher {
    /// Adds a piece.
    pub fn add(&mut self, piece: &[u8]) {
        self.0.update((piece.len() as u64).to_le_bytes());
        self.0.update(piece);
    }

    /// Adds the content of a file as a piece, without holding it in memory.
    ///
    /// # Errors
    /// If the file cannot be read, or changes meanwhile.
    pub fn add_file(&mut self, file: &mut File) -> io::Result<()> {
        let mut left = file.metadata()?.len();
        self.0.update(left.to_le_bytes());
        let mut buffer = vec![0; 1 << 16];
        loop {
            match file.read(&mut buffer)? {
                0 if left == 0 => return Ok(()),
                n if n > 0 && n as u64 <= left => {
                    self.0.update(&buffer[..n]);
                    left -= n as u64;
                }
                _ => return Err(io::Error::other("the file changed while it was read")),
            }
        }
    }

    /// The hash of all pieces.
    pub fn finish(self) -> ContentHash {
        ContentHash(self.0.finalize().into())
    }
}

impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl From<ContentHash> for String {
    fn from(hash: ContentHash) -> Self {
        hash.to_string()
    }
}

impl TryFrom<String> for ContentHash {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
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
        let digits: Option<Vec<u8>> = text.chars().map(|digit| Some(digit.to_digit(16)? as u8)).collect();
        let digits: Option<[u8; 64]> = digits.and_then(|digits| digits.try_into().ok());
        let bytes = digits.map(|digits| std::array::from_fn(|i| digits[2 * i] << 4 | digits[2 * i + 1]));
        bytes.map(Self).ok_or_else(|| format!("`{text}` is not 64 hexadecimal digits"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_have_the_hash_of_their_content() {
        let mut files: Vec<File> = (0..2).map(|_| tempfile::tempfile().unwrap()).collect();
        let pieces = [vec![7; 100_000], vec![1, 2, 3]];
        for (file, piece) in files.iter_mut().zip(&pieces) {
            std::io::Write::write_all(file, piece).unwrap();
            std::io::Seek::rewind(file).unwrap();
        }
        let mut hasher = ContentHasher::default();
        files.iter_mut().for_each(|file| hasher.add_file(file).unwrap());
        assert_eq!(hasher.finish(), ContentHash::of(&pieces));
    }

    #[test]
    fn hashes_are_sha_256_and_depend_on_where_pieces_end() {
        let hash = ContentHash::of::<&[u8]>(&[]);
        let empty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
        assert_eq!(hash.to_string(), empty);
        assert_eq!(empty.parse(), Ok(hash));
        assert_ne!(ContentHash::of(&["ab", "c"]), ContentHash::of(&["a", "bc"]));
        let [no_digit, signed] = [('e', "x"), ('e', "+")].map(|(from, to)| empty.replace(from, to));
        for bad in ["", "e3", &empty[1..], &no_digit, &signed, &format!("{empty}00")] {
            assert!(bad.parse::<ContentHash>().is_err(), "{bad}");
        }
    }
}
