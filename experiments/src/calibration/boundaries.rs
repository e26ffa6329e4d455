//! The boundaries between shapes and classes, by logistic regression on creatures, and how often they are right about plans that
//! were held out.

use std::io::Write;

use anyhow::Result;
use canonform::Observer;
use datasets::creature_plans;
use descriptors::{Boundary, PreparedShape, Sample, ShapeMetric, ShapePair};
use rayon::prelude::*;

use super::{creature, described, held_out, print_reliability, rounded};
use crate::sweep;

/// Vertices of the meshes.
const VERTICES: [usize; 3] = [250, 1000, 5000];

/// Families of every plan, bodies of every family, and poses of every body.
const FAMILIES: usize = 9;
const BODIES: usize = 2;
const POSES: usize = 2;

/// Pairs of two families whose forms are aligned, evenly drawn: that takes long.
const PAIRS_OF_FAMILIES: usize = 12_000;

/// How frequent pairs are: poses of one body, bodies of one family, two families.
type Prior = [f64; 3];

/// One shape or two of one class, equally frequent.
const OF_SHAPES: Prior = [0.5, 0.5, 0.0];

/// One class or two, equally frequent; of one class, one shape and two are equally frequent.
const OF_CLASSES: Prior = [0.25, 0.25, 0.5];

/// A shape of a family of a plan.
struct Creature {
    plan: usize,
    family: usize,
    body: usize,
    shape: PreparedShape,
}

/// Two creatures: which kind of pair they are, their plans, and their combined distance.
#[derive(Debug, Clone, Copy)]
struct CreaturePair {
    kind: usize,
    plans: [usize; 2],
    distance: f64,
}

fn generated(n_plans: usize, number: usize) -> Result<Creature> {
    let (pose, rest) = (number % POSES, number / POSES);
    let (body, family) = (rest % BODIES, rest / BODIES);
    // An orthogonal array: in the nine families of a plan, any two of the four shapes have every two resolutions once.
    let (i, j) = (family / n_plans % 3, family / n_plans / 3);
    let shape = body * POSES + pose;
    let n_vertices = VERTICES[[i, j, i + j, i + 2 * j][shape] % VERTICES.len()];
    // The rest pose is left out, and no pose is there twice.
    let (_, shape) = described(&creature(2, [family, body, 1 + shape], n_vertices)?)?;
    Ok(Creature { plan: family % n_plans, family, body, shape })
}

/// All pairs of one family, and some of two.
fn pairs(creatures: &[Creature]) -> Vec<(usize, &Creature, &Creature)> {
    let (one, two): (Vec<_>, Vec<_>) = sweep::pairs(creatures).partition(|(a, b)| a.family == b.family);
    let one = one.into_iter().map(|(a, b)| (usize::from(a.body != b.body), a, b));
    let n = PAIRS_OF_FAMILIES.min(two.len());
    one.chain((0..n).map(|i| two[i * two.len() / n]).map(|(a, b)| (2, a, b))).collect()
}

/// The weights of the kinds that make pairs as frequent as a prior says.
fn weights(pairs: &[&CreaturePair], prior: Prior) -> [f64; 3] {
    [0, 1, 2].map(|kind| prior[kind] / pairs.iter().filter(|pair| pair.kind == kind).count().max(1) as f64)
}

/// The boundary of greatest likelihood between kinds below `second` and the others.
fn between(pairs: &[&CreaturePair], prior: Prior, second: usize) -> Boundary {
    let weights = weights(pairs, prior);
    let sample = |pair: &&CreaturePair| (pair.distance, pair.kind < second, weights[pair.kind]);
    Boundary::fitted(&pairs.iter().map(sample).collect::<Vec<Sample>>(), [0.1, 0.9])
}

