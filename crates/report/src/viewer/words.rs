//! Arrays of numbers of four bytes as base64 of their little-endian bytes, for `#[serde(with = ...)]`: a quarter of the size of
//! decimal text, and exact.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bytemuck::{AnyBitPattern, NoUninit, cast_slice, pod_read_unaligned};
use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::Serializer;

pub(super) fn serialize<T: NoUninit, S: Serializer>(numbers: &[T], to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&STANDARD.encode(little_endian(cast_slice(numbers).to_vec())))
}

pub(super) fn deserialize<'de, T: AnyBitPattern, D: Deserializer<'de>>(from: D) -> Result<Vec<T>, D::Error> {
    let text = <std::borrow::Cow<'de, str>>::deserialize(from)?;
    let bytes = STANDARD.decode(&*text).map_err(|fault| D::Error::custom(format!("not base64: {fault}")))?;
    if bytes.len() % size_of::<T>() > 0 {
        let message = format!("{} bytes are not a whole number of groups of numbers", bytes.len());
        return Err(D::Error::custom(message));
    }
    Ok(little_endian(bytes).chunks_exact(size_of::<T>()).map(pod_read_unaligned).collect())
}

/// Numbers of this machine as little-endian ones, and back.
fn little_endian(mut bytes: Vec<u8>) -> Vec<u8> {
    if cfg!(target_endian = "big") {
        bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|number| number.reverse());
    }
    bytes
}
