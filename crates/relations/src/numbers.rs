//! Numbers in words.

/// A share in percent, with two significant digits.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        p if p >= 10.0 => format!("{p:.0} %"),
        p if p >= 1.0 => format!("{p:.1} %"),
        p if p >= 0.01 => format!("{p:.2} %"),
        p => format!("{p:.1e} %"),
    }
}

/// A number with four significant digits and no zeros at the end.
pub fn in_four_digits(x: f64) -> String {
    in_digits(4, x)
}

/// A number with so many significant digits and no zeros at the end.
pub(super) fn in_digits(n: u32, x: f64) -> String {
    let digits = f64::from(n) - 1.0 - x.abs().max(f64::MIN_POSITIVE).log10().floor();
    if digits > 9.0 && x != 0.0 {
        let rounded: f64 = format!("{x:.*e}", n as usize - 1).parse().unwrap_or(x);
        return format!("{rounded:e}");
    }
    let text = format!("{x:.*}", digits.clamp(0.0, 9.0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

pub(super) fn in_words(n: usize) -> String {
    const WORDS: [&str; 13] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven",
        "twelve",
    ];
    WORDS.get(n).map_or_else(|| n.to_string(), |word| (*word).to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown = [25.4, 1000.0, 0.001, 1.0 / 25.4, 2.0 / 3.0, 123_456.7].map(|x| in_digits(5, x));
        assert_eq!(shown, ["25.4", "1000", "0.001", "0.03937", "0.66667", "123457"]);
        assert_eq!([1e-12, 1.23456e-7, 0.0].map(in_four_digits), ["1e-12", "1.235e-7", "0"]);
        assert_eq!([0.5, 0.0312, 0.0025].map(percent), ["50 %", "3.1 %", "0.25 %"]);
        assert_eq!([0, 6, 13].map(in_words), ["no", "six", "13"]);
    }
}
