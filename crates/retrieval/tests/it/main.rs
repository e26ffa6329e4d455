//! Laws of the crate, through what it exports.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod bootstrap;
mod clustering;
mod evaluation;
mod graph;
mod graph_gain;
mod refinement;
mod scores;
mod vote;

use linalg::DistanceMatrix;

/// The distances between points on a line.
fn line(positions: &[f64]) -> DistanceMatrix {
    DistanceMatrix::from_pairs(positions.len(), |i, j| (positions[i] - positions[j]).abs()).unwrap()
}

/// Points in the plane.
fn scattered(n: usize) -> Vec<[f64; 2]> {
    (0..n).map(|i| i as f64).map(|i| [(i * 0.618).fract() * 9.0, (i * 0.414).fract() * 4.0]).collect()
}
