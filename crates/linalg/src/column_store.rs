//! Columns of numbers, in memory or in a file.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use base::{Budget, Exceeded, Observer};

use crate::{LinalgError, Matrix};

const BYTES: usize = size_of::<f64>();

/// Columns of `n_rows` numbers each, in memory or in a file. Both hold double precision, so that results do not depend
/// on where the columns are.
///
/// ```
/// use canonform_linalg::{ColumnStore, LinalgError};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// for mut store in [ColumnStore::in_memory(3), ColumnStore::in_file(3, tempfile::tempfile()?)] {
///     store.push(&[1.0, 2.0, 3.0])?;
///     store.push(&[4.0, 5.0, 6.0])?;
///     assert_eq!(store.column(1)?[..], [4.0, 5.0, 6.0]);
///     assert_eq!(store.rows(1..3)?.as_slice(), [2.0, 3.0, 5.0, 6.0]);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct ColumnStore {
    n_rows: usize,
    n_columns: usize,
    backing: Backing,
}

#[derive(Debug, Clone)]
enum Backing {
    Memory(Vec<f64>),
    /// Clones share the file, and what was written stays as it is.
    File(Arc<Mutex<File>>),
}

impl ColumnStore {
    /// No columns yet, in memory.
    pub fn in_memory(n_rows: usize) -> Self {
        Self { n_rows, n_columns: 0, backing: Backing::Memory(Vec::new()) }
    }

    /// No columns yet, in a file of the caller, which should be open for reading and writing and used by nobody else.
    pub fn in_file(n_rows: usize, file: File) -> Self {
        Self { n_rows, n_columns: 0, backing: Backing::File(Arc::new(Mutex::new(file))) }
    }

    /// The columns of a matrix.
    pub fn of_matrix(matrix: Matrix) -> Self {
        let (n_rows, n_columns) = matrix.shape();
        Self { n_rows, n_columns, backing: Backing::Memory(matrix.data.into()) }
    }

    /// Numbers in a column.
    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    /// Number of columns.
    pub fn n_columns(&self) -> usize {
        self.n_columns
    }

    /// Whether the columns are in a file.
    pub fn is_in_file(&self) -> bool {
        matches!(self.backing, Backing::File(_))
    }

    /// Makes room in memory for `more` columns, so that adding them moves none.
    ///
    /// # Errors
    /// [`LinalgError::Exceeded`] if they do not fit into memory.
    pub fn reserve(&mut self, more: usize, observer: &dyn Observer) -> Result<(), LinalgError> {
        if let Backing::Memory(values) = &mut self.backing {
            let needed = self.n_rows.saturating_mul(self.n_columns + more).saturating_mul(BYTES);
            observer.budget().check_memory(needed)?;
            let more = self.n_rows.saturating_mul(more);
            values.try_reserve_exact(more).map_err(|_| Exceeded::Allocation { needed })?;
        }
        Ok(())
    }

