//! The class that the nearest shapes suggest, or why there is none.

use descriptors::{Boundary, PartDistance, ShapeMetric};
use index::Facts;
use relations::Relation;
use retrieval::{Labels, Neighbor, Tally, vote};
use serde::Serialize;

use super::found::{Hit, OrderedBy};

/// Neighbors that vote on the class of a query.
const VOTERS: usize = 5;

/// How many results of each index are needed for the `k` best of all and the class: those that vote are among them.
pub fn n_results(k: usize) -> usize {
    // The query may be one of them.
    k.max(VOTERS + 1)
}

/// A vote is split if the winner has less than this share of it.
const CLEAR: f64 = 2.0 / 3.0;

/// Parts may be of a class if they fit it and no shape of another class less than this times as far away. Chosen on parts of 19
/// built-in classes, halves and 70 % by planes: with the class in the index, 35 of 38 were named and none wrongly; without it,
/// 5 instead of 17 were. Of views from one side, 2 of 19 were named wrongly instead of 15.
const CLEAR_FIT: f64 = 1.2;

/// A query without this share of its surface may be a part of a shape.
const DROPPED: f64 = 0.01;

/// A query whose longest boundary, over the square root of its area, is longer may be a part of a shape. A body that is
/// cut at the waist or a limb that is cut off has about 1, a scan with small holes under 0.1.
const OPEN: f64 = 0.3;

/// The class that the nearest shapes suggest.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Prediction {
    /// The class; `None` if no shape is near enough.
    pub label: Option<String>,
    /// Neighbors of that class.
    pub votes: usize,
    /// Neighbors that are near enough to vote.
    pub voters: usize,
    /// Share of the votes for the class, from 0 to 1; nearer neighbors count more.
    pub confidence: f64,
    /// Combined distance below which a shape votes, as it may be of one class with the query; part distance, if
    /// the query is taken as a part.
    pub class_below: f64,
    /// The votes for every class, most first.
    pub tally: Vec<ClassVotes>,
    /// The nearest shape; `None` if the index is empty.
    pub nearest: Option<NearestShape>,
    /// Why there is no class.
    pub unknown: Option<Unknown>,
    /// The class, or why there is none, in words.
    pub explanation: String,
    /// What is wrong with the query, in a sentence that ends the explanation.
    pub warning: Option<String>,
}

/// The votes for a class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClassVotes {
    /// The class.
    pub label: String,
    /// Neighbors of this class.
    pub votes: usize,
    /// Their share of the weights, from 0 to 1.
    pub share: f64,
}

/// The shape nearest to a query.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NearestShape {
    /// Its name.
    pub id: String,
    /// Its class.
    pub label: String,
    /// How the query and this shape are related.
    pub relation: Relation,
}

/// Why a query has no class.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unknown {
    /// The index has no shapes.
    EmptyIndex,
    /// None of the nearest shapes has a class.
    Unlabelled,
    /// No shape is near enough.
    NothingNear,
    /// The query fits as a part of shapes of several classes nearly as well.
    SeveralClasses,
    /// No shape is near enough, and the query looks like a part of a shape, but was compared as a whole.
    Partial,
}

/// What makes a surface look like a part of one, in words.
fn signs_of_a_part(facts: &Facts) -> Vec<String> {
    let mut signs = Vec::new();
    if facts.dropped_area_share > DROPPED {
        signs.push(format!("{:.0} % of its surface is not used", 100.0 * facts.dropped_area_share));
    }
    let open = facts.longest_boundary / facts.area.sqrt();
    if open > OPEN {
        signs.push(format!("a boundary is {open:.1} times as long as the square root of its area"));
    }
    signs
}

/// The warning that a query has shortcuts, places where distant parts of the surface were welded.
fn shortcut_warning(facts: &Facts) -> Option<String> {
    let places = match facts.shortcuts {
        0 => return None,
        1 => "one place".to_owned(),
        n => format!("{n} places"),
    };
    Some(format!(
        "The query probably has a shortcut: distant parts of its surface are joined in {places}; it was compared as if they were separate"
    ))
}

