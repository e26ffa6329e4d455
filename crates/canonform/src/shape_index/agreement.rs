//! How well the classes of an index and the distances of its shapes agree.

use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;

use base::{ContentHash, Observer};
use descriptors::{Boundary, PreparedShape, Sample, ShapeMetric, ShapePair};
use index::{Entry, Index, IndexError, IndexWriter, Shape};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::record::options_of;
use crate::error::Error;
use crate::form::DescribeOptions;

/// The least number of pairs of one class from which a boundary is fitted, and the most of either kind whose forms are aligned.
const LEAST: usize = 30;
const MOST: usize = 100;

/// Shapes whose pairs are drawn, those whose hashed names come first.
const SHAPES: usize = 512;

/// Parts of the pairs that are held out one by one.
const FOLDS: usize = 5;

/// The note of an index that states it.
const NOTE: &str = "agreement";

/// Where pairs of one class end in a collection, and how well that separates them from others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// Pairs of one class that were measured.
    pub same_class: usize,
    /// Pairs of two classes that were measured.
    pub other_classes: usize,
    /// The combined distance at which both are equally likely.
    pub boundary: f64,
    /// How fast the odds change there.
    pub steepness: f64,
    /// The share of pairs that are on their side of the boundary that the others have, by cross-validation; both kinds being
    /// equally frequent. One half says that distances tell nothing about these classes.
    pub agree: f64,
}

impl Agreement {
    /// Of the index that would hold the shapes of all of these, which have different names; `None` if too few pairs have a class.
    ///
    /// # Errors
    /// [`Error::Index`], also for indexes whose shapes were described with different options.
    pub fn of_indexes(paths: &[PathBuf], observer: &dyn Observer) -> Result<Option<Self>, Error> {
        let indexes = paths.iter().map(|path| Index::open(path)).collect::<Result<Vec<_>, _>>()?;
        let Some(first) = indexes.first() else { return Ok(None) };
        let (mut shapes, mut of) = (Vec::new(), HashMap::new());
        for index in &indexes {
            index.expect_options(&first.options)?;
            for shape in drawn(index.entries()?) {
                of.insert(shape.id.clone(), index);
                shapes.push(shape);
            }
        }
        Self::of(shapes, &options_of(first)?, |id| of[id].shape(id), observer)
    }

    /// Of shapes, those without a class left out; `None` if too few pairs have one.
    pub(super) fn of(
        shapes: Vec<Entry>,
        options: &DescribeOptions,
        shape: impl Fn(&str) -> Result<Shape, IndexError>,
        observer: &dyn Observer,
    ) -> Result<Option<Self>, Error> {
        let shapes = drawn(shapes);
        let pairs = (0..shapes.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let (same, others): (Vec<_>, Vec<_>) = pairs
            .filter(|&(i, j)| shapes[i].content != shapes[j].content)
            .partition(|&(i, j)| shapes[i].label == shapes[j].label);
        if same.len() < LEAST || others.is_empty() {
            return Ok(None);
        }
        let some = |pairs: &[(usize, usize)]| -> Vec<(usize, usize)> {
            let n = pairs.len().min(MOST);
            (0..n).map(|i| pairs[i * pairs.len() / n]).collect()
        };
        let (same, others) = (some(&same), some(&others));
        let needed: BTreeSet<usize> = same.iter().chain(&others).flat_map(|&(i, j)| [i, j]).collect();
        let prepared = needed.into_iter().map(|i| Ok((i, options.prepare(&shape(&shapes[i].id)?)?)));
        let prepared = prepared.collect::<Result<HashMap<usize, PreparedShape>, Error>>()?;
        observer.begin("comparing classes", same.len() + others.len());
        let budget = observer.budget();
        let sample = |&(i, j): &(usize, usize)| {
            budget.check()?;
            let distance = ShapePair::new([&prepared[&i], &prepared[&j]]).distance().combined;
            observer.step();
            let is_one = shapes[i].label == shapes[j].label;
            let weight = 0.5 / if is_one { same.len() } else { others.len() } as f64;
            // Two forms that coincide say no more than two that nearly do.
            Ok::<Sample, Error>((distance.max(1e-3), is_one, weight))
        };
        let samples =
            [&same[..], &others].concat().par_iter().map(sample).collect::<Result<Vec<_>, Error>>()?;
        let agree: f64 = (0..FOLDS)
            .map(|fold| {
                let (held_out, known): (Vec<_>, Vec<_>) =
                    samples.iter().enumerate().partition(|(i, _)| i % FOLDS == fold);
                let boundary = boundary(&known.into_iter().map(|(_, sample)| *sample).collect::<Vec<_>>());
                let right = held_out.into_iter().map(|(_, sample)| sample);
                let right =
                    right.filter(|(distance, is_one, _)| (boundary.probability(*distance) > 0.5) == *is_one);
                right.map(|(.., weight)| weight).sum::<f64>()
            })
            .sum();
        let Boundary { at, steepness, .. } = boundary(&samples);
        Ok(Some(Self { same_class: same.len(), other_classes: others.len(), boundary: at, steepness, agree }))
    }

    /// The boundary of classes.
    pub fn classes(&self) -> Boundary {
        Boundary::new(self.boundary, self.steepness)
    }

    /// What an index states.
    pub(super) fn stated(index: &Index) -> Result<Option<Self>, IndexError> {
        Ok(index.note(NOTE)?.and_then(|text| serde_json::from_str(&text).ok()))
    }
}

/// The shapes with a class whose pairs are compared.
fn drawn(mut shapes: Vec<Entry>) -> Vec<Entry> {
    shapes.retain(|shape| !shape.label.is_empty());
    shapes.sort_by_cached_key(|shape| ContentHash::of(&[&shape.id]).start());
    shapes.truncate(SHAPES);
    shapes
}

/// The boundary of some pairs. One more pair of each kind is at the farthest and the nearest distance of the others, where it
/// contradicts them (rule of succession), so that the fit is finite.
fn boundary(samples: &[Sample]) -> Boundary {
    let ends = samples.iter().fold([f64::INFINITY, 0.0], |[low, high], (d, ..)| [d.min(low), d.max(high)]);
    let weight = |kind: bool| {
        samples.iter().find(|(_, is_one, _)| *is_one == kind).map_or(0.0, |(.., weight)| *weight)
    };
    let more = [(ends[1], true, weight(true)), (ends[0], false, weight(false))];
    let found = Boundary::fitted(&[samples, &more].concat(), [0.0, 1.0]);
    match found.at.is_finite() && found.at > 0.0 && found.steepness > 0.0 {
        true => found,
        // Pairs of one class are no nearer than others: no distance tells anything.
        false => Boundary::new(ShapeMetric::SAME_CLASS.at, 0.0),
    }
}

/// Finishes an index, with what its classes say.
pub(super) fn finish(
    mut writer: IndexWriter,
    options: &DescribeOptions,
    observer: &dyn Observer,
) -> Result<Index, Error> {
    let found = Agreement::of(writer.entries()?, options, |id| writer.shape(id), observer)?;
    let text = found.and_then(|found| serde_json::to_string(&found).ok());
    writer.set_note(NOTE, text.as_deref())?;
    Ok(writer.finish()?)
}
