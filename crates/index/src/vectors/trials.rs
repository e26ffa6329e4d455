//! Shapes of the index that are searched for to calibrate it.
//!
//! A [`Trial`] keeps the distances from one shape to its nearest others, to the nearest of its class and to the nearest
//! of another class. Shapes that come and go change them one by one, and the result is that of a new start. Which shapes
//! are trials is decided by hashes of their names, so it depends on the shapes alone.

use std::collections::{HashMap, HashSet};
use std::convert::Infallible;
use std::ops::Range;

use rayon::prelude::*;
use retrieval::UnknownThreshold;
use serde::{Deserialize, Serialize};

use super::cells::{Reach, nearest_cells};
use super::kernels::sq_distances_into;
use super::kmeans::Centroids;
use super::part::Part;
use crate::shape::{ShapeKey, shape_key};
use crate::texts::Texts;

/// Number of trials among all shapes, and among those with a class.
const TRIALS: usize = 512;

/// Neighbours searched for in a trial.
pub(crate) const NEIGHBORS: usize = 10;

/// Neighbours kept, so that a few can go before all shapes must be measured again.
const KEPT: usize = 16;

/// Share of the neighbours that must be found: higher than what is promised, because there are few trials.
const RECALL: f64 = 0.994;

/// Rows measured together.
const CHUNK: usize = 256;

/// Trials, and shapes, that meet while both are in the cache.
const GROUP: usize = 16;
const BLOCK: usize = 1024;

/// The key of a shape, and whether it has a class.
type SampleKey = (ShapeKey, bool);

fn sample_key(id: &str, class: &str) -> SampleKey {
    (shape_key(id), !class.is_empty())
}

/// A shape near a trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Near {
    /// Squared distance.
    sq: f32,
    /// Its cell.
    cell: u32,
    id: String,
}

/// A shape and what is near it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Trial {
    pub(crate) id: String,
    class: String,
    row: Vec<f32>,
    /// The nearest other shapes, nearest first; empty if searches are exact.
    near: Vec<Near>,
    /// All shapes nearer than this squared distance are in `near`.
    reach: f32,
    /// The squared distance of the nearest other shape of its class, and the name of that shape.
    own: Option<(f32, String)>,
    /// The same for other classes.
    foreign: Option<(f32, String)>,
    /// Whether a shape has left that something is missing without.
    #[serde(skip)]
    is_stale: bool,
}

/// Called with shapes and the cell of all of them, or of each.
pub(crate) type Visit<'a> = dyn FnMut(&Part, &[u32]) + 'a;

impl Trial {
    /// A trial that has met no shape. In an index of one cell it keeps no neighbours.
    fn new(id: &str, class: &str, row: &[f32], n_cells: usize) -> Self {
        Self {
            id: id.to_owned(),
            class: class.to_owned(),
            row: row.to_vec(),
            near: Vec::new(),
            reach: if n_cells > 1 { f32::INFINITY } else { 0.0 },
            own: None,
            foreign: None,
            is_stale: true,
        }
    }

    /// Its place among the trials.
    pub(crate) fn key(&self) -> ShapeKey {
        shape_key(&self.id)
    }

    /// Whether its vector and its cells can be those of an index.
    pub(crate) fn is_of(&self, n: usize, n_cells: usize) -> bool {
        self.row.len() == n && self.near.iter().all(|near| (near.cell as usize) < n_cells)
    }

    /// Meets some of these shapes, which it has not met before.
    fn meet(&mut self, shapes: &Part, cells: &[u32], range: Range<usize>) {
        let n = self.row.len();
        let mut sqs = [0.0; CHUNK];
        for start in range.clone().step_by(CHUNK) {
            let end = range.end.min(start + CHUNK);
            let sqs = &mut sqs[..end - start];
            sq_distances_into(&self.row, &shapes.rows()[start * n..end * n], sqs);
            let mut bound = self.bound();
            for (i, sq) in (start..).zip(sqs.iter().copied()) {
                if sq <= bound && shapes.ids.get(i) != self.id {
                    let cell = cells[i % cells.len()];
                    self.keep(sq, cell, shapes.ids.get(i), shapes.classes.get(i));
                    bound = self.bound();
                }
            }
        }
    }

