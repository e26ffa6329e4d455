//! Files of pairs of vertices.

use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result, bail};
use canonform::collection::{Row, TextTable};
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
        let mut content = Vec::new();
        std::io::stdin().lock().read_to_end(&mut content)?;
        return of_table(&TextTable::parse(content, Path::new("standard input"))?);
    }
    match check_format(path, "pairs", &["csv", "txt", "npy"])?.as_str() {
        "npy" => {
            let (n_columns, numbers) = read_numbers(path)?;
            of_array(n_columns, &numbers).with_context(|| path.display().to_string())
        }
        _ => of_table(&TextTable::read(path)?),
    }
}

/// Two numbers in every line. The first line may have names instead.
fn of_table(table: &TextTable) -> Result<Vec<(String, [VertexId; 2])>> {
    let pair = |row: Row<'_>| {
        // Also separated by blanks.
        let words =
            || row.cells().flat_map(|cell| cell.split([',', ';', ' ', '\t'])).filter(|word| !word.is_empty());
        let vertices: Option<Vec<u32>> = words().map(|word| word.parse().ok()).collect();
        let [a, b] = vertices.and_then(|vertices| vertices.try_into().ok()).ok_or_else(|| {
            let found = words().collect::<Vec<_>>().join(",");
            row.fault(format!("`{found}` is not a pair of vertex numbers, counted from 0, such as 17,42"))
        })?;
        Ok((format!("line {}", row.line), [a, b].map(VertexId)))
    };
    table.body()?.map(pair).collect()
}

fn of_array(n_columns: usize, numbers: &[f64]) -> Result<Vec<(String, [VertexId; 2])>> {
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

    fn of_text(text: &str) -> Result<Vec<(String, [VertexId; 2])>> {
        of_table(&TextTable::parse(text.into(), Path::new("pairs.csv"))?)
    }

    #[test]
    fn pairs_are_read_with_and_without_a_line_of_names() {
        let expected = vec![[17, 42].map(VertexId), [0, 3].map(VertexId)];
        for text in ["17,42\n0,3", "a,b\n17, 42\n\n0\t3\n", "17 42\n0;3\n", "\u{feff}a;b\n17;42\n0;3"] {
            let found: Vec<_> = of_text(text).unwrap().into_iter().map(|(_, pair)| pair).collect();
            assert_eq!(found, expected, "{text}");
        }
        for text in ["17", "1,2,3", "0,1\na,b", "-1,2", "1.5,2"] {
            assert!(of_text(text).unwrap_err().to_string().contains("is not a pair"), "{text}");
        }
        for text in ["", "a,b\n"] {
            assert!(of_text(text).unwrap_err().to_string().contains("no rows"), "{text}");
        }
    }
}
