//! Distances between all pairs of vertices, written to a file that does not fit into memory.

use std::io::{self, Read, Seek, SeekFrom, Write};

use base::Exceeded;
use geodesics::DistanceSolver;
use linalg::Matrix;
use serde::Serialize;
use surface::VertexId;

use crate::error::{Error, Remedy};
use base::Observer;
use mesh::Surface;

/// How much the two directions of a pair differ before they are averaged.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Asymmetry {
    /// Mean of `|d(a, b) - d(b, a)|` relative to the larger of the two, over all pairs of distinct points.
    pub mean: f64,
    /// The maximum of the same.
    pub largest: f64,
}

/// The distances between all pairs of input vertices, computed a block of rows at a time.
#[derive(Debug)]
pub struct AllPairs<'a> {
    surface: &'a Surface,
    solver: &'a dyn DistanceSolver,
    /// Rows of a block.
    block: usize,
    /// Sources solved at a time.
    batch: usize,
}

/// Most sources solved at a time.
const BATCH: usize = 64;

/// Columns of a block averaged at a time: a few cache lines of each row.
const STRIPE: usize = 64;

const BYTES: usize = size_of::<f64>();

impl<'a> AllPairs<'a> {
    /// Plans the work so that at most `memory` bytes of distances are held at once, besides what the solver
    /// itself needs.
    ///
    /// # Errors
    /// [`Error::TooLarge`] if two rows do not fit.
    pub fn new(surface: &'a Surface, solver: &'a dyn DistanceSolver, memory: usize) -> Result<Self, Error> {
        let n_vertices = surface.n_input_vertices();
        let rows = memory / (BYTES * n_vertices.max(1));
        if rows < 2 {
            let needed = 2 * BYTES * n_vertices;
            let what = format!(
                "distances between all pairs of {n_vertices} vertices need at least {needed} bytes of memory at once, more \
                 than the {memory} allowed"
            );
            return Err(Error::TooLarge { what, remedy: Remedy::RaiseMemory });
        }
        let batch = (rows / 4).clamp(1, BATCH);
        Ok(Self { surface, solver, block: (rows - batch).min(n_vertices), batch })
    }

    /// Number of input vertices: the rows and columns of the matrix.
    pub fn n_vertices(&self) -> usize {
        self.surface.n_input_vertices()
    }