    /// Shapes beyond this squared distance change nothing.
    fn bound(&self) -> f32 {
        let least = |known: &Option<(f32, String)>| known.as_ref().map_or(f32::INFINITY, |(sq, _)| *sq);
        match self.class.is_empty() {
            true => self.reach,
            false => self.reach.max(least(&self.own)).max(least(&self.foreign)),
        }
    }

    /// Keeps a shape if it is among the nearest.
    fn keep(&mut self, sq: f32, cell: u32, id: &str, class: &str) {
        if !self.class.is_empty() && !class.is_empty() {
            let place = if class == self.class { &mut self.own } else { &mut self.foreign };
            if place.as_ref().is_none_or(|(least, known)| (sq, id) < (*least, known)) {
                *place = Some((sq, id.to_owned()));
            }
        }
        if sq < self.reach {
            let at = self.near.partition_point(|known| (known.sq, known.id.as_str()) < (sq, id));
            self.near.insert(at, Near { sq, cell, id: id.to_owned() });
            if self.near.len() > KEPT {
                self.near.truncate(KEPT);
                self.reach = self.near.last().map_or(self.reach, |last| last.sq);
            }
        }
    }

    /// Forgets shapes.
    fn part(&mut self, gone: &HashSet<&str>) {
        self.near.retain(|near| !gone.contains(near.id.as_str()));
        let is_gone =
            |known: &Option<(f32, String)>| known.as_ref().is_some_and(|(_, id)| gone.contains(id.as_str()));
        self.is_stale |= is_gone(&self.own) || is_gone(&self.foreign);
        self.is_stale |= self.near.len() < NEIGHBORS && self.reach.is_finite() && self.reach > 0.0;
    }

    /// The borders of the cells nearest to it, relative to the distance of its tenth neighbour, and the places of its
    /// neighbours' cells among them. `None` if it has no neighbours.
    fn walk(&self, centroids: &Centroids, most: usize) -> Option<(Vec<f32>, Vec<usize>)> {
        let near = &self.near[..self.near.len().min(NEIGHBORS)];
        let radius = near.last()?.sq.sqrt();
        let cells = nearest_cells(&self.row, centroids, most);
        let rank = |near: &Near| cells.iter().position(|cell| cell.cell == near.cell).unwrap_or(usize::MAX);
        let relative = |border: f32| if border <= 0.0 { 0.0 } else { border / radius };
        Some((cells.iter().map(|cell| relative(cell.border)).collect(), near.iter().map(rank).collect()))
    }

    /// Whether it agrees with a trial of the same shape that has just met all others. Distances may differ as those of
    /// different processors do.
    fn agrees(&self, fresh: &Self) -> bool {
        let close = |a: f32, b: f32| (a - b).abs() <= 1e-3 * a.max(b) || a == b;
        let same = |a: &Option<(f32, String)>, b: &Option<(f32, String)>| match (a, b) {
            (Some((a, _)), Some((b, _))) => close(*a, *b),
            (None, None) => true,
            _ => false,
        };
        let n = self.near.len();
        (n >= fresh.near.len().min(NEIGHBORS) && n <= fresh.near.len())
            && self.near.iter().zip(&fresh.near).all(|(a, b)| close(a.sq, b.sq))
            && (&self.id, &self.class, &self.row) == (&fresh.id, &fresh.class, &fresh.row)
            && same(&self.own, &fresh.own)
            && same(&self.foreign, &fresh.foreign)
    }
}

/// Which shapes are trials: those whose keys come first, among all shapes and among those with a class.
fn sample(mut keys: Vec<SampleKey>) -> HashSet<ShapeKey> {
    keys.sort_unstable();
    let labelled = keys.iter().filter(|(_, labelled)| *labelled).take(TRIALS);
    keys.iter().take(TRIALS).chain(labelled).map(|(key, _)| *key).collect()
}

/// All trials of an index, in the order of their keys.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trials {
    pub(crate) all: Vec<Trial>,
    pub(crate) n_cells: usize,
}

