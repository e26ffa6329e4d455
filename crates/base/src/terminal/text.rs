//! Text that a terminal shows as it is.

use std::borrow::Cow;

/// The text with control characters written as escapes, except line ends and tabs: names of files may hold codes that
/// move the cursor, change colours, or make a terminal answer.
///
/// ```
/// assert_eq!(canonform_base::terminal::printable("\u{1b}[2Jcat.off"), "\\u{1b}[2Jcat.off");
/// assert_eq!(canonform_base::terminal::printable("çat\t1\n"), "çat\t1\n");
/// ```
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    let is_code = |c: char| c.is_control() && c != '\n' && c != '\t';
    if !text.contains(is_code) {
        return text.into();
    }
    let escaped = |c: char| match is_code(c) {
        true => c.escape_unicode().to_string(),
        false => c.to_string(),
    };
    text.chars().map(escaped).collect::<String>().into()
}