/// The vote of the first [`VOTERS`] results but the query itself, so that it does not depend on their number.
///
/// A result at combined distance `d` votes if `r = d / c` is below 1, with `c` the boundary of a class; its weight is `(1 - r²)²`. If
/// the query is taken as a part, `r` is the part distance over [`CLEAR_FIT`] times the smallest, but at most that of parts of shapes
/// of one class, and the vote has to be unanimous.
pub(super) fn predicted(results: &[Hit], classes: Option<Boundary>, query: &Facts) -> Prediction {
    let others: Vec<&Hit> = results.iter().filter(|result| !result.itself).take(VOTERS).collect();
    let results = &others[..];
    let as_part = results.first().and_then(|first| part_distance(first));
    let class_below =
        as_part.map_or(classes.unwrap_or(ShapeMetric::SAME_CLASS).at, |_| PartDistance::SAME_CLASS);
    let labels = Labels::new(&results.iter().map(|result| &result.label).collect::<Vec<_>>());
    let label = |class: usize| labels.classes()[class].clone();
    // A surface of a few faces fits at distance 0.
    let part_limit = as_part.map(|nearest| (CLEAR_FIT * nearest).min(class_below).max(f64::MIN_POSITIVE));
    let reach = |result: &Hit| match part_distance(result).zip(part_limit) {
        Some((distance, limit)) => distance / limit,
        None => result.relation.evidence.distance.combined / class_below,
    };
    // Shapes without a class have no vote.
    let labelled = results.iter().enumerate().filter(|(_, result)| !result.label.is_empty());
    let neighbors: Vec<_> =
        labelled.map(|(index, result)| Neighbor { index, distance: reach(result) }).collect();
    let vote = vote(&neighbors, |i| labels.class(i), VOTERS, Some(1.0));
    let of_class = |of: &Tally| ClassVotes { label: label(of.class), votes: of.votes, share: of.share };
    let tally = vote.tally.iter().map(of_class).collect();
    let nearest = results.first().map(|result| NearestShape {
        id: result.id.clone(),
        label: result.label.clone(),
        relation: result.relation.clone(),
    });
    let signs = signs_of_a_part(query);
    let unknown = match (vote.class(), &nearest) {
        (Some(_), _) if as_part.is_some() && vote.tally.len() > 1 => Some(Unknown::SeveralClasses),
        (Some(_), _) => None,
        (None, None) => Some(Unknown::EmptyIndex),
        (None, Some(_)) if neighbors.is_empty() => Some(Unknown::Unlabelled),
        (None, Some(_)) if signs.is_empty() || as_part.is_some() => Some(Unknown::NothingNear),
        (None, Some(_)) => Some(Unknown::Partial),
    };
    let mut found = Prediction {
        label: vote.class().map(label).filter(|_| unknown.is_none()),
        votes: vote.tally.first().map_or(0, |winner| winner.votes),
        voters: vote.voters,
        confidence: vote.tally.first().map_or(0.0, |winner| winner.share),
        class_below,
        tally,
        nearest,
        unknown,
        explanation: String::new(),
        warning: shortcut_warning(query),
    };
    found.explanation = found.in_words(&signs, as_part);
    if let Some(warning) = &found.warning {
        found.explanation += &format!(". {warning}");
    }
    found
}

/// How well the query fits as a part, if results are ordered by that.
fn part_distance(result: &Hit) -> Option<f64> {
    match result.order {
        Some(OrderedBy::Part { part_distance, .. }) => Some(part_distance),
        _ => None,
    }
}

