//! Point clouds as text: a point per line, as in `.xyz` and `.pts` files.

use crate::prelude::*;

/// Reads three coordinates per line, separated by blanks, commas or semicolons. What follows them (intensity, color,
/// normal) is ignored, and so is a first line of names, such as `//X Y Z`. A line with a single integer, as `.pts` files
/// begin with, promises so many points. Between blanks or semicolons, a comma may mark decimals, as in `1,5 2,5 3,5`. The number of
/// each point before its coordinates is left out.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let mut positions = Vec::new();
    let mut promised = None;
    let mut lines = Lines::new(files[0]).peekable();
    let first = lines.peek().ok_or_else(|| Fault::Empty.whole())?;
    let has_names = first.text.starts_with(b"//")
        || numbers(first.text).next().is_some_and(|name| name.eq_ignore_ascii_case(b"x"));
    let lines = lines.skip(usize::from(has_names));
    let n_skipped = usize::from(is_numbered(lines.clone()));
    for line in lines {
        let mut words = numbers(line.text);
        if let (Some(count), None) = (words.next().and_then(parse_number::<u64>), words.next()) {
            promised = Some(promised.unwrap_or(0u64).saturating_add(count));
            continue;
        }
        let mut text = line.text.to_vec();
        if commas_mark_decimals(line)? {
            text.iter_mut().filter(|b| **b == b',').for_each(|b| *b = b'.');
        }
        positions.push(parse_position(line, &mut numbers(&text).skip(n_skipped), positions.len() + 1)?);
        limits.check(positions.len() as u64, 0).in_line(line.number)?;
    }
    let found = positions.len() as u64;
    match promised {
        Some(promised) if promised > found => Err(Fault::truncated("points", promised, found).whole()),
        Some(promised) if promised < found => Err(Fault::leftover("points", promised).whole()),
        _ => finish(TriMesh { positions, faces: Vec::new() }, limits),
    }
}

/// Whether every point comes after its number, counted from 0 or 1.
fn is_numbered<'a>(lines: impl Iterator<Item = Line<'a>>) -> bool {
    let mut next = None;
    let mut is_next = |line: Line<'_>| {
        let mut words = numbers(line.text);
        let number = words.next().and_then(parse_number::<u64>);
        let is_next = number.is_some_and(|number| next.map_or(number < 2, |next| number == next));
        next = number.map(|number| number.saturating_add(1));
        is_next && words.nth(2).is_some()
    };
    lines.filter(|line| numbers(line.text).nth(1).is_some()).all(&mut is_next)
}

fn is_separator(b: &u8) -> bool {
    b.is_ascii_whitespace() || matches!(b, b',' | b';')
}

fn numbers(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(is_separator).filter(|word| !word.is_empty())
}

/// Whether commas mark decimals in a line, as they may between blanks or semicolons: `1,5 2,5 3,5`. A fault if they may as
/// well separate numbers, or thousands.
fn commas_mark_decimals(line: Line<'_>) -> Result<bool, Located> {
    if !line.text.contains(&b',') {
        return Ok(false);
    }
    let is_plain_separator = |b: &u8| *b != b',' && is_separator(b);
    let words = line.text.split(is_plain_separator).filter(|word| !word.is_empty());
    let words: Vec<&[u8]> = words.take(3).collect();
    let is_within_number = |before: &[u8], behind: &[u8]| {
        let n_digits = behind.iter().take_while(|b| b.is_ascii_digit()).count();
        let unsigned = before.strip_prefix(b"-").or_else(|| before.strip_prefix(b"+")).unwrap_or(before);
        unsigned.iter().all(u8::is_ascii_digit)
            && n_digits > 0
            && (n_digits == 3 || behind.get(n_digits) != Some(&b'.'))
    };
    // Of each word, the number of its commas, and of those that may be within a number.
    let counts = words.iter().map(|word| {
        let parts: Vec<&[u8]> = word.split(|b| *b == b',').collect();
        let within =
            parts.windows(2).filter(|pair| !pair[0].is_empty() && is_within_number(pair[0], pair[1]));
        (parts.len() - 1, within.count())
    });
    let counts: Vec<(usize, usize)> = counts.collect();
    if words.len() == 1 || counts.iter().all(|(_, n_within)| *n_within == 0) {
        return Ok(false);
    }
    let has_point = words.iter().any(|word| word.contains(&b'.'));
    match words.len() == 3 && !has_point && counts.iter().all(|count| matches!(count, (0, 0) | (1, 1))) {
        true => Ok(true),
        false => {
            let what = "commas may separate numbers here, or mark decimals";
            let remedy = "write decimals with points, or separate numbers by blanks or semicolons alone";
            Err(Fault::unsupported(what, remedy).in_line(line.number))
        }
    }
}
