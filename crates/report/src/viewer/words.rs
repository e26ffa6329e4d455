//! Arrays of numbers as base64 of their little-endian bytes, for `#[serde(with = ...)]`: a quarter of the size of decimal text,
//! and exact.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::Serializer;

/// What can be written as numbers of four bytes.
pub(super) trait Words: Sized {
    /// The bytes, or nothing.
    fn to_bytes(&self) -> Option<Vec<u8>>;
    /// The value with these numbers; `None` if they are not whole groups.
    fn from_words(words: &[[u8; 4]]) -> Option<Self>;
}

macro_rules! words_of_triples {
    ($($number:ty),+) => {$(
        impl Words for Vec<[$number; 3]> {
            fn to_bytes(&self) -> Option<Vec<u8>> {
                Some(self.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect())
            }

            fn from_words(words: &[[u8; 4]]) -> Option<Self> {
                let (triples, rest) = words.as_chunks();
                rest.is_empty()
                    .then(|| triples.iter().map(|triple| triple.map(<$number>::from_le_bytes)).collect())
            }
        }
    )+};
}

words_of_triples!(f32, u32);

impl Words for Option<Vec<f32>> {
    fn to_bytes(&self) -> Option<Vec<u8>> {
        Some(self.as_ref()?.iter().flat_map(|x| x.to_le_bytes()).collect())
    }

    fn from_words(words: &[[u8; 4]]) -> Option<Self> {
        Some(Some(words.iter().map(|word| f32::from_le_bytes(*word)).collect()))
    }
}

pub(super) fn serialize<T: Words, S: Serializer>(numbers: &T, to: S) -> Result<S::Ok, S::Error> {
    match numbers.to_bytes() {
        Some(bytes) => to.serialize_str(&STANDARD.encode(bytes)),
        None => to.serialize_none(),
    }
}

pub(super) fn deserialize<'de, T: Words, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    let text = <std::borrow::Cow<'de, str>>::deserialize(from)?;
    let bytes = STANDARD.decode(&*text).map_err(|fault| D::Error::custom(format!("not base64: {fault}")))?;
    let (words, rest) = bytes.as_chunks();
    let found = if rest.is_empty() { T::from_words(words) } else { None };
    found.ok_or_else(|| {
        D::Error::custom(format!("{} bytes are not a whole number of groups of numbers", bytes.len()))
    })
}
