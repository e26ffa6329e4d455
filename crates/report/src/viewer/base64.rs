//! Arrays of numbers as base64 of their little-endian bytes: a quarter of the size of decimal text, and exact.

use ::base64::Engine;
use ::base64::engine::general_purpose::STANDARD;
use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::Serializer;

/// A number of four bytes.
pub trait Word: Copy {
    /// Its bytes, little-endian.
    fn to_bytes(self) -> [u8; 4];
    /// The number with these bytes.
    fn from_bytes(bytes: [u8; 4]) -> Self;
}

macro_rules! word {
    ($($number:ty)*) => {
        $(impl Word for $number {
            fn to_bytes(self) -> [u8; 4] {
                self.to_le_bytes()
            }
            fn from_bytes(bytes: [u8; 4]) -> Self {
                Self::from_le_bytes(bytes)
            }
        })*
    };
}

word!(f32 u32);

/// Encodes a list of numbers.
pub fn encode<T: Word>(numbers: impl Iterator<Item = T>) -> String {
    STANDARD.encode(numbers.flat_map(Word::to_bytes).collect::<Vec<u8>>())
}

/// Decodes a list of numbers whose length is a multiple of `width`.
fn decode<T: Word>(text: &str, width: usize) -> Result<Vec<T>, String> {
    let bytes = STANDARD.decode(text).map_err(|fault| format!("not base64: {fault}"))?;
    if bytes.len() % (4 * width) != 0 {
        return Err(format!("{} bytes are not a whole number of groups of {width} numbers", bytes.len()));
    }
    Ok(bytes.as_chunks::<4>().0.iter().map(|word| T::from_bytes(*word)).collect())
}

/// For `#[serde(with = ...)]` on a list of triples.
pub mod triples {
    use super::{Deserialize, Deserializer, Error, Serializer, Word, decode, encode};

    /// Writes the list as one string.
    pub fn serialize<T: Word, S: Serializer>(list: &[[T; 3]], to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&encode(list.as_flattened().iter().copied()))
    }

    /// Reads such a string.
    ///
    /// # Errors
    /// If the string is not base64 or not a whole number of triples.
    pub fn deserialize<'de, T: Word, D: Deserializer<'de>>(from: D) -> Result<Vec<[T; 3]>, D::Error> {
        let text = <std::borrow::Cow<'de, str>>::deserialize(from)?;
        let flat = decode(&text, 3).map_err(D::Error::custom)?;
        Ok(flat.as_chunks::<3>().0.to_vec())
    }
}

/// For `#[serde(with = ...)]` on an optional list of numbers.
pub mod optional_list {
    use super::{Deserialize, Deserializer, Error, Serializer, Word, decode, encode};

    /// Writes the numbers as one string, or nothing.
    pub fn serialize<T: Word, S: Serializer>(numbers: &Option<Vec<T>>, to: S) -> Result<S::Ok, S::Error> {
        match numbers {
            Some(numbers) => to.serialize_str(&encode(numbers.iter().copied())),
            None => to.serialize_none(),
        }
    }

    /// Reads such a string if there is one.
    ///
    /// # Errors
    /// If the string is not base64 or not a whole number of words.
    pub fn deserialize<'de, T: Word, D: Deserializer<'de>>(from: D) -> Result<Option<Vec<T>>, D::Error> {
        let text = Option::<std::borrow::Cow<'de, str>>::deserialize(from)?;
        text.map(|text| decode(&text, 1).map_err(D::Error::custom)).transpose()
    }
}
