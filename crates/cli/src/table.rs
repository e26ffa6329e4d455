//! Tables of numbers: read from text and from NumPy arrays, and written to them.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use anyhow::{Context, Result, bail};
use base::files::{FileError, write_atomically};
use canonform::collection::TextTable;
use canonform::linalg::Matrix;
use canonform::surface::VertexId;
use npyz::{AutoSerialize, Deserialize, NpyFile, Order, WriterBuilder};

use crate::input::{input_name, is_stream};
use crate::output::check_format;

/// Numbers in rows of equal length.
pub(crate) struct Table {
    pub(crate) n_columns: usize,
    /// One row after the other.
    pub(crate) numbers: Numbers,
    /// The line of each row of a text.
    lines: Vec<usize>,
}

/// Numbers of a table by their type; whole numbers of 64 bits keep all of their digits.
pub(crate) enum Numbers {
    Whole(Vec<i64>),
    Real(Vec<f64>),
}

impl Table {
    /// Reads a file of one of these formats: an array, or text. An array of one dimension, or one row as `canonform geodesic`
    /// writes it, is a column.
    pub(crate) fn read(path: &Path, what: &str, formats: &[&str]) -> Result<Self> {
        if is_stream(path) {
            let mut content = Vec::new();
            io::stdin().lock().read_to_end(&mut content)?;
            return Self::of_text(&TextTable::parse(content, Path::new("standard input"))?);
        }
        match check_format(path, what, formats)?.as_str() {
            "npy" => Self::of_array(path),
            _ => Self::of_text(&TextTable::read(path)?),
        }
    }

    /// The rows below one of names. Blanks separate numbers, too.
    pub(crate) fn of_text(table: &TextTable) -> Result<Self> {
        let (n_columns, numbers, lines) = table.numbers()?;
        Ok(Self { n_columns, numbers: Numbers::Real(numbers), lines })
    }

    fn of_array(path: &Path) -> Result<Self> {
        let header = open(path)?;
        let n_columns = match header.shape()[..] {
            [_] | [1, _] => 1,
            [_, n] => usize::try_from(n)?,
            _ => {
                bail!("{}: the array has {} dimensions; use one or two", path.display(), header.shape().len())
            }
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
            Some(numbers) => Ok(Self { n_columns, numbers: numbers?, lines: Vec::new() }),
            None => bail!(
                "{}: unsupported array type {}; use numbers such as '<f8' (float64)",
                path.display(),
                header.dtype().descr()
            ),
        }
    }

    pub(crate) fn into_reals(self) -> Vec<f64> {
        match self.numbers {
            Numbers::Whole(numbers) => numbers.into_iter().map(|number| number as f64).collect(),
            Numbers::Real(numbers) => numbers,
        }
    }

    /// Each row as `read` understands it; its faults name the place in the file.
    pub(crate) fn rows<T>(
        self,
        path: &Path,
        mut read: impl FnMut(usize, &[f64]) -> Result<T>,
    ) -> Result<Vec<T>> {
        let (n_columns, lines) = (self.n_columns.max(1), self.lines.clone());
        let place =
            |row: usize| lines.get(row).map_or_else(|| format!("row {row}"), |line| format!("line {line}"));
        let numbers = self.into_reals();
        let rows = numbers.chunks_exact(n_columns).enumerate();
        rows.map(|(i, row)| read(i, row).with_context(|| format!("{}, {}", input_name(path), place(i))))
            .collect()
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

/// The number of a vertex, counted from 0.
pub(crate) fn vertex(number: f64) -> Result<VertexId> {
    let is_vertex = number >= 0.0 && number < f64::from(u32::MAX) && number.fract() == 0.0;
    is_vertex.then_some(VertexId(number as u32)).with_context(|| format!("{number} is not a vertex number"))
}

/// Reads pairs of vertex numbers, and checks each.
pub(crate) fn read_pairs(
    path: &Path,
    check: impl Fn([VertexId; 2]) -> Result<()>,
) -> Result<Vec<[VertexId; 2]>> {
    Table::read(path, "pairs", &["csv", "txt", "npy"])?.rows(path, |_, row| {
        let [a, b] = *row else {
            bail!("{} numbers are not a pair of vertex numbers, counted from 0, such as 17,42", row.len())
        };
        let pair = [vertex(a)?, vertex(b)?];
        check(pair).map(|()| pair)
    })
}

/// Reads one row of a field of `n_vertices` values. `row` counts from 0; it may be left out if there is only one.
pub(crate) fn read_field(path: &Path, row: Option<usize>, n_vertices: usize) -> Result<Vec<f64>> {
    let table = Table::read(path, "a field", &["npy", "csv"])?;
    let n_columns = table.n_columns;
    choose(n_columns, table.into_reals(), row, n_vertices).with_context(|| path.display().to_string())
}

fn choose(n_columns: usize, values: Vec<f64>, row: Option<usize>, n_vertices: usize) -> Result<Vec<f64>> {
    // One value per line is one row.
    let n_columns = if n_columns == 1 { values.len() } else { n_columns };
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

/// Writes numbers as a NumPy array of this shape.
pub(crate) fn write_npy<T: AutoSerialize>(
    path: &Path,
    shape: &[usize],
    numbers: impl IntoIterator<Item = T>,
) -> Result<()> {
    let shape: Vec<u64> = shape.iter().map(|n| *n as u64).collect();
    Ok(write_atomically(path, |out| {
        let mut array = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(out).begin_nd()?;
        array.extend(numbers)?;
        array.finish()
    })?)
}

/// Writes rows of comma-separated numbers in full precision.
pub(crate) fn write_csv(path: &Path, rows: impl IntoIterator<Item: IntoIterator<Item = f64>>) -> Result<()> {
    Ok(write_atomically(path, |out| {
        rows.into_iter().try_for_each(|row| {
            let text: Vec<String> = row.into_iter().map(|number| number.to_string()).collect();
            writeln!(out, "{}", text.join(","))
        })
    })?)
}

/// Writes a matrix to a NumPy array, row by row.
pub(crate) fn write_matrix(path: &Path, matrix: &Matrix) -> Result<()> {
    write_npy(path, &[matrix.nrows(), matrix.ncols()], matrix.transpose().as_slice().iter().copied())
}
