//! The boundaries between shapes and classes, by logistic regression on creatures, and how often they are right about plans that
//! were held out.

use std::io::Write;

use anyhow::Result;
use canonform::{DescribeOptions, Observer, Surface, describe};
use datasets::{CreatureOptions, creature_body, creature_plans};
use descriptors::{Boundary, PreparedShape, ShapeDistance, ShapeMetric, ShapePair};
use rayon::prelude::*;

use crate::families::coarse;

/// Vertices of the meshes.
const VERTICES: [usize; 3] = [250, 1000, 5000];

/// Families of every plan, bodies of every family, and poses of every body at each number of vertices.
const FAMILIES: usize = 3;
const BODIES: usize = 2;
const POSES: usize = 2;

/// Pairs of two families whose forms are aligned, evenly drawn: that takes long.
const PAIRS_OF_FAMILIES: usize = 12_000;

/// Groups of plans; two of them are held out at a time.
const FOLDS: usize = 7;

/// How frequent pairs are: poses of one body, bodies of one family, two families.
type Prior = [f64; 3];

/// One shape or two of one class, equally frequent.
const OF_SHAPES: Prior = [0.5, 0.5, 0.0];

/// One class or two, equally frequent; of one class, one shape and two are equally frequent.
const OF_CLASSES: Prior = [0.25, 0.25, 0.5];

/// A shape of a family, and the group of plans that it belongs to.
struct Creature {
    fold: usize,
    family: usize,
    body: usize,
    shape: PreparedShape,
}

/// Two creatures: which kind of pair they are, the groups of their plans, and how far apart they are.
#[derive(Debug, Clone, Copy)]
struct CreaturePair {
    kind: usize,
    folds: [usize; 2],
    distance: ShapeDistance,
}

fn described(n_plans: usize, number: usize) -> Result<Creature> {
    let (pose, rest) = (number % POSES, number / POSES);
    let (size, rest) = (rest % VERTICES.len(), rest / VERTICES.len());
    let (body, family) = (rest % BODIES, rest / BODIES);
    let n_vertices = VERTICES[size];
    let options = CreatureOptions { seed: 2, n_vertices: n_vertices.max(1000), ..Default::default() };
    // The rest pose is left out, and no pose is there at two resolutions.
    let mesh = creature_body(family, body, 1 + size * POSES + pose, &options, &())?.mesh;
    let mesh = if n_vertices < mesh.n_vertices() { coarse(&mesh, n_vertices) } else { mesh };
    let options = DescribeOptions::default();
    let description = describe(&Surface::new(&mesh, &options.form.repair, &())?, &options, &())?;
    Ok(Creature { fold: family % n_plans % FOLDS, family, body, shape: description.prepare()? })
}

/// All pairs of one family, and some of two.
fn pairs(creatures: &[Creature]) -> Vec<(usize, &Creature, &Creature)> {
    let all = creatures.iter().enumerate().flat_map(|(i, a)| creatures[..i].iter().map(move |b| (a, b)));
    let (one, two): (Vec<_>, Vec<_>) = all.partition(|(a, b)| a.family == b.family);
    let one = one.into_iter().map(|(a, b)| (usize::from(a.body != b.body), a, b));
    let n = PAIRS_OF_FAMILIES.min(two.len());
    one.chain((0..n).map(|i| two[i * two.len() / n]).map(|(a, b)| (2, a, b))).collect()
}

/// Weights that make pairs as frequent as a prior says.
fn weights(pairs: &[CreaturePair], prior: Prior) -> Vec<f64> {
    let counts = [0, 1, 2].map(|kind| pairs.iter().filter(|pair| pair.kind == kind).count().max(1));
    pairs.iter().map(|pair| prior[pair.kind] / counts[pair.kind] as f64).collect()
}

/// The log-logistic boundary of greatest likelihood between kinds below `second` and the others, by Newton's method.
fn fitted(pairs: &[CreaturePair], prior: Prior, second: usize) -> Boundary {
    let weights = weights(pairs, prior);
    let [mut a, mut b] = [0.0, -1.0];
    for _ in 0..50 {
        let (mut gradient, mut hessian) = ([0.0; 2], [0.0; 3]);
        for (pair, weight) in pairs.iter().zip(&weights) {
            let x = pair.distance.combined.ln();
            let p = 1.0 / (1.0 + (-a - b * x).exp());
            let rest = weight * (f64::from(u8::from(pair.kind < second)) - p);
            gradient = [gradient[0] + rest, gradient[1] + rest * x];
            let spread = weight * p * (1.0 - p);
            hessian = [hessian[0] + spread, hessian[1] + spread * x, hessian[2] + spread * x * x];
        }
        let determinant = hessian[0] * hessian[2] - hessian[1] * hessian[1];
        a += (hessian[2] * gradient[0] - hessian[1] * gradient[1]) / determinant;
        b += (hessian[0] * gradient[1] - hessian[1] * gradient[0]) / determinant;
    }
    Boundary { at: (-a / b).exp(), steepness: -b }
}

