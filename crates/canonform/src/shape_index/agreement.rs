//! How well the classes of an index and the distances of its shapes agree.

use std::collections::HashMap;
use std::path::PathBuf;

use base::{ContentHash, Observer};
use descriptors::{Boundary, PreparedShape, Sample, ShapeMetric};
use index::{Entry, Index, IndexError, IndexWriter, Shape};
use retrieval::Neighbor;
use serde::{Deserialize, Serialize};

use super::record::options_of;
use super::rerank::rerank;
use crate::error::Error;
use crate::form::DescribeOptions;

/// The least number of pairs of one class from which a boundary is fitted.
const LEAST: usize = 30;

/// Shapes among which hits are found, those whose hashed names come first, and how many of them are queries.
const SHAPES: usize = 512;
const QUERIES: usize = 64;

/// Hits of each query, as many as a search lists by default.
const HITS: usize = 10;

/// Two forms that coincide say no more than two that nearly do: their distance, in units of two poses.
const LEAST_DISTANCE: f64 = 1e-3;

/// Parts of the queries that are held out one by one.
const FOLDS: usize = 5;

/// The note of an index that states it.
const NOTE: &str = "agreement";

/// What an index states.
#[derive(Serialize, Deserialize)]
struct Note {
    /// Hash of what it was fitted to; earlier versions state none.
    fitted_to: Option<ContentHash>,
    #[serde(flatten)]
    found: Option<Agreement>,
}

impl Note {
    fn read(text: Option<String>) -> Option<Self> {
        serde_json::from_str(&text?).ok()
    }
}

/// Where hits of the class of a query end in a collection, and how well that separates them from others.
///
/// Shapes of the collection are the queries. A query is missing from its class, so hits of that class weigh more, as much as if it
/// were there: probabilities are to be true of the hits that searches list for other shapes of these classes. Pairs drawn at random
/// would not do: in an index of ten classes nine of ten pairs are of two, but not nine of ten hits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// Hits of the class of their query.
    pub same_class: usize,
    /// Hits of other classes. Where all hits are of one class, the nearest shape of another class is one, too.
    pub other_classes: usize,
    /// The combined distance at which both are equally likely.
    pub boundary: f64,
    /// How fast the odds change there.
    pub steepness: f64,
    /// Probabilities of one class infinitely far away and at distance 0.
    pub range: [f64; 2],
    /// The share of hits that are on their side of the boundary that hits of other queries have, by cross-validation; both kinds being
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
        let n_queries = shapes.len().min(QUERIES);
        let of_class = |own: &Entry| {
            let others =
                shapes.iter().filter(|other| other.label == own.label && other.content != own.content);
            others.count().min(HITS)
        };
        // Either shape of a pair may be the query. Forms are not aligned for too few pairs.
        if shapes[..n_queries].iter().map(of_class).sum::<usize>() < 2 * LEAST {
            return Ok(None);
        }
        observer.begin("comparing classes", n_queries);
        let read = |entry: &Entry| options.prepare(&shape(&entry.id)?);
        let prepared = shapes.iter().map(read).collect::<Result<Vec<_>, Error>>()?;
        let hits = |query| {
            observer.budget().check()?;
            observer.step();
            hits(&shapes, &prepared, query)
        };
        // Each search aligns in parallel.
        let hits = (0..n_queries).map(hits).collect::<Result<Vec<_>, Error>>()?;
        let count = |kind| hits.iter().flatten().filter(|(_, is_one, _)| *is_one == kind).count();
        let [other_classes, same_class] = [false, true].map(count);
        if same_class < 2 * LEAST || other_classes == 0 {
            return Ok(None);
        }
        let [mut right, mut all] = [[0.0; 2]; 2];
        for fold in 0..FOLDS {
            let (held_out, known): (Vec<_>, Vec<_>) =
                hits.iter().enumerate().partition(|(query, _)| query % FOLDS == fold);
            let boundary = boundary(known.into_iter().flat_map(|(_, hits)| hits).copied().collect());
            for &(distance, is_one, weight) in held_out.into_iter().flat_map(|(_, hits)| hits) {
                all[usize::from(is_one)] += weight;
                if (boundary.probability(distance) > 0.5) == is_one {
                    right[usize::from(is_one)] += weight;
                }
            }
        }
        let agree = 0.5 * (right[0] / all[0] + right[1] / all[1]);
        let Boundary { at: boundary, steepness, range } = boundary(hits.concat());
        Ok(Some(Self { same_class, other_classes, boundary, steepness, range, agree }))
    }

    /// The boundary of classes.
    pub fn classes(&self) -> Boundary {
        Boundary { at: self.boundary, steepness: self.steepness, range: self.range }
    }

    /// What an index states.
    pub(super) fn stated(index: &Index) -> Result<Option<Self>, IndexError> {
        Ok(Note::read(index.note(NOTE)?).and_then(|note| note.found))
    }
}

