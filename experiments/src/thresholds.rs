//! The boundaries between shapes, classes and everything else, measured on the built-in families.

use std::io::Write;

use anyhow::Result;
use datasets::{ArticulatedOptions, Family, articulated_body};
use descriptors::{Boundary, ShapeMetric, ShapePair};
use rayon::prelude::*;

use crate::described::DescribedBody;

/// Other bodies of every family, and poses of each.
const BODIES: usize = 5;
const POSES: usize = 3;

/// Pairs of either kind whose forms are aligned: that takes long.
const MOST_PAIRS: usize = 2000;

/// The other bodies of every family, for the seed and the number of vertices in `options`.
pub(crate) fn relatives(options: &ArticulatedOptions) -> Result<Vec<DescribedBody>> {
    let one = |family: Family, i: usize| {
        let (body, pose) = (1 + i / POSES, (i % POSES + options.seed as usize) % family.n_shapes());
        DescribedBody::new(&articulated_body(family, body, pose, options)?, options.seed, body)
    };
    let all: Vec<_> =
        Family::all().into_iter().flat_map(|f| (0..BODIES * POSES).map(move |i| (f, i))).collect();
    all.into_par_iter().map(|(family, i)| one(family, i)).collect()
}

/// Kinds of pairs of shapes.
const PAIRS: [&str; 3] = ["poses of one body", "bodies of one family", "families"];

/// The number of the kind of a pair in [`PAIRS`].
fn kind(a: &DescribedBody, b: &DescribedBody) -> usize {
    match (a.label == b.label, a.body == b.body) {
        (true, true) => 0,
        (true, false) => 1,
        (false, _) => 2,
    }
}

/// The distances of one kind of pairs, in ascending order, with the mean and the variance of their logarithms.
struct DistanceSpread {
    distances: Vec<f64>,
    mean: f64,
    variance: f64,
}

impl DistanceSpread {
    fn new(mut distances: Vec<f64>) -> Self {
        distances.sort_by(f64::total_cmp);
        let n = distances.len() as f64;
        let mean = distances.iter().map(|d| d.ln()).sum::<f64>() / n;
        let variance = distances.iter().map(|d| (d.ln() - mean).powi(2)).sum::<f64>() / n;
        Self { distances, mean, variance }
    }

    fn quantile(&self, share: f64) -> f64 {
        self.distances[(share * (self.distances.len() - 1) as f64) as usize]
    }
}

/// The boundaries in use, from the distances of poses, bodies and families: see [`ShapeMetric::SAME_SHAPE`] and
/// [`ShapeMetric::SAME_CLASS`].
fn boundaries([poses, bodies, families]: [&DistanceSpread; 3]) -> [Boundary; 2] {
    let shape = Boundary {
        at: (0.5 * (poses.mean + bodies.mean)).exp(),
        steepness: (bodies.mean - poses.mean) / (0.5 * (poses.variance + bodies.variance)),
    };
    let class = Boundary {
        at: (poses.quantile(0.99) * families.quantile(0.01)).sqrt(),
        steepness: (families.mean - bodies.mean) / bodies.variance,
    };
    [shape, class]
}

/// Prints the combined distances of poses of one body, of bodies of one family and of families, and the boundaries
/// between them beside those in use.
pub(crate) fn print(shapes: &[DescribedBody], out: &mut impl Write) -> Result<()> {
    let pairs: Vec<_> =
        shapes.iter().enumerate().flat_map(|(i, a)| shapes[..i].iter().map(move |b| (a, b))).collect();
    writeln!(out, "\n{:<22}  pairs  least     5 %  median    95 %  largest", "combined distances")?;
    let mut spreads = Vec::new();
    for (i, name) in PAIRS.into_iter().enumerate() {
        let related: Vec<_> = pairs.iter().filter(|(a, b)| kind(a, b) == i).collect();
        let step = related.len().div_ceil(MOST_PAIRS).max(1);
        let distances: Vec<f64> = related
            .par_iter()
            .step_by(step)
            .map(|(a, b)| ShapePair::new(ShapeMetric::default(), [&a.shape, &b.shape]).distance().combined)
            .collect();
        let spread = DistanceSpread::new(distances);
        let [least, low, median, high, largest] = [0.0, 0.05, 0.5, 0.95, 1.0].map(|q| spread.quantile(q));
        writeln!(
            out,
            "{name:<22} {:>6} {least:>6.2} {low:>7.2} {median:>7.2} {high:>7.2} {largest:>8.2}",
            spread.distances.len()
        )?;
        spreads.push(spread);
    }
    let [poses, bodies, families] = &spreads[..] else { return Ok(()) };
    writeln!(out, "\n{:<22}     at  steepness   in use: at  steepness", "boundaries")?;
    let in_use = [("same shape", ShapeMetric::SAME_SHAPE), ("same class", ShapeMetric::SAME_CLASS)];
    for (found, (name, used)) in boundaries([poses, bodies, families]).into_iter().zip(in_use) {
        let Boundary { at, steepness } = found;
        writeln!(out, "{name:<22} {at:>6.3} {steepness:>10.2} {:>12.3} {:>10.2}", used.at, used.steepness)?;
    }
    Ok(())
}