/// The boundaries of shapes and of classes.
fn both(pairs: &[CreaturePair]) -> [Boundary; 2] {
    [fitted(pairs, OF_SHAPES, 1), fitted(pairs, OF_CLASSES, 2)]
}

/// In ten bins of the stated probabilities: the number of pairs, the mean of what is stated, and the share that is true.
fn reliability(stated: &[(f64, bool, f64)]) -> Vec<[f64; 3]> {
    let bin = |i: usize| {
        let inside = |p: f64| ((10.0 * p) as usize).min(9) == i;
        let (mut n, mut sums) = (0.0, [0.0; 3]);
        for (p, is_true, weight) in stated.iter().filter(|(p, ..)| inside(*p)) {
            n += 1.0;
            let truth = f64::from(u8::from(*is_true));
            sums = [sums[0] + weight, sums[1] + weight * p, sums[2] + weight * truth];
        }
        [n, sums[1] / sums[0], sums[2] / sums[0]]
    };
    (0..10).map(bin).collect()
}

/// Prints the boundaries beside those in use, and how reliable they are: for pairs of any two groups of plans, by the boundaries
/// that the other groups give.
pub(crate) fn print(observer: &dyn Observer, out: &mut impl Write) -> Result<()> {
    let n_plans = creature_plans().len();
    let n = n_plans * FAMILIES * BODIES * VERTICES.len() * POSES;
    observer.begin("describing creatures", n);
    let one = |number| {
        observer.step();
        described(n_plans, number)
    };
    let creatures = (0..n).into_par_iter().map(one).collect::<Result<Vec<_>>>()?;
    let chosen = pairs(&creatures);
    observer.begin("aligning creatures", chosen.len());
    let measured = |(kind, a, b): &(usize, &Creature, &Creature)| {
        observer.step();
        let distance = ShapePair::new([&a.shape, &b.shape]).distance();
        CreaturePair { kind: *kind, folds: [a.fold.min(b.fold), a.fold.max(b.fold)], distance }
    };
    let pairs: Vec<CreaturePair> = chosen.par_iter().map(measured).collect();
    let in_use = [("SAME_SHAPE", ShapeMetric::SAME_SHAPE), ("SAME_CLASS", ShapeMetric::SAME_CLASS)];
    for (found, (name, used)) in both(&pairs).into_iter().zip(in_use) {
        let Boundary { at, steepness } = found;
        writeln!(out, "{name} at {at:.3}, steepness {steepness:.2}; in use {}, {}", used.at, used.steepness)?;
    }
    let mut stated: [Vec<(f64, bool, f64)>; 2] = Default::default();
    let all_weights = weights(&pairs, OF_CLASSES);
    for held_out in (0..FOLDS).flat_map(|i| (i..FOLDS).map(move |j| [i, j])) {
        let is_known = |pair: &&CreaturePair| pair.folds.iter().all(|fold| !held_out.contains(fold));
        let [shape, class] = both(&pairs.iter().filter(is_known).copied().collect::<Vec<_>>());
        for (pair, weight) in pairs.iter().zip(&all_weights).filter(|(pair, _)| pair.folds == held_out) {
            let p = class.probability(pair.distance.combined);
            stated[0].push((shape.probability(pair.distance.combined) * p, pair.kind == 0, *weight));
            stated[1].push((p, pair.kind < 2, *weight));
        }
    }
    writeln!(
        out,
        "\n| stated | one shape: pairs | mean | true | one class: pairs | mean | true |\n|---|---|---|---|---|---|---|"
    )?;
    for (i, (shape, class)) in reliability(&stated[0]).into_iter().zip(reliability(&stated[1])).enumerate() {
        let cells = |[n, stated, truth]: [f64; 3]| format!("{n} | {stated:.3} | {truth:.3}");
        writeln!(out, "| .{i} to {:.1} | {} | {} |", (i + 1) as f64 / 10.0, cells(shape), cells(class))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_finds_the_boundary_that_pairs_were_drawn_from() {
        let truth = Boundary { at: 2.0, steepness: 5.0 };
        let pairs: Vec<CreaturePair> = (0..40_000)
            .map(|i| {
                let combined = 1.0 + 2.0 * f64::from(i % 200) / 200.0;
                let is_one = f64::from(i / 200) / 200.0 < truth.probability(combined);
                let distance = ShapeDistance { fused: combined, combined };
                CreaturePair { kind: if is_one { 1 } else { 2 }, folds: [0; 2], distance }
            })
            .collect();
        let ones = pairs.iter().filter(|pair| pair.kind == 1).count() as f64 / pairs.len() as f64;
        let found = fitted(&pairs, [0.0, ones, 1.0 - ones], 2);
        assert!((found.at - 2.0).abs() < 0.02 && (found.steepness - 5.0).abs() < 0.1, "{found:?}");
        let stated: Vec<_> = pairs
            .iter()
            .map(|pair| (truth.probability(pair.distance.combined), pair.kind == 1, 1.0))
            .collect();
        assert!(
            reliability(&stated).iter().all(|[n, stated, truth]| *n < 50.0 || (stated - truth).abs() < 0.02)
        );
    }
}
