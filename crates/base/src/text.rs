//! Text from outside, such as names of files, among our own.

use std::borrow::Cow;
use std::io::Write;

/// Whether a terminal or a browser obeys a character instead of showing it: control characters, line ends, and marks that
/// change the direction of the text around them.
fn is_code(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The text on one line that people can read: a name may hold codes that end a line, move the cursor, change colors, or make
/// a terminal answer.
///
/// ```
/// assert_eq!(canonform_base::one_line("\u{1b}[2Jcat\n.off"), "\\u{1b}[2Jcat\\n.off");
/// assert_eq!(canonform_base::one_line("çat 1"), "çat 1");
/// ```
pub fn one_line(text: &str) -> Cow<'_, str> {
    escaped(text, is_code, |c| c.escape_default().to_string())
}

/// As [`one_line`], but line ends and tabs stay, in text of our own whose names are escaped.
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_code(c) && c != '\n' && c != '\t', |c| c.escape_default().to_string())
}

/// JSON that says the same without such characters.
pub fn printable_json(text: &str) -> Cow<'_, str> {
    escaped(text, is_code, |c| format!("\\u{:04x}", u32::from(c)))
}

/// Writes a line to standard error, which may be closed: that is no reason to stop, and `eprintln` would panic.
pub fn write_line(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", one_line(text));
}

fn escaped(text: &str, is_code: impl Fn(char) -> bool, escape: impl Fn(char) -> String) -> Cow<'_, str> {
    if !text.contains(&is_code) {
        return text.into();
    }
    text.chars().map(|c| if is_code(c) { escape(c) } else { c.to_string() }).collect::<String>().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_ends_its_line_or_turns_it_around() {
        let name = "a\r\n\t\u{7}\u{7f}\u{85}\u{9b}31m\u{202e}b\u{2066}\u{2028}ü";
        assert_eq!(one_line(name), "a\\r\\n\\t\\u{7}\\u{7f}\\u{85}\\u{9b}31m\\u{202e}b\\u{2066}\\u{2028}ü");
        assert_eq!(printable("a\n\tb\r"), "a\n\tb\\r");
        assert_eq!(printable_json("\"\u{9b}\u{202e}ü\""), "\"\\u009b\\u202eü\"");
    }
}
