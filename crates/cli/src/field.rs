//! Numbers of vertices, read from files.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use anyhow::{Context, Result, bail};
use npyz::{NpyFile, Order};

use crate::output::extension;

/// Reads one row of a field, one number for each of `n_vertices`. `row` counts from 0 and may be left
/// out where there is one only.
pub(crate) fn read_field(path: &Path, row: Option<usize>, n_vertices: usize) -> Result<Vec<f64>> {
    let read = match extension(path).as_str() {
        "npy" => read_npy(path),
        "csv" => read_csv(path),
        _ => bail!("{}: fields are read from .npy or .csv; end the name in one of them", path.display()),
    };
    let rows = read.with_context(|| path.display().to_string())?;
    choose(rows, row, n_vertices).with_context(|| path.display().to_string())
}

/// Numbers in rows of equal length, row by row.
struct Rows {
    n_columns: usize,
    values: Vec<f64>,
}

fn choose(rows: Rows, row: Option<usize>, n_vertices: usize) -> Result<Vec<f64>> {
    let Rows { n_columns, values } = rows;
    // A column is a row that was written downwards.
    let is_column = n_columns == 1 && values.len() == n_vertices;
    let n_columns = if is_column { values.len() } else { n_columns };
    if n_columns != n_vertices {
        bail!(
            "the field has {n_columns} numbers a row, the mesh {n_vertices} vertices; give one number for each vertex \
             of this mesh's file"
        );
    }
    let n_rows = values.len().checked_div(n_columns).unwrap_or(0);
    match row {
        None if n_rows == 1 => Ok(values),
        None => bail!("the field has {n_rows} rows; choose one with --row, counted from 0"),
        Some(row) if row < n_rows => Ok(values[row * n_columns..][..n_columns].to_vec()),
        Some(row) => bail!("there is no row {row}; the field has {n_rows}, counted from 0"),
    }
}

fn read_npy(path: &Path) -> Result<Rows> {
    let open =
        || -> Result<NpyFile<BufReader<File>>> { Ok(NpyFile::new(BufReader::new(File::open(path)?))?) };
    let header = open()?;
    let (shape, order, kind) = (header.shape().to_vec(), header.order(), header.dtype().descr());
    let n_columns = match shape[..] {
        [n] | [_, n] => usize::try_from(n)?,
        _ => bail!("the array has {} dimensions; a field has one or two", shape.len()),
    };
    // npyz converts no numbers: it has to be asked for what is there.
    let values = open()?
        .try_data::<f64>()
        .ok()
        .map(|data| data.collect::<Result<Vec<f64>, _>>())
        .or_else(|| Some(open().ok()?.try_data::<f32>().ok()?.map(|x| x.map(f64::from)).collect()))
        .or_else(|| Some(open().ok()?.try_data::<i64>().ok()?.map(|x| x.map(|x| x as f64)).collect()))
        .or_else(|| Some(open().ok()?.try_data::<i32>().ok()?.map(|x| x.map(f64::from)).collect()))
        .or_else(|| Some(open().ok()?.try_data::<u8>().ok()?.map(|x| x.map(f64::from)).collect()));
    let Some(values) = values else {
        bail!("the array holds {kind}; a field holds numbers, such as '<f8' (float64)");
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
            values.push(part.parse().with_context(|| format!("line {}: `{part}` is no number", number + 1))?);
        }
        let found = values.len() - before;
        let expected = *n_columns.get_or_insert(found);
        if found != expected {
            bail!("line {} has {found} numbers, the first one {expected}", number + 1);
        }
    }
    Ok(Rows { n_columns: n_columns.unwrap_or(0), values })
}
