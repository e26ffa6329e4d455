//! The distance beyond which a shape belongs to none of the classes of an index.

use std::ops::Range;

use rayon::prelude::*;
use retrieval::UnknownThreshold;

use super::kernels::losses_into;
use super::table::VectorTable;

/// Shapes with a class whose nearest others are looked for, at most: those whose hashed names come first.
const TRIALS: usize = 512;

/// Trials, and vectors, that meet while both are in the cache.
const GROUP: usize = 16;
const BLOCK: usize = 1024;

/// Orders shapes at random: the first 64 bits of the hash of a name.
type ShapeKey = u64;

fn shape_key(id: &str) -> ShapeKey {
    base::ContentHash::of(&[id]).start()
}

/// Called with the vectors and the classes of some shapes.
type Visit<'a> = dyn FnMut(&VectorTable, &[String]) + 'a;

/// A shape, and the least squared distances to others of its class and of other classes.
struct Trial {
    key: ShapeKey,
    id: String,
    class: String,
    row: Vec<f32>,
    own: f32,
    foreign: f32,
}

impl Trial {
    fn new(key: ShapeKey, i: usize, vectors: &VectorTable, classes: &[String]) -> Self {
        let (id, class) = (vectors.id(i).to_owned(), classes[i].clone());
        let row = vectors.rows(i..i + 1).to_vec();
        Self { key, id, class, row, own: f32::INFINITY, foreign: f32::INFINITY }
    }

    /// Compares it with some of the shapes, at most a block.
    fn meet(&mut self, shapes: Range<usize>, vectors: &VectorTable, classes: &[String], unlimited: &[f32]) {
        let mut sqs = [0.0; BLOCK];
        let sqs = &mut sqs[..shapes.len()];
        losses_into(&self.row, unlimited, vectors.rows(shapes.clone()), sqs);
        for (i, sq) in shapes.zip(sqs) {
            // The class of most does not matter, so that no names are compared.
            if *sq < self.own.max(self.foreign) && !classes[i].is_empty() && vectors.id(i) != self.id {
                let least = if classes[i] == self.class { &mut self.own } else { &mut self.foreign };
                *least = least.min(*sq);
            }
        }
    }
}

/// The threshold of all shapes that `each` visits, in pieces; it is called twice.
pub(crate) fn threshold<E>(
    each: impl Fn(&mut Visit<'_>) -> Result<(), E>,
) -> Result<Option<UnknownThreshold>, E> {
    let mut trials: Vec<Trial> = Vec::new();
    each(&mut |vectors, classes| {
        let labelled = (0..vectors.len()).filter(|i| !classes[*i].is_empty());
        let mut keys: Vec<(ShapeKey, usize)> = labelled.map(|i| (shape_key(vectors.id(i)), i)).collect();
        keys.sort_unstable();
        keys.truncate(TRIALS);
        trials.extend(keys.into_iter().map(|(key, i)| Trial::new(key, i, vectors, classes)));
        trials.sort_by_key(|trial| trial.key);
        trials.truncate(TRIALS);
    })?;
    let unlimited = vec![f32::INFINITY; trials.first().map_or(0, |trial| trial.row.len())];
    each(&mut |vectors, classes| {
        trials.par_chunks_mut(GROUP).for_each(|group| {
            for start in (0..vectors.len()).step_by(BLOCK) {
                let shapes = start..(start + BLOCK).min(vectors.len());
                group.iter_mut().for_each(|trial| trial.meet(shapes.clone(), vectors, classes, &unlimited));
            }
        });
    })?;
    let distances = |sq: fn(&Trial) -> f32| -> Vec<f64> {
        trials.iter().map(|trial| f64::from(sq(trial)).sqrt()).collect()
    };
    Ok(UnknownThreshold::from_distances(&distances(|trial| trial.own), &distances(|trial| trial.foreign)))
}