    /// Writes the matrix at the current position of `out`, row by row as little-endian float64; infinite for
    /// vertices that the repair dropped.
    ///
    /// An entry is the average of both directions, which are solved at different times: a block of rows is
    /// written as it was solved, and when a later block has the other direction, that part is read back and
    /// both halves are written. So every distance is solved once, a quarter of the file is read, and half of
    /// it is written twice. The result depends neither on `memory` nor on the number of threads.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(
        &self,
        out: &mut (impl Read + Write + Seek),
        observer: &dyn Observer,
    ) -> io::Result<Asymmetry> {
        let p = self.n_vertices();
        let origin = out.stream_position()?;
        let at = |row: usize, column: usize| SeekFrom::Start(origin + ((row * p + column) * BYTES) as u64);
        let (mut sum, mut largest, mut count) = (0.0, 0.0, 0_u64);
        let mut average = |there: f64, back: f64| {
            let longer = there.max(back);
            if longer > 0.0 && longer < f64::INFINITY {
                let share = (there - back).abs() / longer;
                (sum, largest, count) = (sum + share, f64::max(largest, share), count + 1);
            }
            0.5 * (there + back)
        };
        let mut block = vec![0.0; self.block * p];
        let mut bytes = vec![[0; BYTES]; self.block * STRIPE];
        observer.begin("all pairs", p);
        for first in (0..p).step_by(self.block.max(1)) {
            let n = self.block.min(p - first);
            let rows = &mut block[..n * p];
            self.solve(first, rows, observer).map_err(io::Error::other)?;
            // Earlier blocks wrote the stripes left of this one.
            for left in (0..first).step_by(STRIPE) {
                let width = STRIPE.min(first - left);
                let stripe = &mut bytes[..width * n];
                for (i, column) in stripe.chunks_exact_mut(n).enumerate() {
                    out.seek(at(left + i, first))?;
                    out.read_exact(column.as_flattened_mut())?;
                }
                for (i, row) in rows.chunks_exact_mut(p).enumerate() {
                    for (j, there) in row[left..left + width].iter_mut().enumerate() {
                        let back = &mut stripe[j * n + i];
                        *there = average(*there, f64::from_le_bytes(*back));
                        *back = there.to_le_bytes();
                    }
                }
                for (i, column) in stripe.chunks_exact(n).enumerate() {
                    out.seek(at(left + i, first))?;
                    out.write_all(column.as_flattened())?;
                }
            }
            for i in 0..n {
                for j in 0..i {
                    let mean = average(rows[i * p + first + j], rows[j * p + first + i]);
                    rows[i * p + first + j] = mean;
                    rows[j * p + first + i] = mean;
                }
            }
            out.seek(at(first, 0))?;
            for part in rows.chunks(bytes.len()) {
                part.iter().zip(&mut bytes).for_each(|(number, place)| *place = number.to_le_bytes());
                out.write_all(bytes[..part.len()].as_flattened())?;
            }
        }
        Ok(Asymmetry { mean: sum / count.max(1) as f64, largest })
    }

    /// Solves the rows of the input vertices from `first` on.
    fn solve(&self, first: usize, rows: &mut [f64], observer: &dyn Observer) -> Result<(), Exceeded> {
        let p = self.n_vertices();
        let to_repaired: Vec<Option<VertexId>> = self.surface.input.remap.all_to_new().collect();
        for (i, rows) in rows.chunks_mut(self.batch * p).enumerate() {
            let start = first + i * self.batch;
            let wanted = &to_repaired[start..start + rows.len() / p];
            let mut sources: Vec<VertexId> = wanted.iter().flatten().copied().collect();
            sources.sort_unstable();
            sources.dedup();
            let columns: Matrix = self.solver.distance_columns(&sources)?;
            for (row, source) in rows.chunks_exact_mut(p).zip(wanted) {
                let column = source.and_then(|source| sources.binary_search(&source).ok());
                let column = column.map(|column| columns.column(column));
                for (distance, vertex) in row.iter_mut().zip(&to_repaired) {
                    *distance = match (&column, vertex) {
                        (Some(column), Some(vertex)) => column[vertex.index()],
                        _ => f64::INFINITY,
                    };
                }
                observer.step();
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use geodesics::Method;
    use mesh::{RepairOptions, TriMesh, shapes};

    use super::*;

    fn surface(mesh: &TriMesh) -> Surface {
        Surface::new(mesh, &RepairOptions::default(), &()).unwrap()
    }

    /// The matrix, written behind a header with memory for this many rows.
    fn written(surface: &Surface, rows: usize) -> (Vec<f64>, Asymmetry) {
        let solver = Method::default().prepare(surface.intrinsic(), &()).unwrap();
        let memory = rows * surface.n_input_vertices() * BYTES;
        let mut out = Cursor::new(b"header".to_vec());
        out.set_position(6);
        let pairs = AllPairs::new(surface, solver.as_ref(), memory).unwrap();
        let asymmetry = pairs.write(&mut out, &()).unwrap();
        let bytes = out.into_inner();
        assert_eq!(&bytes[..6], b"header");
        (bytes[6..].as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect(), asymmetry)
    }

    #[test]
    fn the_matrix_averages_both_directions_and_does_not_depend_on_memory() {
        let surface = surface(&shapes::jittered_grid(13, 11, 1.0, 0.2, 4));
        let p = surface.n_input_vertices();
        let solver = Method::default().prepare(surface.intrinsic(), &()).unwrap();
        let all: Vec<VertexId> = (0..p).map(VertexId::from).collect();
        let columns = solver.distance_columns(&all).unwrap();
        let expected: Vec<f64> =
            (0..p * p).map(|k| 0.5 * (columns[(k / p, k % p)] + columns[(k % p, k / p)])).collect();
        for rows in [2, 3, 5, 17, 100, p, 10 * p] {
            let (found, asymmetry) = written(&surface, rows);
            assert_eq!(found, expected, "{rows} rows");
            assert!(asymmetry.mean <= asymmetry.largest && asymmetry.largest < 1e-3);
        }
    }

    #[test]
    fn merged_vertices_have_equal_rows_and_dropped_ones_infinite_rows() {
        let mesh = testkit::cracked(&shapes::disjoint(&[shapes::icosphere(2), shapes::cube(0)]), 0);
        let twin = VertexId::from(mesh.n_vertices() - 1);
        let surface = surface(&mesh);
        let p = surface.n_input_vertices();
        let (found, _) = written(&surface, 7);
        let at = |i: usize, j: usize| found[i * p + j];
        assert_eq!((at(0, twin.index()), at(5, 5)), (0.0, 0.0));
        for j in 0..162 {
            assert_eq!(at(0, j), at(twin.index(), j));
            assert!(at(j, 163).is_infinite() && at(163, j).is_infinite());
        }
    }

    #[test]
    fn memory_for_less_than_two_rows_is_refused() {
        let surface = surface(&shapes::grid(4, 4, 1.0));
        let solver = Method::default().prepare(surface.intrinsic(), &()).unwrap();
        let error = AllPairs::new(&surface, solver.as_ref(), 2 * 16 * BYTES - 1).unwrap_err();
        assert!(
            error.to_string().contains("at least 256 bytes of memory at once, more than the 255"),
            "{error}"
        );
        assert_eq!(error.remedy(), Some(Remedy::RaiseMemory));
    }
}
