//! Texts that state the numbers of a run.
//!
//! A text refers to numbers by name: `{NAME}`, or `{NAME: FORMAT}` with one of these formats:
//! * `%`: as a percentage;
//! * `.2`: with two decimals (or any other digit);
//! * `s`: seconds;
//! * none: with three significant digits; whole numbers in full.

use report::numbers::{seconds, significant};

/// The text with its numbers; an error is the name of one that is not known.
pub(crate) fn filled(text: &str, number: impl Fn(&str) -> Option<f64>) -> Result<String, String> {
    let mut parts = text.trim().split('{');
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (field, rest) = part.split_once('}').ok_or_else(|| part.to_owned())?;
        let (name, format) = field.split_once(": ").unwrap_or((field, ""));
        let value = number(name).filter(|value| value.is_finite()).ok_or_else(|| name.to_owned())?;
        filled += &written(value, format);
        filled += rest;
    }
    Ok(filled)
}

fn written(value: f64, format: &str) -> String {
    match format {
        "%" => return format!("{} %", written(100.0 * value, "")),
        "s" => return seconds(value),
        _ => {}
    }
    if let Some(decimals) = format.strip_prefix('.').and_then(|digits| digits.parse::<usize>().ok()) {
        return grouped(&format!("{value:.decimals$}"));
    }
    grouped(&significant(value, 3))
}

/// A number with commas between groups of three digits.
pub(crate) fn grouped(digits: &str) -> String {
    let (whole, rest) = digits.split_at(digits.find(['.', 'e']).unwrap_or(digits.len()));
    let (sign, whole) = whole.split_at(usize::from(whole.starts_with('-')));
    let mut text = sign.to_owned();
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_the_text_asks() {
        let number = |name: &str| (name != "absent").then(|| name.parse().unwrap_or(0.079));
        let text = |text: &str| filled(text, number);
        assert_eq!(
            text("{x: %} of {12345}, {1060.4}, {0.01234}").unwrap(),
            "7.90 % of 12,345, 1,060, 0.0123"
        );
        assert_eq!(text("{2.345: .1}, {-1534.2: .0}, {1e-9}, {100.0}").unwrap(), "2.3, -1,534, 1.0e-9, 100");
        assert_eq!(text("{absent}").unwrap_err(), "absent");
        assert!(text("{open").is_err());
    }
}
