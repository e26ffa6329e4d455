//! Where the distances of an embedding are kept: in memory, or in a temporary file.

use base::Budget;
use linalg::ColumnStore;

use crate::error::{Error, Remedy};

/// Most memory for distances that are held at once, in bytes, unless the budget says how much.
pub const DISTANCES_LIMIT: usize = 4 << 30;

/// Bytes per vertex while distances are measured by fast marching, besides the distances: one-rings, what relates results to
/// the input, the nearest sample of every vertex, coordinates. Measured with a counting allocator.
const PER_VERTEX: usize = 320;

/// Bytes per vertex and thread: a front, and a column of distances on its way to the file.
const PER_VERTEX_AND_THREAD: usize = 45;

/// Numbers per pair of samples: the matrices of the embedding.
const PER_PAIR: usize = 8;

const BYTES: usize = size_of::<f64>();

/// The memory of an embedding, in bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plan {
    n_vertices: usize,
    n_columns: usize,
    /// The distances.
    columns: usize,
    /// The matrices, and everything else for each vertex.
    matrices: usize,
    per_vertex: usize,
}

impl Plan {
    /// Of `n_vertices` vertices from `n_columns` samples; `n_held_out` further columns, which always stay in memory, measure the stress.
    pub(super) fn new(n_vertices: usize, n_columns: usize, n_held_out: usize) -> Self {
        let n_columns = n_columns.min(n_vertices);
        let columns = n_vertices.saturating_mul(n_columns).saturating_mul(BYTES);
        let matrices = n_columns.saturating_mul(n_columns).saturating_mul(PER_PAIR * BYTES);
        let per_vertex =
            PER_VERTEX + rayon::current_num_threads() * PER_VERTEX_AND_THREAD + n_held_out * BYTES;
        Self { n_vertices, n_columns, columns, matrices, per_vertex }
    }

    /// Bytes of all but the distances.
    fn rest(self) -> usize {
        self.n_vertices.saturating_mul(self.per_vertex).saturating_add(self.matrices)
    }

    /// Refuses what does not fit into memory even with distances in a file.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub(super) fn check(self, budget: &Budget) -> Result<(), Error> {
        let limit = budget.memory().unwrap_or(usize::MAX);
        if budget.spill().is_none() || self.rest() <= limit {
            return Ok(());
        }
        let fits = limit.saturating_sub(self.matrices) / self.per_vertex;
        let what = format!(
            "embedding {} vertices needs about {} bytes of memory with distances in a temporary file, more than the {limit} \
             allowed, which are enough for {fits} vertices",
            self.n_vertices,
            self.rest()
        );
        Err(Error::TooLarge { what, remedy: Remedy::RaiseMemory })
    }

    /// A store for the distances: in memory if they fit, else in a file if the budget names a folder for it.
    ///
    /// # Errors
    /// As [`check`](Self::check); [`Error::Exceeded`] if the budget names no folder;
    /// [`Error::File`].
    pub(super) fn store(self, budget: &Budget) -> Result<ColumnStore, Error> {
        let Some(folder) = budget.spill() else {
            check_memory(self.n_vertices, self.n_columns, budget)?;
            return Ok(ColumnStore::in_memory(self.n_vertices));
        };
        self.check(budget)?;
        let fits = match budget.memory() {
            None => self.columns <= DISTANCES_LIMIT,
            Some(limit) => self.rest().saturating_add(self.columns) <= limit,
        };
        // The system may have less memory than the budget.
        let mut store = ColumnStore::in_memory(self.n_vertices);
        if fits && store.reserve(self.n_columns, &()).is_ok() {
            return Ok(store);
        }
        Ok(ColumnStore::in_file(self.n_vertices, base::files::nameless_in(folder)?))
    }
}

/// Refuses to hold `n_columns` columns of distances to `n_vertices` vertices beyond the memory of the budget or, without one,
/// beyond [`DISTANCES_LIMIT`].
pub(super) fn check_memory(n_vertices: usize, n_columns: usize, budget: &Budget) -> Result<(), Error> {
    let needed = n_vertices.saturating_mul(n_columns).saturating_mul(size_of::<f64>());
    budget.check_memory(needed)?;
    if needed <= DISTANCES_LIMIT || budget.memory().is_some() {
        return Ok(());
    }
    let [needed_mib, limit_mib] = [needed, DISTANCES_LIMIT].map(|bytes| bytes >> 20);
    let what = format!(
        "the distances between {n_vertices} vertices need {needed_mib} MiB, more than the {limit_mib} MiB allowed"
    );
    Err(Error::TooLarge { what, remedy: Remedy::UseNystrom })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_that_do_not_fit_go_to_a_file_and_what_fits_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let plan = Plan::new(1_000_000, 20, 0);
        let budget = |bytes| Budget::unlimited().with_memory(bytes).with_spill(folder.path().to_owned());
        assert!(!plan.store(&budget(4 << 30)).unwrap().is_in_file());
        assert!(plan.store(&budget(plan.rest())).unwrap().is_in_file());
        let error = plan.store(&budget(plan.rest() / 2)).unwrap_err();
        let number = |after: &str| -> usize {
            let text = error.to_string();
            let rest = text.split(after).nth(1).unwrap_or_else(|| panic!("{text}"));
            rest.split(' ').next().unwrap().parse().unwrap()
        };
        let (needed, fits) = (number("needs about "), number("enough for "));
        assert_eq!((needed, error.remedy()), (plan.rest(), Some(Remedy::RaiseMemory)));
        assert!(Plan::new(fits, 20, 0).store(&budget(plan.rest() / 2)).is_ok());
        // Without a limit, only what no usual machine has room for goes to a file.
        let open = Budget::unlimited().with_spill(folder.path().to_owned());
        assert!(!plan.store(&open).unwrap().is_in_file());
        assert!(Plan::new(10_000_000, 100, 0).store(&open).unwrap().is_in_file());
        let nowhere = Plan::new(10_000_000, 100, 0).store(&Budget::unlimited()).unwrap_err();
        assert_eq!(nowhere.remedy(), Some(Remedy::UseNystrom));
        assert!(check_memory(10_000_000, 100, &Budget::unlimited().with_memory(8_000_000_000)).is_ok());
    }
}
