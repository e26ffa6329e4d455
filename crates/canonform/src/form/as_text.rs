//! Options whose text is a number or a word, in JSON: `100`, `"auto"`, `"inf"`.

use std::fmt::Display;
use std::str::FromStr;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Number, Value};

pub(super) fn serialize<T: Display, S: Serializer>(value: &T, out: S) -> Result<S::Ok, S::Error> {
    let text = value.to_string();
    match text.parse::<Number>() {
        Ok(number) => number.serialize(out),
        Err(_) => text.serialize(out),
    }
}

pub(super) fn deserialize<'de, T: FromStr<Err: Display>, D: Deserializer<'de>>(
    input: D,
) -> Result<T, D::Error> {
    let text = match Value::deserialize(input)? {
        Value::String(text) => text,
        number => number.to_string(),
    };
    text.parse().map_err(D::Error::custom)
}
