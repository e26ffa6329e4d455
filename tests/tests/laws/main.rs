//! Laws that hold across crates, and expected results on real meshes. One binary, so that everything is linked once; the first
//! line of each module says what it is about.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod architecture;
mod builtin;
mod correspondence;
mod cycles;
mod embedding;
mod fields;
mod guarantees;
mod invariance;
mod invariants;
mod keepers;
mod licences;
mod map_uses;
mod marching;
mod matches;
mod memory;
mod nearest;
mod one_of_each;
mod packaging;
mod pages;
mod part_maps;
mod probabilities;
mod rested;
mod samples;
mod scale;
mod shortcuts;
mod support;
mod threads;
