//! Fields: one value per vertex, read from files.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use anyhow::{Context, Result, bail};
use npyz::{NpyFile, Order};

use crate::output::check_format;

/// Reads one row of a field of `n_vertices` values. `row` counts from 0; it may be left out if there is only one.
pub(crate) fn read_field(path: &Path, row: Option<usize>, n_vertices: usize) -> Result<Vec<f64>> {
    let format = check_format(path, "a field", &["npy", "csv"])?;
    let read = if format == "npy" { read_npy(path) } else { read_csv(path) };
    let rows = read.with_context(|| path.display().to_string())?;
    choose(rows, row, n_vertices).with_context(|| path.display().to_string())
}

/// Reads a NumPy array of numbers: the number of its columns, and its rows, one after the other.
pub(crate) fn read_numbers(path: &Path) -> Result<(usize, Vec<f64>)> {
    let Rows { n_columns, values } = read_npy(path)?;
    Ok((n_columns, values))
}

/// Whether the numbers of a NumPy array are whole by their type.
pub(crate) fn is_whole(path: &Path) -> Result<bool> {
    let kind = NpyFile::new(BufReader::new(File::open(path)?))?.dtype().descr();
    Ok(!kind.contains('f'))
}

/// Rows of equal length, one after the other.
struct Rows {
    n_columns: usize,
    values: Vec<f64>,
}

fn choose(rows: Rows, row: Option<usize>, n_vertices: usize) -> Result<Vec<f64>> {
    let Rows { n_columns, values } = rows;
    // One value per line is one row.
    let is_column = n_columns == 1 && values.len() == n_vertices;
    let n_columns = if is_column { values.len() } else { n_columns };
    if n_columns != n_vertices {
        bail!(
            "the field has {n_columns} values per row, but the mesh has {n_vertices} vertices; give one value per vertex \
             of the mesh file"
        );
    }
    let n_rows = values.len().checked_div(n_columns).unwrap_or(0);
    match row {
        None if n_rows == 1 => Ok(values),
        None => bail!("the field has {n_rows} rows; choose one with --row, counted from 0"),
        Some(row) if row < n_rows => Ok(values[row * n_columns..][..n_columns].to_vec()),
        Some(row) => bail!("row {row} does not exist; the field has {n_rows} rows, counted from 0"),
    }
}

fn read_npy(path: &Path) -> Result<Rows> {
    let open =
        || -> Result<NpyFile<BufReader<File>>> { Ok(NpyFile::new(BufReader::new(File::open(path)?))?) };
    let header = open()?;
    let (shape, order, kind) = (header.shape().to_vec(), header.order(), header.dtype().descr());
    let n_columns = match shape[..] {
        [n] | [_, n] => usize::try_from(n)?,
        _ => bail!("the array has {} dimensions; use one or two", shape.len()),
    };
    // npyz does not convert numbers: try each type.
    let values = open()?
        .try_data::<f64>()
        .ok()
        .map(|data| data.collect::<Result<Vec<f64>, _>>())
        .or_else(|| Some(open().ok()?.try_data::<f32>().ok()?.map(|x| x.map(f64::from)).collect()))
        .or_else(|| Some(open().ok()?.try_data::<i64>().ok()?.map(|x| x.map(|x| x as f64)).collect()))
        .or_else(|| Some(open().ok()?.try_data::<i32>().ok()?.map(|x| x.map(f64::from)).collect()))
        .or_else(|| Some(open().ok()?.try_data::<u8>().ok()?.map(|x| x.map(f64::from)).collect()));
    let Some(values) = values else {
        bail!("unsupported array type {kind}; use numbers such as '<f8' (float64)");
    };
    let values = values?;
    let n_rows = values.len().checked_div(n_columns).unwrap_or(0);
    let values = match order {
        Order::C => values,
        Order::Fortran => (0..n_rows)
            .flat_map(|i| (0..n_columns).map(move |j| (i, j)))
            .map(|(i, j)| values[j * n_rows + i])
            .collect(),
    };
    Ok(Rows { n_columns, values })
}

fn read_csv(path: &Path) -> Result<Rows> {
    let text = std::fs::read_to_string(path)?;
    let (mut values, mut n_columns) = (Vec::new(), None);
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let before = values.len();
        for part in line.split(',') {
            let part = part.trim();
            values.push(
                part.parse().with_context(|| format!("line {}: `{part}` is not a number", number + 1))?,
            );
        }
        let found = values.len() - before;
        let expected = *n_columns.get_or_insert(found);
        if found != expected {
            bail!("line {} has {found} values, but the first line has {expected}", number + 1);
        }
    }
    Ok(Rows { n_columns: n_columns.unwrap_or(0), values })
}
