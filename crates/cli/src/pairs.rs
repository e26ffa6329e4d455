//! Files of pairs of vertices.

use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result, bail};
use canonform::surface::VertexId;

use crate::field::read_numbers;
use crate::input::is_stream;
use crate::output::check_format;

/// Reads pairs of vertex numbers.
pub(crate) fn read(path: &Path) -> Result<Vec<[VertexId; 2]>> {
    Ok(read_numbered(path)?.into_iter().map(|(_, pair)| pair).collect())
}

/// Reads pairs of vertex numbers, each with its place in the file.
pub(crate) fn read_numbered(path: &Path) -> Result<Vec<(String, [VertexId; 2])>> {
    if is_stream(path) {
        let mut text = String::new();
        std::io::stdin().lock().read_to_string(&mut text)?;
        return of_text(&text).context("standard input");
    }
    let read = match check_format(path, "pairs", &["csv", "txt", "npy"])?.as_str() {
        "npy" => of_array(path),
        _ => std::fs::read_to_string(path).map_err(Into::into).and_then(|text| of_text(&text)),
    };
    read.with_context(|| path.display().to_string())
}

/// Two numbers in every line. The first line may have names instead.
fn of_text(text: &str) -> Result<Vec<(String, [VertexId; 2])>> {
    let mut pairs = Vec::new();
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let words: Vec<&str> =
            line.split([',', ';', ' ', '\t']).map(str::trim).filter(|word| !word.is_empty()).collect();
        let vertices: Option<Vec<u32>> = words.iter().map(|word| word.parse().ok()).collect();
        let place = format!("line {}", number + 1);
        match vertices.as_deref() {
            Some(&[a, b]) => pairs.push((place, [a, b].map(VertexId))),
            None if number == 0 && words.iter().all(|word| word.starts_with(char::is_alphabetic)) => {}
            _ => bail!("{place}: `{}` is not a pair of vertex numbers, such as 17,42", line.trim()),
        }
    }
    Ok(pairs)
}

fn of_array(path: &Path) -> Result<Vec<(String, [VertexId; 2])>> {
    let (n_columns, numbers) = read_numbers(path)?;
    if n_columns != 2 {
        bail!("the array has {n_columns} columns; a pair has 2");
    }
    let vertex = |number: f64| {
        let is_vertex = number >= 0.0 && number < f64::from(u32::MAX) && number.fract() == 0.0;
        is_vertex
            .then_some(VertexId(number as u32))
            .with_context(|| format!("{number} is not a vertex number"))
    };
    let pairs = numbers.as_chunks::<2>().0.iter().enumerate();
    pairs.map(|(row, [a, b])| Ok((format!("row {row}"), [vertex(*a)?, vertex(*b)?]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_read_with_and_without_a_line_of_names() {
        let expected = vec![[17, 42].map(VertexId), [0, 3].map(VertexId)];
        for text in ["17,42\n0,3", "a,b\n17, 42\n\n0\t3\n", "17 42\n0;3\n"] {
            let found: Vec<_> = of_text(text).unwrap().into_iter().map(|(_, pair)| pair).collect();
            assert_eq!(found, expected, "{text}");
        }
        for text in ["17", "1,2,3", "0,1\na,b", "-1,2", "1.5,2"] {
            assert!(of_text(text).unwrap_err().to_string().contains("is not a pair"), "{text}");
        }
    }
}
