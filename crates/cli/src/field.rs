//! Fields: one value per vertex, read from files.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use anyhow::{Context, Result, bail};
use base::files::FileError;
use canonform::collection::TextTable;
use npyz::{Deserialize, NpyFile, Order};

use crate::output::check_format;

/// Reads one row of a field of `n_vertices` values. `row` counts from 0; it may be left out if there is only one.
pub(crate) fn read_field(path: &Path, row: Option<usize>, n_vertices: usize) -> Result<Vec<f64>> {
    let (n_columns, values) = match check_format(path, "a field", &["npy", "csv"])?.as_str() {
        "npy" => read_numbers(path)?,
        _ => TextTable::read(path)?.numbers()?,
    };
    choose(n_columns, values, row, n_vertices).with_context(|| path.display().to_string())
}

/// Reads a NumPy array of numbers: the number of its columns, and its rows, one after the other.
pub(crate) fn read_numbers(path: &Path) -> Result<(usize, Vec<f64>)> {
    let (n_columns, numbers) = read_array(path)?;
    Ok((n_columns, numbers.reals()))
}

/// The numbers of an array by their type.
pub(crate) enum Numbers {
    Whole(Vec<i64>),
    Real(Vec<f64>),
}

impl Numbers {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Whole(numbers) => numbers.len(),
            Self::Real(numbers) => numbers.len(),
        }
    }

    pub(crate) fn reals(self) -> Vec<f64> {
        match self {
            Self::Whole(numbers) => numbers.into_iter().map(|number| number as f64).collect(),
            Self::Real(numbers) => numbers,
        }
    }
}

fn choose(n_columns: usize, values: Vec<f64>, row: Option<usize>, n_vertices: usize) -> Result<Vec<f64>> {
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

/// As [`read_numbers`]; whole numbers of 64 bits keep all of their digits.
pub(crate) fn read_array(path: &Path) -> Result<(usize, Numbers)> {
    let header = open(path)?;
    let n_columns = match header.shape()[..] {
        [n] | [_, n] => usize::try_from(n)?,
        _ => bail!("{}: the array has {} dimensions; use one or two", path.display(), header.shape().len()),
    };
    // npyz does not convert numbers: try each type.
    let reals = [numbers_of::<f64, _>, numbers_of::<f32, _>];
    let wholes = [
        numbers_of::<i64, _>,
        numbers_of::<i32, _>,
        numbers_of::<i16, _>,
        numbers_of::<i8, _>,
        numbers_of::<u32, _>,
        numbers_of::<u16, _>,
        numbers_of::<u8, _>,
    ];
    let real = || reals.iter().find_map(|read| read(path, n_columns).transpose());
    let whole = || wholes.iter().find_map(|read| read(path, n_columns).transpose());
    let numbers = real().map(|real| real.map(Numbers::Real));
    match numbers.or_else(|| whole().map(|whole| whole.map(Numbers::Whole))) {
        Some(numbers) => Ok((n_columns, numbers?)),
        None => bail!(
            "{}: unsupported array type {}; use numbers such as '<f8' (float64)",
            path.display(),
            header.dtype().descr()
        ),
    }
}

fn open(path: &Path) -> Result<NpyFile<BufReader<File>>, FileError> {
    let file = File::open(path).and_then(|file| NpyFile::new(BufReader::new(file)));
    file.map_err(|source| FileError::read(path, source))
}

/// The rows of an array, if its elements are of type `T`.
fn numbers_of<T: Deserialize, U: From<T> + Copy>(
    path: &Path,
    n_columns: usize,
) -> Result<Option<Vec<U>>, FileError> {
    let file = open(path)?;
    let order = file.order();
    let Ok(data) = file.try_data::<T>() else { return Ok(None) };
    let values: io::Result<Vec<U>> = data.map(|value| value.map(U::from)).collect();
    let values = values.map_err(|source| FileError::read(path, source))?;
    let n_rows = values.len().checked_div(n_columns).unwrap_or(0);
    Ok(Some(match order {
        Order::C => values,
        Order::Fortran => {
            (0..values.len()).map(|at| values[at % n_columns * n_rows + at / n_columns]).collect()
        }
    }))
}