impl Prediction {
    fn in_words(&self, signs: &[String], as_part: Option<f64>) -> String {
        if let Some(label) = &self.label {
            return self.vote_in_words(label, as_part.is_some());
        }
        let Some(nearest) = &self.nearest else { return "unknown. The index is empty".to_owned() };
        let distance = nearest.relation.evidence.distance.combined;
        let relation = nearest.relation.in_brief();
        if self.unknown == Some(Unknown::Unlabelled) {
            return format!(
                "unknown. None of the nearest shapes has a class; the nearest, {}, is at combined distance {distance:.3}: {relation}",
                nearest.id
            );
        }
        let class = match nearest.label.as_str() {
            "" => "without a class".to_owned(),
            label => format!("of the class {label}"),
        };
        if self.unknown == Some(Unknown::SeveralClasses) {
            let classes: Vec<&str> = self.tally.iter().map(|of| of.label.as_str()).collect();
            return format!(
                "unknown. The query fits as a part of {} nearly as well",
                classes.join(" and of ")
            );
        }
        if let Some(distance) = as_part {
            return format!(
                "unknown. The query fits best as a part of {} {class}, at part distance {distance:.3}; parts of shapes of one class are below {:.3}",
                nearest.id, self.class_below
            );
        }
        let mut words = format!(
            "unknown. The nearest shape, {} {class}, is at combined distance {distance:.3}: {relation}. Shapes of one class are below {:.3}",
            nearest.id, self.class_below
        );
        if self.unknown == Some(Unknown::Partial) {
            words += &format!(
                ". The query may be a part of a shape ({}), but was compared as a whole; ranking by parts compares it as one",
                signs.join(", ")
            );
        }
        words
    }

    fn vote_in_words(&self, label: &str, as_part: bool) -> String {
        let mut words = format!("{label}, by {} of {} votes", self.votes, self.voters);
        // Parts have a class by unanimous votes only.
        if as_part {
            return words;
        }
        if let [_, others @ ..] = &self.tally[..]
            && !others.is_empty()
        {
            let others: Vec<_> = others.iter().map(|o| format!("{} {}", o.label, o.votes)).collect();
            let split = if self.confidence < CLEAR { "; the vote is split" } else { "" };
            let share = 100.0 * self.confidence;
            words += &format!(", {share:.0} % of their weight{split}; other votes: {}", others.join(", "));
        }
        words
    }
}

#[cfg(test)]
mod tests {
    use descriptors::ShapeDistance;
    use rigid::Handedness;

    use super::*;

    /// Results of these classes at these distances.
    fn results(found: &[(&str, f64)]) -> Vec<Hit> {
        let hit = |(rank, &(label, distance)): (usize, &(&str, f64))| {
            let shape = ShapeDistance { fused: distance, combined: distance };
            Hit {
                rank,
                id: format!("{label}{rank}"),
                label: label.to_owned(),
                itself: false,
                path: String::new(),
                distance,
                fused: distance,
                order: None,
                relation: Relation::by_distance(shape, 1.0, Handedness::Unknown),
                comparison: None,
            }
        };
        (1..).zip(found).map(hit).collect()
    }

    fn closed() -> Facts {
        Facts { area: 1.0, ..Facts::default() }
    }