impl Trials {
    /// Trials of an index that holds `shapes` in `n_cells` cells.
    pub(crate) fn of(shapes: &Part, cells: &[u32], n_cells: usize) -> Self {
        let Ok(trials) = Self::in_pieces(n_cells, |visit| {
            visit(shapes, cells);
            Ok::<_, Infallible>(())
        });
        trials
    }

    /// The same of shapes that `everything` lists in some number of pieces, whenever it is called.
    pub(crate) fn in_pieces<E>(
        n_cells: usize,
        mut everything: impl FnMut(&mut Visit<'_>) -> Result<(), E>,
    ) -> Result<Self, E> {
        let mut keys: Vec<SampleKey> = Vec::new();
        everything(&mut |shapes, _| {
            keys.extend(shapes.shapes().map(|(id, class, _)| sample_key(id, class)))
        })?;
        let sample = sample(keys);
        let mut trials = Self { all: Vec::new(), n_cells };
        everything(&mut |shapes, _| trials.begin(shapes, &sample))?;
        trials.all.sort_by_key(Trial::key);
        let mut all: Vec<&mut Trial> = trials.all.iter_mut().collect();
        everything(&mut |shapes, cells| meet_all(&mut all, shapes, cells))?;
        trials.all.iter_mut().for_each(|trial| trial.is_stale = false);
        Ok(trials)
    }

    /// Adds those of these shapes that are in the sample, as trials that have met no shape.
    fn begin(&mut self, shapes: &Part, sample: &HashSet<ShapeKey>) {
        let held = shapes.shapes().filter(|(id, ..)| sample.contains(&shape_key(id)));
        self.all.extend(held.map(|(id, class, row)| Trial::new(id, class, row, self.n_cells)));
    }

    /// Takes into account which shapes are gone, and which have come, some of them under the same names. `everything` lists
    /// all shapes of the changed index in some number of pieces. It is called only if the changes do not tell enough: rarely,
    /// if the index is large.
    pub(crate) fn change<E>(
        &mut self,
        gone: &Texts,
        come: &Part,
        cells: &[u32],
        mut everything: impl FnMut(&mut Visit<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        let gone: HashSet<&str> = gone.iter().collect();
        let classes: HashMap<&str, &str> = come.ids.iter().zip(come.classes.iter()).collect();
        // A trial that is gone makes room for a shape that is not among the trials, unless all shapes are.
        let makes_room = |trial: &Trial| match classes.get(trial.id.as_str()) {
            Some(class) => class.is_empty() && !trial.class.is_empty(),
            None => gone.contains(trial.id.as_str()),
        };
        if self.all.len() >= TRIALS && self.all.iter().any(makes_room) {
            *self = Self::in_pieces(self.n_cells, everything)?;
            return Ok(());
        }
        self.all.retain(|trial| !gone.contains(trial.id.as_str()));
        self.all.par_iter_mut().for_each(|trial| {
            trial.part(&gone);
            trial.meet(come, cells, 0..come.ids.len());
        });
        let known = self.all.iter().map(|trial| sample_key(&trial.id, &trial.class));
        let new = come.shapes().map(|(id, class, _)| sample_key(id, class));
        let sample = sample(known.chain(new).collect());
        self.all.retain(|trial| sample.contains(&trial.key()));
        self.begin(come, &sample);
        self.all.sort_by_key(Trial::key);
        let mut stale: Vec<&mut Trial> = self.all.iter_mut().filter(|trial| trial.is_stale).collect();
        if !stale.is_empty() {
            for trial in &mut stale {
                **trial = Trial::new(&trial.id, &trial.class, &trial.row, self.n_cells);
            }
            everything(&mut |shapes, cells| meet_all(&mut stale, shapes, cells))?;
            stale.into_iter().for_each(|trial| trial.is_stale = false);
        }
        Ok(())
    }

    /// Whether stored trials are those of these shapes.
    pub(crate) fn agree(&self, fresh: &Self) -> bool {
        self.all.len() == fresh.all.len() && self.all.iter().zip(&fresh.all).all(|(a, b)| a.agrees(b))
    }

    /// Distance beyond which a query belongs to no class of the index.
    pub(crate) fn threshold(&self) -> Option<UnknownThreshold> {
        let distances = |of: fn(&Trial) -> &Option<(f32, String)>| -> Vec<f64> {
            let known = self.all.iter().filter_map(|trial| of(trial).as_ref());
            known.map(|(sq, _)| f64::from(*sq).sqrt()).collect()
        };
        UnknownThreshold::of(&distances(|trial| &trial.own), &distances(|trial| &trial.foreign))
    }

    /// Which cells must be scanned to reach [`RECALL`], and the recall reached.
    pub(crate) fn calibrated(&self, centroids: &Centroids) -> (Reach, f64) {
        if self.n_cells < 2 {
            return (Reach::ALL, 1.0);
        }
        // Rarely is a neighbour in a cell farther than this.
        const USUAL: usize = 64;
        let choices = [USUAL.min(self.n_cells), self.n_cells];
        let found = choices.into_iter().find_map(|most| self.calibrated_among(centroids, most));
        found.unwrap_or((Reach::ALL, 1.0))
    }

    /// The same, if as few as `most` cells are enough.
    fn calibrated_among(&self, centroids: &Centroids, most: usize) -> Option<(Reach, f64)> {
        /// Numbers of cells to choose from, beginning with the least that is enough.
        const CHOICES: usize = 16;
        let walks: Vec<(Vec<f32>, Vec<usize>)> =
            self.all.par_iter().filter_map(|trial| trial.walk(centroids, most)).collect();
        // Where each neighbour is found: how many cells are nearer, and the border of its cell.
        let mut found: Vec<(usize, f32)> = Vec::new();
        for (borders, ranks) in &walks {
            found.extend(
                ranks.iter().map(|rank| (*rank, borders.get(*rank).copied().unwrap_or(f32::INFINITY))),
            );
        }
        let wanted = ((RECALL * found.len() as f64).ceil() as usize).max(1);
        let mut ranks: Vec<usize> = found.iter().map(|(rank, _)| *rank).collect();
        ranks.sort_unstable();
        let least = 1 + ranks.get(wanted - 1).copied()?;
        let choice = |probes: usize| {
            let mut borders: Vec<f32> =
                found.iter().filter(|(rank, _)| *rank < probes).map(|(_, border)| *border).collect();
            borders.sort_unstable_by(f32::total_cmp);
            let margin = *borders.get(wanted - 1)?;
            let scanned =
                |borders: &[f32]| borders.iter().take(probes).filter(|border| **border <= margin).count();
            let mut scanned: Vec<usize> = walks.iter().map(|(borders, _)| scanned(borders)).collect();
            scanned.sort_unstable();
            // Slow answers count as well as usual ones.
            let slow = scanned[(99 * scanned.len()) / 100];
            let cost = 4 * scanned.iter().sum::<usize>() + slow * scanned.len();
            let within = borders.partition_point(|border| *border <= margin);
            Some((cost, Reach { probes, margin }, within as f64 / found.len() as f64))
        };
        let choices = (least..=most).take(CHOICES).filter_map(choice);
        choices.min_by_key(|(cost, ..)| *cost).map(|(_, reach, recall)| (reach, recall))
    }
}

/// Lets trials meet all of these shapes, a group of trials and a block of shapes at a time.
fn meet_all(trials: &mut [&mut Trial], shapes: &Part, cells: &[u32]) {
    let n_shapes = shapes.ids.len();
    trials.par_chunks_mut(GROUP).for_each(|group| {
        for first in (0..n_shapes).step_by(BLOCK) {
            for trial in &mut *group {
                trial.meet(shapes, cells, first..(first + BLOCK).min(n_shapes));
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::super::testing::{clustered, noise};
    use super::*;

    /// Shapes with names and classes, and their cells, all derived from their numbers.
    fn shapes(numbers: impl Iterator<Item = usize>, all: &[f32]) -> (Part, Vec<u32>) {
        let (mut shapes, mut cells) = (Part::default(), Vec::new());
        for i in numbers {
            shapes.push(&format!("s{i}"), &class(i), &all[i * 16..][..16]);
            cells.push(i as u32 % 7);
        }
        (shapes, cells)
    }

    fn trials((shapes, cells): &(Part, Vec<u32>), n_cells: usize) -> Trials {
        Trials::of(shapes, cells, n_cells)
    }

    fn class(i: usize) -> String {
        if i.is_multiple_of(5) { String::new() } else { format!("c{}", i % 40) }
    }

    /// The same trials, whatever is beyond what both know.
    fn assert_same(changed: &Trials, fresh: &Trials) {
        assert!(changed.agree(fresh));
        assert_eq!(changed.threshold(), fresh.threshold());
        for (a, b) in changed.all.iter().zip(&fresh.all) {
            assert_eq!((&a.id, &a.own, &a.foreign), (&b.id, &b.own, &b.foreign));
            assert_eq!(a.near[..], b.near[..a.near.len()]);
        }
    }

    #[test]
    fn changes_lead_where_a_new_start_leads() {
        let all = clustered(3000, 40, 16, 0.2).0;
        for n_cells in [1, 7] {
            let mut changed = trials(&shapes(0..300, &all), n_cells);
            let mut present: Vec<usize> = (0..300).collect();
            let mut asked = 0;
            // Grows beyond the number of trials, and shrinks again.
            for step in 0..60 {
                let new = (300 + 40 * step..340 + 40 * step).filter(|_| step < 40);
                let gone: Vec<usize> =
                    present.iter().copied().filter(|i| (i * 7 + step).is_multiple_of(60)).collect();
                present.retain(|i| !gone.contains(i));
                present.extend(new.clone());
                let gone = gone.iter().map(|i| format!("s{i}")).collect();
                let (come, cells) = shapes(new, &all);
                let now = shapes(present.iter().copied(), &all);
                let everything = |visit: &mut Visit<'_>| {
                    asked += 1;
                    visit(&now.0, &now.1);
                    Ok::<(), ()>(())
                };
                changed.change(&gone, &come, &cells, everything).unwrap();
                assert_same(&changed, &trials(&now, n_cells));
            }
            assert!(asked > 0);
        }
    }

    #[test]
    fn an_addition_that_is_no_trial_measures_trials_only() {
        let all = noise(2000, 16, 3);
        let mut changed = trials(&shapes(0..1999, &all), 1);
        let before = changed.clone();
        let outside = (0..).map(|i| format!("x{i}")).find(|id| shape_key(id) > u64::MAX - (1000 << 32));
        let mut come = Part::default();
        come.push(&outside.unwrap_or_default(), "c1", &all[1999 * 16..]);
        changed.change(&Texts::default(), &come, &[0], |_| Err("nothing else is needed")).unwrap();
        assert_eq!(changed.all.len(), before.all.len());
    }

    #[test]
    fn pieces_give_the_trials_of_the_whole() {
        let all = noise(900, 16, 5);
        let pieces = [0..10, 10..700, 700..900].map(|range| shapes(range, &all));
        let found = Trials::in_pieces(7, |visit| {
            pieces.iter().for_each(|(shapes, cells)| visit(shapes, cells));
            Ok::<_, Infallible>(())
        });
        assert_eq!(found, Ok(trials(&shapes(0..900, &all), 7)));
    }

    #[test]
    fn matches_the_threshold_from_all_pairs() {
        let positions = [0.0f32, 1.0, 2.5, 10.0, 11.0, 30.0];
        let threshold = |classes: [&str; 6]| {
            let mut shapes = Part::default();
            for (i, (x, class)) in positions.iter().zip(classes).enumerate() {
                shapes.push(&i.to_string(), class, &[&[*x][..], &[0.0; 15]].concat());
            }
            Trials::of(&shapes, &[0], 1).threshold()
        };
        // Own: 1, 1, 1.5, 1, 1; foreign: 10, 9, 7.5, 7.5, 8.5, 19.
        let expected = UnknownThreshold { distance: 4.5, missed: 0.0, mistaken: 0.0 };
        assert_eq!(threshold(["a", "a", "a", "b", "b", "c"]), Some(expected));
        assert_eq!(threshold(["a", "b", "c", "d", "e", "f"]), None);
        assert_eq!(threshold([""; 6]), None);
    }
}
