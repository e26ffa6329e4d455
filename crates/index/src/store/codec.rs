//! Encoding of values: the only module that names bincode.
//!
//! The size is checked before decoding, so forged lengths reserve no memory, and decoding must consume all bytes.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// The largest size of one value: 64 MiB.
pub(crate) const LIMIT: usize = 64 << 20;

fn config() -> impl bincode::config::Config {
    bincode::config::standard().with_little_endian().with_limit::<LIMIT>()
}

/// # Errors
/// Why it cannot be stored.
pub(crate) fn encode<T: Serialize>(value: &T) -> Result<Vec<u8>, String> {
    let bytes = bincode::serde::encode_to_vec(value, config()).map_err(|error| error.to_string())?;
    match bytes.len() {
        size if size > LIMIT => Err(format!("a value of {size} bytes exceeds the limit of {LIMIT}")),
        _ => Ok(bytes),
    }
}

/// # Errors
/// What is wrong with the bytes.
pub(crate) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let size = bytes.len();
    if size > LIMIT {
        return Err(format!("a value of {size} bytes exceeds the limit of {LIMIT}"));
    }
    let (value, used) =
        bincode::serde::decode_from_slice(bytes, config()).map_err(|error| error.to_string())?;
    match used == size {
        true => Ok(value),
        false => Err(format!("{used} of {size} bytes were used")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floats::Floats;

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
    fn a_forged_length_reserves_no_memory() {
        // bincode writes lengths beyond 250 as a marker and eight bytes.
        let bytes = [&[253][..], &(1u64 << 60).to_le_bytes()].concat();
        assert!(decode::<String>(&bytes).is_err());
        assert!(decode::<Floats>(&bytes).is_err());
        assert!(decode::<Vec<u64>>(&bytes).is_err());
    }

    #[test]
    fn oversized_values_and_trailing_bytes_are_rejected() {
        assert!(encode(&Floats(vec![0.0; LIMIT / 4 + 1])).is_err());
        assert!(decode::<u8>(&vec![0; LIMIT + 1]).unwrap_err().contains("limit"));
        assert!(decode::<u8>(&encode(&(1u8, 2u8)).unwrap()).unwrap_err().contains("1 of 2 bytes"));
        assert!(decode::<Floats>(&encode(&"abc").unwrap()).is_err());
    }
}
