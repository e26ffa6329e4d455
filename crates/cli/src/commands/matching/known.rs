//! Landmarks and initial maps from files.

use std::path::Path;

use anyhow::{Context, Result, bail};
use canonform::Surface;
use canonform::collection::TextTable;
use canonform::maps::KnownMap;
use canonform::surface::VertexId;

use crate::args::MatchArgs;
use crate::field::read_numbers;
use crate::output::check_format;
use crate::pairs;

/// What the options say of the map between two surfaces.
pub(super) fn read(args: &MatchArgs, surfaces: [&Surface; 2]) -> Result<KnownMap> {
    let landmarks = args.landmarks.as_deref().map(|path| landmarks(path, surfaces)).transpose()?;
    let initial =
        args.initial.as_deref().map(|path| match check_format(path, "a map", &["npy", "csv"])?.as_str() {
            "npy" => {
                let (n_columns, numbers) = read_numbers(path)?;
                of_array(n_columns, &numbers).with_context(|| path.display().to_string())
            }
            _ => of_table(&TextTable::read(path)?, surfaces[0].n_input_vertices()),
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

fn of_array(n_columns: usize, numbers: &[f64]) -> Result<Vec<Option<VertexId>>> {
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
fn of_table(table: &TextTable, n_vertices: usize) -> Result<Vec<Option<VertexId>>> {
    let mut found = vec![None; n_vertices];
    for (next, row) in table.body()?.enumerate() {
        let words: Vec<&str> = row.cells().collect();
        let read = || -> Result<_> {
            let (vertex, image) = of_line(&words, next)?;
            match vertex < n_vertices {
                true => Ok((vertex, image)),
                false => bail!("vertex {vertex} does not exist; the first mesh has {n_vertices} vertices"),
            }
        };
        let (vertex, image) = read().map_err(|fault| row.fault(base::terminal::message(&fault)))?;
        found[vertex] = image;
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

    fn of_text(text: &str, n_vertices: usize) -> Result<Vec<Option<VertexId>>> {
        of_table(&TextTable::parse(text.into(), Path::new("map.csv"))?, n_vertices)
    }

    #[test]
    fn maps_are_read_as_they_are_written() {
        let expected = [Some(VertexId(4)), None, Some(VertexId(0))];
        for text in [
            "vertex,match,confidence\n0,4,0.9\n1,-1,0\n2,0,1\n",
            "\u{feff}vertex;match;confidence\n0;4;0,9\n1;-1;0\n2;0;1\n",
            "2,0\n0,4",
            "4\n-1\n0\n",
            "match\n4\n-1\n0",
        ] {
            assert_eq!(of_text(text, 3).unwrap(), expected, "{text}");
        }
        for (text, what) in [
            ("0,1\n7,2", "line 2: vertex 7"),
            ("x", "line 1: there are no rows"),
            ("0,1.5", "line 1"),
            ("-2", "line 1"),
        ] {
            assert!(format!("{:#}", of_text(text, 3).unwrap_err()).contains(what), "{text}");
        }
    }
}
