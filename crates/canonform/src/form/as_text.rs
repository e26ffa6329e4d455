//! Options that are a number or a word: `100`, `auto`, `inf`.

use std::fmt::Display;
use std::str::FromStr;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Number;

#[derive(Deserialize)]
#[serde(untagged, expecting = "it is neither a number nor a word")]
enum NumberOrWord {
    Number(f64),
    Word(String),
}

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
    let text = match NumberOrWord::deserialize(input)? {
        NumberOrWord::Number(number) => number.to_string(),
        NumberOrWord::Word(word) => word,
    };
    text.parse().map_err(D::Error::custom)
}

/// [`deserialize`] for a setting, which is given.
pub(super) fn given<'de, T: FromStr<Err: Display>, D: Deserializer<'de>>(
    input: D,
) -> Result<Option<T>, D::Error> {
    deserialize(input).map(Some)
}
