//! Comparing what a command printed with what the guide shows.

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
    printed.lines().filter(|line| !is_progress(line))
}

fn lines<'a>(lines: impl Iterator<Item = &'a str>) -> impl Iterator<Item = &'a str> {
    lines.map(str::trim).filter(|line| line.chars().any(|c| !is_frame(c)))
}

fn is_frame(c: char) -> bool {
    c.is_whitespace() || matches!(c, '-' | '+' | '|' | '=' | '\u{2500}'..='\u{257f}')
}

/// `distances: 40 of 100, 12 s, about 18 s left`, or shorter.
fn is_progress(line: &str) -> bool {
    let is_seconds = |text: &str| {
        text.strip_suffix(" s")
            .is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
    };
    line.split_once(", ").is_some_and(|(stage, rest)| {
        !stage.contains(' ') | stage.contains(" of ")
            && (is_seconds(rest)
                || rest.split_once(", about ").is_some_and(|(elapsed, _)| is_seconds(elapsed)))
    })
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
        let mut rest = word;
        while !rest.is_empty() {
            let length = next_length(rest);
            words.push(&rest[..length]);
            rest = &rest[length..];
        }
    }
    words
}

/// The length of the dots, of the number, or of the text that a word begins with.
fn next_length(word: &str) -> usize {
    if word.starts_with("...") {
        return 3;
    }
    let number = number_length(word);
    if number > 0 {
        return number;
    }
    let starts = word.char_indices().skip(1).map(|(start, _)| start);
    let mut ends =
        starts.filter(|&start| word[start..].starts_with("...") || number_length(&word[start..]) > 0);
    ends.next().unwrap_or(word.len())
}

/// The length of the number that a text begins with: digits with commas between thousands, a decimal part, an exponent.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut end = digits(0);
    if end == 0 {
        return 0;
    }
    while bytes.get(end) == Some(&b',') && digits(end + 1) == 3 {
        end += 4;
    }
    if bytes.get(end) == Some(&b'.') && digits(end + 1) > 0 {
        end += 1 + digits(end + 1);
    }
    if let Some(sign) = bytes.get(end).filter(|b| **b == b'e').and_then(|_| bytes.get(end + 1)) {
        let skip = 1 + usize::from(matches!(sign, b'-' | b'+'));
        let exponent = if end + skip < bytes.len() { digits(end + skip) } else { 0 };
        if exponent > 0 {
            end += skip + exponent;
        }
    }
    end
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
    (number_length(word) == word.len()).then(|| word.replace(',', "").parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn the_same_output_matches_and_another_does_not() {
        let printed = "  vertices  1,000\n  method    nmds\n\n  stress    12.34\n  time      0.52 s\n";
        assert!(matches(printed, printed));
        for shown in [
            "vertices 1,000\nmethod nmds\nstress 12.3\ntime 7 s",
            "vertices 1,000\n...\ntime 7 s",
            "...\nstress ...\n...",
            "vertices ...\nmethod n...s\nstress 12.35\ntime 0.1 s",
        ] {
            assert!(matches(shown, printed) != shown.contains("n...s"), "{shown}");
        }
        for shown in [
            "vertices 1,001\n...",
            "vertices 1,000\nmethod mds\n...",
            "vertices 1,000\nmethod nmds\nstress 12.9\n...",
            "vertices 1,000\nmethod nmds\nstress 12.34",
            "vertices 1,000",
            "",
            "...\ntime 0.52 s\nmore",
        ] {
            assert!(!matches(shown, printed), "{shown}");
        }
    }

    #[test]
    fn numbers_in_words_are_numbers_and_frames_do_not_count() {
        assert!(matches("cat0  (0.99 %, x=1.50e-3)", "cat0 (1.00 %, x=1.51e-3)"));
        assert!(!matches("cat0", "cat1"));
        assert!(matches("seconds 0.1 (distances 0.2)", "seconds  9.5 (distances 3.25)"));
        assert!(matches("| a | b |\n|---|---|\n| 1 | 2 |", "┌───┐\n│ a ┆ b │\n│ 1 │ 2 │\n"));
        assert!(!matches("| 1 | 2 |", "| 1 | 3 |"));
    }

    #[test]
    fn progress_does_not_count() {
        assert!(matches("done", "distances: 40 of 100, 12 s, about 18 s left\nshapes, 5 s\ndone"));
        assert!(!matches("done", "30 shapes, 5 s slow\ndone"));
    }
}
