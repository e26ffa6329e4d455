//! Comparing what a command printed with what the guide shows.

use std::sync::LazyLock;

use regex::Regex;

/// Three dots, or a number: digits with commas between thousands, a decimal part, an exponent.
static APART: LazyLock<Regex> =
    LazyLock::new(|| pattern(r"\.\.\.|[0-9]+(,[0-9]{3}(?-u:\b))*(\.[0-9]+)?(e[-+]?[0-9]+)?"));

/// `distances: 40 of 100, 12 s, about 18 s left`, or shorter.
static PROGRESS: LazyLock<Regex> = LazyLock::new(|| pattern(r"^([^ ]*|.* of .*), [0-9]+ s(, about .*)?$"));

fn pattern(text: &str) -> Regex {
    Regex::new(text).unwrap_or_else(|fault| panic!("{fault}"))
}

/// Whether a command printed what the guide shows.
///
/// - A line `...` stands for any number of lines, and `...` in a line for anything.
/// - Spaces, and what frames a table is made of, do not count, because a table adapts to the width of its numbers.
/// - Numbers with a decimal point may differ by 1 %, or by 1 in the last digit: processors round differently.
/// - A number before `s`, `ms` or `MB`, or in a line that begins with `seconds`, stands for any number.
/// - Lines that report progress do not count: they appear on slow machines.
#[must_use]
pub fn matches(shown: &str, printed: &str) -> bool {
    let shown: Vec<&str> = lines(shown.lines()).collect();
    let printed: Vec<&str> = lines(without_progress(printed)).collect();
    equal(&shown, &printed, &|shown, line| {
        let are_seconds = shown[0].starts_with("seconds ");
        equal(&words(shown[0]), &words(line), &|shown, word| {
            match_word(shown[0], word, if are_seconds { Some("s") } else { shown.get(1).copied() })
        })
    })
}

/// The lines that do not report progress.
pub(crate) fn without_progress(printed: &str) -> impl Iterator<Item = &str> {
    printed.lines().filter(|line| !PROGRESS.is_match(line))
}

fn lines<'a>(lines: impl Iterator<Item = &'a str>) -> impl Iterator<Item = &'a str> {
    lines.map(str::trim).filter(|line| line.chars().any(|c| !is_frame(c)))
}

fn is_frame(c: char) -> bool {
    c.is_whitespace() || matches!(c, '-' | '+' | '|' | '=' | '\u{2500}'..='\u{257f}')
}

/// Whether all elements are the `same` as those that are shown, where `...` stands for any number of them. `same` gets the
/// shown element with those behind it.
fn equal(shown: &[&str], printed: &[&str], same: &dyn Fn(&[&str], &str) -> bool) -> bool {
    match (shown.split_first(), printed.split_first()) {
        (None, rest) => rest.is_none(),
        (Some((&"...", rest)), _) => (0..=printed.len()).any(|n| equal(rest, &printed[n..], same)),
        (Some(_), None) => false,
        (Some((_, rest)), Some((first, others))) => same(shown, first) && equal(rest, others, same),
    }
}

/// The words of a line. Numbers stand apart from what surrounds them, and so does `...`.
fn words(line: &str) -> Vec<&str> {
    let mut words = Vec::new();
    for word in line.split(|c: char| c.is_whitespace() || matches!(c, '|' | '\u{2500}'..='\u{257f}')) {
        let mut end = 0;
        for apart in APART.find_iter(word) {
            words.extend([&word[end..apart.start()], apart.as_str()]);
            end = apart.end();
        }
        words.push(&word[end..]);
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Whether a word is the shown one; `unit` is the word that follows in the guide.
fn match_word(shown: &str, printed: &str, unit: Option<&str>) -> bool {
    if shown == printed {
        return true;
    }
    let (Some(a), Some(b)) = (number(shown), number(printed)) else { return false };
    let unit = unit.map_or("", |unit| unit.trim_end_matches([',', ')', '.', ';']));
    if matches!(unit, "s" | "ms" | "MB") {
        return true;
    }
    let decimals = shown.split_once('.').map(|(_, decimals)| decimals);
    decimals.is_some_and(|decimals| {
        let digits = decimals.bytes().take_while(u8::is_ascii_digit).count();
        let power: f64 = decimals.split_once('e').and_then(|(_, power)| power.parse().ok()).unwrap_or(0.0);
        let last = 10_f64.powf(power - digits as f64);
        (a - b).abs() <= (0.01 * a.abs()).max(1.01 * last)
    })
}

fn number(word: &str) -> Option<f64> {
    if word.starts_with(|c: char| c.is_ascii_digit()) { word.replace(',', "").parse().ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn the_same_output_matches_and_another_does_not() {
        let printed = "  vertices  1,000\n  method    nmds\n\n  stress    12.34\n  time      0.52 s\n";
        for (shown, printed, is_same) in [
            (printed, printed, true),
            ("vertices 1,000\nmethod nmds\nstress 12.3\ntime 7 s", printed, true),
            ("vertices 1,000\n...\ntime 7 s", printed, true),
            ("...\nstress ...\n...", printed, true),
            ("vertices 1,001\n...", printed, false),
            ("vertices 1,000\nmethod mds\n...", printed, false),
            ("vertices ...\nmethod n...s\nstress 12.35\ntime 0.1 s", printed, false),
            ("vertices 1,000\nmethod nmds\nstress 12.34", printed, false),
            ("", printed, false),
            ("...\ntime 0.52 s\nmore", printed, false),
            // Numbers in words are numbers, and frames do not count.
            ("cat0  (0.99 %, x=1.50e-3)", "cat0 (1.00 %, x=1.51e-3)", true),
            ("cat0", "cat1", false),
            ("seconds 0.1 (distances 0.2)", "seconds  9.5 (distances 3.25)", true),
            ("| a | b |\n|---|---|\n| 1 | 2 |", "┌───┐\n│ a ┆ b │\n│ 1 │ 2 │\n", true),
            ("| 1 | 2 |", "| 1 | 3 |", false),
            // Nor does progress.
            ("done", "distances: 40 of 100, 12 s, about 18 s left\nshapes, 5 s\ndone", true),
            ("done", "30 shapes, 5 s slow\ndone", false),
        ] {
            assert_eq!(matches(shown, printed), is_same, "{shown}");
        }
    }
}
