//! Vectors divided into cells, as stored.

use crate::IndexError;
use crate::floats::Floats;
use crate::store::{LIMIT, View};
use crate::tables::{ABOUT, About, CELLS, CENTROIDS, ENTRIES, FUSED, TRIALS};
use crate::vectors::{CellsHeader, Centroids, Part, Trial, Trials, padded};

/// Bytes of vectors in one part of a cell, so that a change writes little.
const PART: usize = 56 << 10;

/// Number of vectors, `n` long, in one part.
pub(super) fn rows_in_part(n: usize) -> usize {
    (PART / (4 * n)).max(1)
}

/// What a search needs to know before it reads cells.
#[derive(Debug)]
pub(crate) struct Heads {
    pub(crate) header: CellsHeader,
    pub(crate) centroids: Centroids,
}

impl Heads {
    pub(crate) fn read(view: View<'_>) -> Result<Self, IndexError> {
        let header = about(view)?.cells;
        let n = padded(header.dim);
        let mut rows = Vec::with_capacity(header.n_cells * n);
        for part in CENTROIDS.rows(view, &[]) {
            rows.extend(part?.1.0);
        }
        match rows.len() == header.n_cells * n {
            true => Ok(Self { header, centroids: Centroids::new(rows, n) }),
            false => Err(view.damaged("the number of its cells is wrong")),
        }
    }

    /// The parts of a cell with their numbers.
    pub(crate) fn parts<'a>(
        &self,
        view: View<'a>,
        cell: u32,
    ) -> impl Iterator<Item = Result<(u32, Part), IndexError>> + use<'a> {
        let n = padded(self.header.dim);
        CELLS.rows(view, &cell.to_be_bytes()).map(move |row| {
            let ([_, number], part) = row?;
            let n_ids = part.ids.len();
            match part.classes.len() == n_ids && part.rows.0.len() == n_ids * n {
                true => Ok((number, part)),
                false => Err(view.damaged("a part of a cell contradicts itself")),
            }
        })
    }

    /// The trials, in the order of their keys.
    pub(crate) fn trials(&self, view: View<'_>) -> Result<Trials, IndexError> {
        let (n, n_cells) = (padded(self.header.dim), self.header.n_cells);
        let checked = |row: Result<_, IndexError>| {
            let (key, trial): (_, Trial) = row?;
            match trial.is_of(n, n_cells) && key == trial.key() {
                true => Ok(trial),
                false => Err(view.damaged("a trial contradicts itself")),
            }
        };
        let all = TRIALS.rows(view, &[]).map(checked).collect::<Result<_, _>>()?;
        Ok(Trials { all, n_cells })
    }
}

/// What holds for the whole index. Sizes are checked: what they promise must fit into the file.
pub(crate) fn about(view: View<'_>) -> Result<About, IndexError> {
    let about = ABOUT.get(view, "")?.ok_or_else(|| view.damaged("its head is missing"))?;
    let CellsHeader { dim, n, n_cells, .. } = about.cells;
    check_length(view, dim)?;
    let rows = (n_cells as u64).saturating_add(n as u64);
    // An empty index has the centre of its one cell, which is stored.
    let fits = rows.saturating_mul(4 * padded(dim) as u64) <= view.n_bytes();
    match (1..=n.max(1)).contains(&n_cells) && fits {
        true => Ok(about),
        false => Err(view.damaged("the sizes of its cells are wrong")),
    }
}

/// Checks the length of the vectors, as the file states it.
fn check_length(view: View<'_>, dim: usize) -> Result<(), IndexError> {
    match (1..=LIMIT / 4).contains(&dim) {
        true => Ok(()),
        false => Err(view.damaged(format!("its vectors have {dim} numbers"))),
    }
}

/// All shapes in ascending order of their names, and the length of a vector without padding; 1 if there are none.
pub(crate) fn all_shapes(view: View<'_>) -> Result<(Part, usize), IndexError> {
    let mut part = Part::default();
    let mut entries = ENTRIES.rows(view, &[]);
    let mut dim = None;
    for row in FUSED.rows(view, &[]) {
        let (id, Floats(fused)) = row?;
        let dim = *dim.get_or_insert(fused.len());
        check_length(view, dim)?;
        if fused.len() != dim {
            let found = fused.len();
            return Err(view.damaged(format!("the vector of `{id}` has {found} numbers, not {dim}")));
        }
        let entry = entries.next().transpose()?.filter(|(known, _)| *known == id);
        let (_, entry) = entry.ok_or_else(|| view.damaged(format!("`{id}` has no entry")))?;
        part.push(&id, &entry.label, &fused);
        part.rows.0.resize(part.ids.len() * padded(dim), 0.0);
    }
    match entries.next().transpose()? {
        None => Ok((part, dim.unwrap_or(1))),
        Some((id, _)) => Err(view.damaged(format!("`{id}` has no vector"))),
    }
}
