//! Landmarks and initial maps from files.

use std::path::Path;

use anyhow::{Context, Result, bail};
use canonform::surface::VertexId;
use canonform::{KnownMap, Surface};

use crate::args::MatchArgs;
use crate::field::read_numbers;
use crate::output::check_format;
use crate::pairs;

/// What the options say of the map between two surfaces.
pub(super) fn read(args: &MatchArgs, surfaces: [&Surface; 2]) -> Result<KnownMap> {
    let landmarks = args.landmarks.as_deref().map(|path| landmarks(path, surfaces)).transpose()?;
    let initial = args.initial.as_deref().map(|path| {
        let read = match check_format(path, "a map", &["npy", "csv"])?.as_str() {
            "npy" => of_array(path),
            _ => std::fs::read_to_string(path)
                .map_err(Into::into)
                .and_then(|text| of_text(&text, surfaces[0].n_input_vertices())),
        };
        read.with_context(|| path.display().to_string())
    });
    Ok(KnownMap {
        landmarks: landmarks.unwrap_or_default(),
        initial: initial.transpose()?.unwrap_or_default(),
        functions: None,
    })
}

fn landmarks(path: &Path, surfaces: [&Surface; 2]) -> Result<Vec<[VertexId; 2]>> {
    let pairs = pairs::read_numbered(path)?;
    for (row, pair) in &pairs {
        for ((vertex, surface), name) in pair.iter().zip(surfaces).zip(["first", "second"]) {
            if let Err(fault) = surface.repaired_vertex(*vertex) {
                bail!("{}: {row}: {fault} (the {name} mesh)", path.display());
            }
        }
    }
    Ok(pairs.into_iter().map(|(_, pair)| pair).collect())
}

fn of_array(path: &Path) -> Result<Vec<Option<VertexId>>> {
    let (n_columns, numbers) = read_numbers(path)?;
    if n_columns != 1 && n_columns != numbers.len() {
        bail!("the array has {n_columns} columns; a map has one number for each vertex of the first mesh");
    }
    numbers
        .iter()
        .enumerate()
        .map(|(row, number)| partner(*number).with_context(|| format!("row {row}")))
        .collect()
}

/// Lines of a map as it is written, `vertex,match`, or one number in every line.
fn of_text(text: &str, n_vertices: usize) -> Result<Vec<Option<VertexId>>> {
    let mut found = vec![None; n_vertices];
    let mut next = 0;
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let words: Vec<&str> = line.split(',').map(str::trim).collect();
        if number == 0 && words.iter().all(|word| word.starts_with(char::is_alphabetic)) {
            continue;
        }
        let mut read = || -> Result<()> {
            let (vertex, image) = of_line(&words, next)?;
            match found.get_mut(vertex) {
                Some(place) => *place = image,
                None => bail!("vertex {vertex} does not exist; the first mesh has {n_vertices} vertices"),
            }
            Ok(())
        };
        read().with_context(|| format!("line {}", number + 1))?;
        next += 1;
    }
    Ok(found)
}

/// A vertex, which is `next` unless the line names it, and its partner.
fn of_line(words: &[&str], next: usize) -> Result<(usize, Option<VertexId>)> {
    let number = |word: &str| -> Result<f64> {
        word.parse().with_context(|| format!("`{word}` is not a vertex number"))
    };
    Ok(match *words {
        [vertex, image, ..] => {
            let vertex = vertex.parse().with_context(|| format!("`{vertex}` is not a vertex number"))?;
            (vertex, partner(number(image)?)?)
        }
        [image] => (next, partner(number(image)?)?),
        [] => (next, None),
    })
}

/// A partner, or -1 for none.
fn partner(number: f64) -> Result<Option<VertexId>> {
    match number {
        -1.0 => Ok(None),
        _ if number >= 0.0 && number < f64::from(u32::MAX) && number.fract() == 0.0 => {
            Ok(Some(VertexId(number as u32)))
        }
        _ => bail!("{number} is not a vertex number; write -1 where there is no partner"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_are_read_as_they_are_written() {
        let expected = [Some(VertexId(4)), None, Some(VertexId(0))];
        for text in
            ["vertex,match,confidence\n0,4,0.9\n1,-1,0\n2,0,1\n", "2,0\n0,4", "4\n-1\n0\n", "match\n4\n-1\n0"]
        {
            assert_eq!(of_text(text, 3).unwrap(), expected, "{text}");
        }
        for (text, what) in
            [("0,1\n7,2", "line 2: vertex 7"), ("x", "line"), ("0,1.5", "line 1"), ("-2", "line 1")]
        {
            let found = of_text(text, 3);
            match text {
                // A line of names.
                "x" => assert_eq!(found.unwrap(), [None; 3]),
                _ => assert!(format!("{:#}", found.unwrap_err()).contains(what), "{text}"),
            }
        }
    }
}