/// The shapes with a class among which hits are found.
fn drawn(mut shapes: Vec<Entry>) -> Vec<Entry> {
    shapes.retain(|shape| !shape.label.is_empty());
    shapes.sort_by_cached_key(|shape| ContentHash::of(&[&shape.id]).start());
    shapes.truncate(SHAPES);
    shapes
}

/// The hits of a shape among the others: whether they are of its class, and their weights.
fn hits(shapes: &[Entry], prepared: &[PreparedShape], query: usize) -> Result<Vec<Sample>, Error> {
    let (own, asked) = (&shapes[query], &prepared[query]);
    let is_one = |i: usize| shapes[i].label == own.label;
    let others = (0..shapes.len()).filter(|&i| shapes[i].content != own.content);
    let bound = |index: usize| {
        let distance = ShapeMetric::robust(&asked.fused, &prepared[index].fused);
        Neighbor { index, distance }
    };
    let mut near: Vec<Neighbor> = others.map(bound).collect();
    near.sort_by(Neighbor::by_distance);
    let nearest = |near: &[Neighbor], k| {
        let found = rerank(asked, near.iter().copied(), k, |i| Ok(&prepared[i]))?.nearest.into_iter();
        Ok::<_, Error>(found.map(|(hit, _)| (hit.distance.max(LEAST_DISTANCE), is_one(hit.index))))
    };
    let class = near.iter().filter(|other| is_one(other.index)).count() as f64;
    let (mut room, mut hits) = (HITS as f64, Vec::new());
    for (distance, is_one) in nearest(&near, HITS)? {
        let weight = f64::min(room, if is_one { (class + 1.0) / class } else { 1.0 });
        room -= weight;
        if weight > 0.0 {
            hits.push((distance, is_one, weight));
        }
    }
    if hits.iter().all(|(_, is_one, _)| *is_one) {
        near.retain(|other| !is_one(other.index));
        hits.extend(nearest(&near, 1)?.map(|(distance, is_one)| (distance, is_one, 1.0)));
    }
    Ok(hits)
}

/// The boundary of some hits. One more of each kind is at the farthest and the nearest distance of the others, where it
/// contradicts them (rule of succession), so that the fit is finite.
fn boundary(mut hits: Vec<Sample>) -> Boundary {
    let [low, high] =
        hits.iter().fold([f64::INFINITY, 0.0], |[low, high], (d, ..)| [d.min(low), d.max(high)]);
    hits.extend([(high, true, 1.0), (low, false, 1.0)]);
    // Where most far hits are of one class, too, no distance has equal odds, unless all odds are reached.
    let found = [[0.1, 0.9], [0.0, 1.0]].map(|range| Boundary::fitted(&hits, range));
    let is_usable = |found: &Boundary| found.at.is_finite() && found.at > 0.0 && found.steepness > 0.0;
    // Else hits of one class are no nearer than others: no distance tells anything.
    found.into_iter().find(is_usable).unwrap_or(Boundary::new(ShapeMetric::SAME_CLASS.at, 0.0))
}

/// All that decides about the boundary of an index: the shapes that are drawn and how they are described and compared.
fn hash(drawn: &[Entry]) -> ContentHash {
    let shape = |shape: &Entry| [shape.id.clone(), shape.label.clone(), shape.content.to_string()];
    let version = ShapeMetric::VERSION.to_string();
    ContentHash::of(&drawn.iter().flat_map(shape).chain([version]).collect::<Vec<_>>())
}

/// Finishes an index, with what its classes say. That is found again only where it may have changed.
pub(super) fn finish(
    mut writer: IndexWriter,
    options: &DescribeOptions,
    observer: &dyn Observer,
) -> Result<Index, Error> {
    let shapes = drawn(writer.entries()?);
    let fitted_to = Some(hash(&shapes));
    if Note::read(writer.note(NOTE)?).is_none_or(|known| known.fitted_to != fitted_to) {
        let found = Agreement::of(shapes, options, |id| writer.shape(id), observer)?;
        writer.set_note(NOTE, serde_json::to_string(&Note { fitted_to, found }).ok().as_deref())?;
    }
    Ok(writer.finish()?)
}