    #[test]
    fn the_nearest_shapes_vote_and_what_is_unknown_says_why() {
        let [near, far]: [&[(&str, f64)]; 2] =
            [&[("cat", 0.9), ("cat", 1.0)], &[("cat", 9.25), ("dog", 9.5)]];
        let open = Facts { longest_boundary: 1.25, ..closed() };
        let lossy = Facts { dropped_area_share: 0.14, ..closed() };
        let small_holes = Facts { dropped_area_share: 0.001, longest_boundary: 0.05, ..closed() };
        let welded = |shortcuts| Facts { shortcuts, ..closed() };
        let people: &[_] = &[("david", 1.0), ("michael", 1.05), ("david", 1.1), ("michael", 1.1)];
        type Row<'a> =
            (&'a [(&'a str, f64)], Option<f64>, Facts, Result<(&'a str, usize), Unknown>, &'a [&'a str]);
        let table: [Row<'_>; 12] = [
            (near, None, closed(), Ok(("cat", 2)), &["cat, by 2 of 2 votes"]),
            // Classes of a collection may be narrower or wider than those of the metric.
            (near, Some(0.2), closed(), Err(Unknown::NothingNear), &["one class are below 0.200"]),
            (near, Some(9.0), open, Ok(("cat", 2)), &[]),
            (near, None, welded(1), Ok(("cat", 2)), &["probably has a shortcut", "in one place"]),
            (near, None, welded(3), Ok(("cat", 2)), &["in 3 places"]),
            (
                people,
                None,
                closed(),
                Ok(("david", 2)),
                &["2 of 4 votes, 50 % of their weight; the vote is split; other votes: michael 2"],
            ),
            (far, Some(10.0), closed(), Ok(("cat", 1)), &[]),
            (
                far,
                None,
                small_holes,
                Err(Unknown::NothingNear),
                &["cat1", "9.250", "not the same shape", "one class are below 3.730"],
            ),
            (far, None, lossy, Err(Unknown::Partial), &["14 % of its surface", "ranking by parts"]),
            (far, None, open, Err(Unknown::Partial), &["1.2 times", "ranking by parts"]),
            (
                &[("", 0.5)],
                None,
                closed(),
                Err(Unknown::Unlabelled),
                &["None of the nearest shapes has a class"],
            ),
            (&[], None, closed(), Err(Unknown::EmptyIndex), &["The index is empty"]),
        ];
        for (found, width, facts, expected, words) in table {
            let classes = width.map(|at| Boundary::new(at, 1.0));
            let hits = results(found);
            let Prediction { label, votes, unknown, explanation, tally, nearest, .. } =
                predicted(&hits, classes, &facts);
            assert_eq!(unknown.map_or(Ok((label.as_deref().unwrap_or_default(), votes)), Err), expected);
            assert!(words.iter().all(|words| explanation.contains(words)), "{explanation}");
            assert!(explanation.contains("shortcut") == (facts.shortcuts > 0), "{explanation}");
            assert_eq!(
                nearest.map(|nearest| nearest.relation).as_ref(),
                hits.first().map(|hit| &hit.relation)
            );
            let shares = tally.iter().map(|of| of.share).sum::<f64>();
            assert!(tally.is_empty() || (shares - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn no_shape_votes_on_its_own_class() {
        let mut near = results(&[("dog", 0.0), ("cat", 0.9), ("cat", 1.0)]);
        near[0].itself = true;
        let found = predicted(&near, None, &closed());
        assert_eq!((found.label.as_deref(), found.voters), (Some("cat"), 2));
        assert_eq!(found.nearest.unwrap().id, "cat2");
    }

    #[test]
    fn parts_vote_by_how_well_they_fit() {
        // A surface of a few faces fits everywhere.
        for (fits, expected, words) in [
            ([0.3, 1.2], Ok("cat"), "cat, by 1 of 1 votes"),
            ([0.3, 0.35], Err(Unknown::SeveralClasses), "as a part of cat and of dog"),
            ([0.0, 0.0], Err(Unknown::SeveralClasses), "nearly as well"),
            ([1.1, 1.2], Err(Unknown::NothingNear), "fits best as a part of cat1"),
        ] {
            let mut hits = results(&[("cat", 9.0), ("dog", 9.0)]);
            for (hit, times) in hits.iter_mut().zip(fits) {
                let part_distance = times * PartDistance::SAME_CLASS;
                hit.order = Some(OrderedBy::Part { part_distance, part_share: 0.7 });
            }
            let facts = Facts { longest_boundary: 1.25, ..closed() };
            let found = predicted(&hits, None, &facts);
            assert_eq!(found.unknown.map_or(Ok(found.label.as_deref().unwrap_or_default()), Err), expected);
            assert!(found.explanation.contains(words), "{}", found.explanation);
        }
    }
}
