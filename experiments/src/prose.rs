//! Texts that state the numbers of a run.
//!
//! A text refers to numbers by name: `{NAME}`, or `{NAME: FORMAT}` with one of these formats:
//! * `%`: as a percentage;
//! * `.2`: with two decimals (or any other digit);
//! * `s` and `B`: seconds, and bytes as MiB or GiB;
//! * none: with three significant digits; whole numbers in full.
//!
//! `{shape1}` and `{shape2}` stand for the classes of the shapes that are examined closely, in names as well.

use report::numbers::{bytes, seconds};
use serde::Deserialize;

use crate::bound::Bound;
use crate::sweep::MeasuredNumbers;

/// A paragraph of an analysis.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Paragraph {
    /// What it says if all of `when` hold.
    pub(crate) text: String,
    /// What it says otherwise; by default nothing.
    #[serde(default)]
    pub(crate) otherwise: String,
    /// Conditions on the numbers of the run.
    #[serde(default)]
    pub(crate) when: Vec<Bound>,
    /// The collections to which it applies; all if empty.
    #[serde(default)]
    pub(crate) on: Vec<crate::collection::Setting>,
}

impl Paragraph {
    /// Its text for a run, which may be empty; an error is the name of a number that the run did not measure.
    pub(crate) fn write(&self, numbers: &MeasuredNumbers, shapes: &[&str]) -> Result<String, String> {
        let holds = |bound: &Bound| {
            let name = with_shapes(&bound.value, shapes);
            numbers.get(&name).map(|value| bound.holds(*value)).ok_or(name)
        };
        let outcomes = self.when.iter().map(holds).collect::<Result<Vec<bool>, String>>()?;
        let text = if outcomes.into_iter().all(|held| held) { &self.text } else { &self.otherwise };
        filled(&with_shapes(text, shapes), |name| numbers.get(name).copied())
    }
}

/// The text with the classes of the shapes.
fn with_shapes(text: &str, shapes: &[&str]) -> String {
    let mut text = text.to_owned();
    for (i, shape) in shapes.iter().enumerate() {
        let name = format!("shape{}", i + 1);
        text = text.replace(&format!("{{{name}}}"), shape).replace(&name, shape);
    }
    text
}

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
        "B" => return bytes(value as usize),
        _ => {}
    }
    if let Some(decimals) = format.strip_prefix('.').and_then(|digits| digits.parse::<usize>().ok()) {
        return grouped(&format!("{value:.decimals$}"));
    }
    let size = value.abs();
    if value.fract() == 0.0 && size < 1e6 {
        return grouped(&format!("{value:.0}"));
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.1e}");
    }
    // Three significant digits: the first is that of the largest power of ten.
    let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
    grouped(&format!("{value:.decimals$}"))
}

/// A number with commas between groups of three digits.
fn grouped(digits: &str) -> String {
    let (whole, rest) = digits.split_at(digits.find('.').unwrap_or(digits.len()));
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

    #[test]
    fn a_paragraph_follows_its_numbers() {
        let paragraph: Paragraph = toml::from_str(
            "text = 'On {shape2}, {shape2 off: %} is close.'\notherwise = 'On {shape2}, {shape2 off: %} is far.'\n\
             when = [{ value = 'shape2 off', at_most = 0.05 }]",
        )
        .unwrap();
        let text = |off: f64| paragraph.write(&[("cat off".to_owned(), off)].into(), &["david", "cat"]);
        assert_eq!(text(0.0312).unwrap(), "On cat, 3.12 % is close.");
        assert_eq!(text(0.0789).unwrap(), "On cat, 7.89 % is far.");
        assert_eq!(paragraph.write(&MeasuredNumbers::new(), &["david", "cat"]).unwrap_err(), "cat off");
    }
}