/// The boundaries of shapes and of classes. Of one plan more, which is not known, distances are taken to say nothing about shapes:
/// the rule of succession.
fn both(pairs: &[&CreaturePair]) -> [Boundary; 2] {
    let n_plans = creature_plans().len() as f64;
    let shape = between(pairs, OF_SHAPES, 1);
    let range = shape.range.map(|share| (n_plans * share + 0.5) / (n_plans + 1.0));
    [Boundary { range, ..shape }, between(pairs, OF_CLASSES, 2)]
}

/// Prints the boundaries beside those in use, and how reliable they are: for pairs of any two plans, by the boundaries that the
/// other plans give.
pub(crate) fn print(observer: &dyn Observer, out: &mut impl Write) -> Result<()> {
    let n_plans = creature_plans().len();
    let n = n_plans * FAMILIES * BODIES * POSES;
    observer.begin("describing creatures", n);
    let one = |number| {
        observer.step();
        generated(n_plans, number)
    };
    let creatures = (0..n).into_par_iter().map(one).collect::<Result<Vec<_>>>()?;
    let chosen = pairs(&creatures);
    observer.begin("aligning creatures", chosen.len());
    let measured = |(kind, a, b): &(usize, &Creature, &Creature)| {
        observer.step();
        let distance = ShapePair::new([&a.shape, &b.shape]).distance().combined;
        CreaturePair { kind: *kind, plans: [a.plan.min(b.plan), a.plan.max(b.plan)], distance }
    };
    let pairs: Vec<CreaturePair> = chosen.par_iter().map(measured).collect();
    let all: Vec<&CreaturePair> = pairs.iter().collect();
    let in_use = [("SAME_SHAPE", ShapeMetric::SAME_SHAPE), ("SAME_CLASS", ShapeMetric::SAME_CLASS)];
    for (found, (name, used)) in both(&all).map(rounded).into_iter().zip(in_use) {
        writeln!(out, "{name}: {found:?}; {}", if found == used { "in use" } else { "not the one in use" })?;
    }
    let weights = weights(&all, OF_CLASSES);
    let stated = |boundaries: &[Boundary; 2], pair: &CreaturePair| -> [Sample; 2] {
        let [shape, class] = boundaries.map(|boundary| boundary.probability(pair.distance));
        let weight = weights[pair.kind];
        [(shape * class, pair.kind == 0, weight), (class, pair.kind < 2, weight)]
    };
    let stated = held_out(&pairs, |pair| &pair.plans, both, stated, observer);
    for (what, i) in [("one shape", 0), ("one class", 1)] {
        print_reliability(out, what, &stated.iter().map(|both| both[i]).collect::<Vec<_>>())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::reliability;
    use super::*;

    #[test]
    fn a_fit_finds_the_boundary_that_pairs_were_drawn_from() {
        let truth = Boundary { range: [0.2, 0.9], ..Boundary::new(2.0, 9.0) };
        let pairs: Vec<CreaturePair> = (0..40_000)
            .map(|i| {
                let combined = 1.0 + 2.0 * f64::from(i % 200) / 200.0;
                let is_one = f64::from(i / 200) / 200.0 < truth.probability(combined);
                CreaturePair { kind: if is_one { 1 } else { 2 }, plans: [0; 2], distance: combined }
            })
            .collect();
        let ones = pairs.iter().filter(|pair| pair.kind == 1).count() as f64 / pairs.len() as f64;
        let found = between(&pairs.iter().collect::<Vec<_>>(), [0.0, ones, 1.0 - ones], 2);
        assert!((found.at - 2.0).abs() < 0.02 && (found.steepness - 9.0).abs() < 0.2, "{found:?}");
        assert!(
            found.range.iter().zip(truth.range).all(|(found, truth)| (found - truth).abs() < 0.01),
            "{found:?}"
        );
        let stated: Vec<Sample> =
            pairs.iter().map(|pair| (truth.probability(pair.distance), pair.kind == 1, 1.0)).collect();
        assert!(
            reliability(&stated).iter().all(|[n, stated, truth]| *n < 50.0 || (stated - truth).abs() < 0.02)
        );
    }
}
