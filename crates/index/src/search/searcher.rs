//! Searching in memory, and what a search finds.

use rayon::prelude::*;

use super::kernels::padded;
use super::kmeans::Centroids;
use super::nearest::{Hit, Nearest};
use super::plan::{About, nearest_cells, scan};
use super::stored::Stored;
use crate::{Index, IndexError};
use retrieval::UnknownThreshold;

/// Rows that are worth a task of their own.
const TASK: usize = 8192;

/// How carefully a search looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SearchMode {
    /// Exactly in small indexes; in large ones, into as many cells as find nearly all.
    #[default]
    Auto,
    /// At every shape.
    Exact,
}

impl SearchMode {
    pub(super) fn probes(self, about: &About) -> usize {
        match self {
            Self::Auto => about.probes,
            Self::Exact => about.sizes.len(),
        }
    }
}

/// A shape that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct NearShape {
    /// Its name.
    pub id: String,
    /// Euclidean distance of its vector from the query.
    pub distance: f64,
}

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Nearest first, equally near ones by name.
    pub shapes: Vec<NearShape>,
    /// Shapes that were measured.
    pub n_measured: usize,
    /// Shapes of the index.
    pub n_shapes: usize,
    /// Share of the ten nearest that a search like this finds, by trial when the index was finished; 1
    /// for an exact search.
    pub recall: f64,
    /// A shape whose nearest one is farther is of no class of the index; `None` where classes are too small to
    /// tell.
    pub threshold: Option<UnknownThreshold>,
}

impl Found {
    pub(super) fn new(
        mut shapes: Vec<NearShape>,
        n_measured: usize,
        about: &About,
        mode: SearchMode,
    ) -> Self {
        // What was chosen in single precision is put in order in double.
        shapes.sort_by(|a, b| a.distance.total_cmp(&b.distance).then_with(|| a.id.cmp(&b.id)));
        let is_exact = mode == SearchMode::Exact || about.is_exact();
        Self {
            shapes,
            n_measured,
            n_shapes: about.n,
            recall: if is_exact { 1.0 } else { about.recall },
            threshold: about.threshold,
        }
    }
}

/// Euclidean distance, summed in double precision in the order of the numbers.
pub(super) fn distance(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (f64::from(*x) - f64::from(*y)).powi(2)).sum::<f64>().sqrt()
}

/// A query as rows are stored.
pub(super) fn prepared(query: &[f32], about: &About) -> Result<Vec<f32>, IndexError> {
    if about.n > 0 && query.len() != about.dim {
        let (found, expected) = (query.len(), about.dim);
        return Err(IndexError::OtherLength { id: "the query".to_owned(), found, expected });
    }
    if !query.iter().all(|x| x.is_finite()) {
        return Err(IndexError::BadVector { id: "the query".to_owned() });
    }
    let mut row = query.to_vec();
    row.resize(padded(about.dim), 0.0);
    Ok(row)
}

/// All vectors of an index in memory, for many searches.
#[derive(Debug)]
pub struct Searcher {
    about: About,
    centroids: Centroids,
    /// Where each cell begins, and the end of the last.
    starts: Vec<usize>,
    slots: Vec<u32>,
    rows: Vec<f32>,
    names: Names,
    /// Place of every slot among `rows`.
    places: Vec<u32>,
}

/// Names one behind the other.
#[derive(Debug, Default)]
struct Names {
    text: String,
    ends: Vec<usize>,
}

impl Names {
    fn of(stored: &Stored<'_>) -> Result<Self, IndexError> {
        let mut names = Self::default();
        stored.each_names(|part| {
            for name in part {
                names.text += &name;
                names.ends.push(names.text.len());
            }
        })?;
        names.text.shrink_to_fit();
        names.ends.shrink_to_fit();
        Ok(names)
    }

    fn len(&self) -> usize {
        self.ends.len()
    }

    fn get(&self, slot: u32) -> &str {
        let start = slot.checked_sub(1).map_or(0, |before| self.ends[before as usize]);
        &self.text[start..self.ends[slot as usize]]
    }
}

impl Searcher {
    /// Reads the vectors of an index: `4 d` bytes a shape, and its name.
    ///
    /// # Errors
    /// [`IndexError::Io`], [`IndexError::Damaged`].
    pub fn load(index: &Index) -> Result<Self, IndexError> {
        let store = index.store();
        let stored = Stored::open(&store)?;
        let n = padded(stored.about.dim);
        let mut slots = Vec::with_capacity(stored.about.n);
        let mut rows = Vec::with_capacity(stored.about.n * n);
        stored.each_cell(|of_part, of_rows| {
            slots.extend_from_slice(of_part);
            rows.extend_from_slice(of_rows);
        })?;
        let names = Names::of(&stored)?;
        let mut places = vec![0; names.len()];
        for (place, slot) in slots.iter().enumerate() {
            if let Some(entry) = places.get_mut(*slot as usize) {
                *entry = place as u32;
            }
        }
        let mut starts = vec![0];
        starts.extend(stored.about.sizes.iter().scan(0, |end, size| {
            *end += *size as usize;
            Some(*end)
        }));
        if slots.len() != names.len() || rows.len() != names.len() * n || starts.last() != Some(&slots.len())
        {
            let what = "its parts do not fit together".to_owned();
            return Err(IndexError::Damaged { path: index.path().to_owned(), what });
        }
        let Stored { about, centroids, .. } = stored;
        Ok(Self { about, centroids, starts, slots, rows, names, places })
    }

    /// The `k` shapes whose vectors are nearest to `query`.
    ///
    /// # Errors
    /// [`IndexError::OtherLength`], [`IndexError::BadVector`].
    pub fn nearest(&self, query: &[f32], k: usize, mode: SearchMode) -> Result<Found, IndexError> {
        let row = prepared(query, &self.about)?;
        let n = row.len();
        let (nearest, n_measured) = if mode.probes(&self.about) >= self.about.sizes.len() {
            let start = || Nearest::new(k);
            let parts = self.slots.par_chunks(TASK).zip(self.rows.par_chunks(TASK * n));
            let nearest = parts
                .fold(start, |mut nearest, (slots, rows)| {
                    scan(&row, slots, rows, &mut nearest);
                    nearest
                })
                .reduce(start, Nearest::join);
            (nearest, self.slots.len())
        } else {
            let (mut nearest, mut n_measured) = (Nearest::new(k), 0);
            for cell in nearest_cells(&row, &self.centroids, self.about.probes) {
                let [start, end] = [0, 1].map(|i| self.starts[cell as usize + i]);
                n_measured += end - start;
                scan(&row, &self.slots[start..end], &self.rows[start * n..end * n], &mut nearest);
            }
            (nearest, n_measured)
        };
        let neighbor = |Hit { slot, .. }: Hit| {
            let place = self.places[slot as usize] as usize;
            let id = self.names.get(slot).to_owned();
            NearShape { id, distance: distance(query, &self.rows[place * n..][..query.len()]) }
        };
        let neighbors = nearest.into_sorted().into_iter().map(neighbor).collect();
        Ok(Found::new(neighbors, n_measured, &self.about, mode))
    }
}
