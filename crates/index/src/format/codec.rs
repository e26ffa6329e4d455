//! Encoding of values: the only module that names bincode.
//!
//! A value is the CRC-32 of its encoding (4 bytes, little-endian), followed by the encoding. Size and checksum are
//! checked before decoding, so forged lengths reserve no memory, and decoding must consume all bytes.

use serde::de::{DeserializeOwned, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The largest size of one value: 64 MiB.
pub(crate) const LIMIT: usize = 64 << 20;

const SUM: usize = 4;

/// Errors of encoding or decoding a value.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CodecError {
    /// The value is too large.
    #[error("a value of {size} bytes exceeds the limit of {limit}")]
    TooLarge {
        /// Its size.
        size: usize,
        /// The limit.
        limit: usize,
    },
    /// The bytes, this number of them, differ from those that were written.
    #[error("a value of {0} bytes does not match its checksum")]
    Checksum(usize),
    /// The bytes have the right checksum but encode no value of the expected type.
    #[error("a value cannot be decoded: {0}")]
    Malformed(String),
}

fn config() -> impl bincode::config::Config {
    bincode::config::standard().with_little_endian().with_limit::<LIMIT>()
}

/// # Errors
/// [`CodecError::TooLarge`], [`CodecError::Malformed`].
pub(crate) fn encode<T: Serialize>(value: &T) -> Result<Vec<u8>, CodecError> {
    let mut bytes = vec![0; SUM];
    let used = bincode::serde::encode_into_std_write(value, &mut bytes, config())
        .map_err(|error| CodecError::Malformed(error.to_string()))?;
    if used > LIMIT {
        return Err(CodecError::TooLarge { size: used, limit: LIMIT });
    }
    let sum = crc32fast::hash(&bytes[SUM..]);
    bytes[..SUM].copy_from_slice(&sum.to_le_bytes());
    Ok(bytes)
}

/// # Errors
/// [`CodecError`].
pub(crate) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, CodecError> {
    let size = bytes.len();
    if size > LIMIT + SUM {
        return Err(CodecError::TooLarge { size, limit: LIMIT });
    }
    let (sum, content) = bytes.split_first_chunk::<SUM>().ok_or(CodecError::Checksum(size))?;
    if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
        return Err(CodecError::Checksum(size));
    }
    let (value, used) = bincode::serde::decode_from_slice(content, config())
        .map_err(|error| CodecError::Malformed(error.to_string()))?;
    match used == content.len() {
        true => Ok(value),
        false => Err(CodecError::Malformed(format!("{used} of {} bytes were used", content.len()))),
    }
}

/// Numbers stored as one block of little-endian bytes.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Floats(pub(crate) Vec<f32>);

impl Serialize for Floats {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        let bytes: Vec<u8> = self.0.iter().flat_map(|x| x.to_le_bytes()).collect();
        out.serialize_bytes(&bytes)
    }
}

impl<'de> Deserialize<'de> for Floats {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Bytes;
        impl Visitor<'_> for Bytes {
            type Value = Floats;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("four bytes per number")
            }

            fn visit_bytes<E: serde::de::Error>(self, bytes: &[u8]) -> Result<Floats, E> {
                let (numbers, rest) = bytes.as_chunks::<4>();
                match rest {
                    [] => Ok(Floats(numbers.iter().map(|b| f32::from_le_bytes(*b)).collect())),
                    _ => Err(E::invalid_length(bytes.len(), &self)),
                }
            }
        }
        from.deserialize_bytes(Bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_round_trip_bit_for_bit() {
        let value = (
            "cat".to_owned(),
            Floats(vec![0.1, -0.0, f32::MIN_POSITIVE, 3e38]),
            vec![7u32, u32::MAX],
            Some(0.1f64),
        );
        let bytes = encode(&value).unwrap();
        assert_eq!(decode::<(String, Floats, Vec<u32>, Option<f64>)>(&bytes).unwrap(), value);
    }

    #[test]
    fn any_changed_or_missing_byte_is_detected() {
        let bytes = encode(&("cat".to_owned(), Floats(vec![1.0; 5]))).unwrap();
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut changed = bytes.clone();
                changed[at] ^= 1 << bit;
                let error = decode::<(String, Floats)>(&changed).unwrap_err();
                assert_eq!(error, CodecError::Checksum(bytes.len()));
            }
            assert!(decode::<(String, Floats)>(&bytes[..at]).is_err());
        }
    }

    #[test]
    fn a_forged_length_with_a_valid_checksum_reserves_no_memory() {
        // bincode writes lengths beyond 250 as a marker and eight bytes.
        let mut bytes = vec![0; SUM];
        bytes.push(253);
        bytes.extend((1u64 << 60).to_le_bytes());
        let sum = crc32fast::hash(&bytes[SUM..]);
        bytes[..SUM].copy_from_slice(&sum.to_le_bytes());
        assert!(matches!(decode::<String>(&bytes), Err(CodecError::Malformed(_))));
        assert!(matches!(decode::<Floats>(&bytes), Err(CodecError::Malformed(_))));
        assert!(matches!(decode::<Vec<u64>>(&bytes), Err(CodecError::Malformed(_))));
    }

    #[test]
    fn oversized_values_and_trailing_bytes_are_rejected() {
        let error = encode(&Floats(vec![0.0; LIMIT / 4 + 1])).unwrap_err();
        assert!(matches!(error, CodecError::TooLarge { .. } | CodecError::Malformed(_)), "{error}");
        let error = decode::<u8>(&vec![0; LIMIT + SUM + 1]).unwrap_err();
        assert!(matches!(error, CodecError::TooLarge { limit: LIMIT, .. }));
        let error = decode::<u8>(&encode(&(1u8, 2u8)).unwrap()).unwrap_err();
        assert!(error.to_string().contains("1 of 2 bytes"), "{error}");
        let error = decode::<Floats>(&encode(&"abc").unwrap()).unwrap_err();
        assert!(matches!(error, CodecError::Malformed(_)));
    }
}