    /// Appends `more` columns of zeros and returns the places to fill them in, from any thread.
    ///
    /// # Errors
    /// [`LinalgError::Exceeded`] if they do not fit into memory.
    pub fn grow(&mut self, more: usize, observer: &dyn Observer) -> Result<Vec<ColumnSlot<'_>>, LinalgError> {
        let (n_rows, before) = (self.n_rows, self.n_columns);
        if let Backing::Memory(values) = &mut self.backing {
            observer.budget().extend(values, n_rows.saturating_mul(more))?;
        }
        self.n_columns += more;
        Ok(match &mut self.backing {
            Backing::Memory(_) if n_rows == 0 => Vec::new(),
            Backing::Memory(values) => {
                values[n_rows * before..].chunks_exact_mut(n_rows).map(ColumnSlot::Memory).collect()
            }
            Backing::File(file) => {
                (before..before + more).map(|index| ColumnSlot::File { file, n_rows, index }).collect()
            }
        })
    }

    /// Appends a column.
    ///
    /// # Errors
    /// As [`grow`](Self::grow), and [`LinalgError::File`].
    ///
    /// # Panics
    /// If it does not have `n_rows` numbers.
    pub fn push(&mut self, column: &[f64]) -> Result<(), LinalgError> {
        assert_eq!(column.len(), self.n_rows, "a number for each row");
        let slots = self.grow(1, &())?;
        slots.into_iter().try_for_each(|slot| {
            slot.fill(|place| {
                place.copy_from_slice(column);
                Ok(())
            })
        })
    }

    /// Keeps the first `n` columns.
    pub fn truncate(&mut self, n: usize) {
        self.n_columns = self.n_columns.min(n);
        if let Backing::Memory(values) = &mut self.backing {
            values.truncate(self.n_rows * self.n_columns);
        }
    }

    /// The first `n` columns: a copy if they are in memory, the same file if they are in one.
    pub fn first(&self, n: usize) -> Self {
        let n_columns = n.min(self.n_columns);
        let backing = match &self.backing {
            Backing::Memory(values) => Backing::Memory(values[..self.n_rows * n_columns].to_vec()),
            Backing::File(file) => Backing::File(file.clone()),
        };
        Self { n_rows: self.n_rows, n_columns, backing }
    }

    /// A column.
    ///
    /// # Errors
    /// [`LinalgError::File`].
    ///
    /// # Panics
    /// If there is no such column.
    pub fn column(&self, index: usize) -> Result<Cow<'_, [f64]>, LinalgError> {
        assert!(index < self.n_columns, "column {index} of {}", self.n_columns);
        match &self.backing {
            Backing::Memory(values) => Ok(values[index * self.n_rows..][..self.n_rows].into()),
            Backing::File(file) => {
                let mut column = vec![0.0; self.n_rows];
                read(&mut lock(file), index * self.n_rows, &mut column).map_err(LinalgError::file)?;
                Ok(column.into())
            }
        }
    }

    /// All columns at the rows of a range, `range.len()` x `n_columns`.
    ///
    /// # Errors
    /// [`LinalgError::File`].
    ///
    /// # Panics
    /// If there are no such rows.
    pub fn rows(&self, range: std::ops::Range<usize>) -> Result<Matrix, LinalgError> {
        assert!(range.end <= self.n_rows, "rows {range:?} of {}", self.n_rows);
        let n = range.len();
        let zeros = Budget::unlimited().vector(n.saturating_mul(self.n_columns))?;
        let mut block = Matrix::from_vec(n, self.n_columns, zeros);
        if n == 0 {
            return Ok(block);
        }
        let columns = block.as_mut_slice().chunks_exact_mut(n).enumerate();
        match &self.backing {
            Backing::Memory(values) => {
                for (j, column) in columns {
                    column.copy_from_slice(&values[j * self.n_rows + range.start..][..n]);
                }
            }
            Backing::File(file) => {
                let mut file = lock(file);
                for (j, column) in columns {
                    read(&mut file, j * self.n_rows + range.start, column).map_err(LinalgError::file)?;
                }
            }
        }
        Ok(block)
    }
}

/// The place of a new column.
#[derive(Debug)]
pub enum ColumnSlot<'a> {
    /// In memory.
    Memory(&'a mut [f64]),
    /// In a file.
    File {
        /// The file.
        file: &'a Mutex<File>,
        /// Numbers in a column.
        n_rows: usize,
        /// Number of the column.
        index: usize,
    },
}

impl ColumnSlot<'_> {
    /// Fills the column by a function, which gets zeros.
    ///
    /// # Errors
    /// Those of the function; [`LinalgError::File`] if the column cannot be written.
    pub fn fill(self, work: impl FnOnce(&mut [f64]) -> Result<(), Exceeded>) -> Result<(), LinalgError> {
        match self {
            Self::Memory(column) => Ok(work(column)?),
            Self::File { file, n_rows, index } => {
                let mut column = vec![0.0; n_rows];
                work(&mut column)?;
                write(&mut lock(file), index * n_rows, &column).map_err(LinalgError::file)
            }
        }
    }
}

fn lock(file: &Mutex<File>) -> MutexGuard<'_, File> {
    file.lock().unwrap_or_else(PoisonError::into_inner)
}

fn read(file: &mut File, first: usize, out: &mut [f64]) -> io::Result<()> {
    file.seek(SeekFrom::Start(first as u64 * BYTES as u64))?;
    file.read_exact(bytemuck::cast_slice_mut(out))
}

fn write(file: &mut File, first: usize, numbers: &[f64]) -> io::Result<()> {
    file.seek(SeekFrom::Start(first as u64 * BYTES as u64))?;
    file.write_all(bytemuck::cast_slice(numbers))
}
