//! Laws that hold across crates, and expected results on real meshes. One binary, so that everything is linked once.
//!
//! | module | subject |
//! |---|---|
//! | `architecture` | which crate may depend on which |
//! | `correspondence` | dense maps between surfaces |
//! | `cycles` | imports between the modules of a crate |
//! | `one_of_each` | unique names |
//! | `packaging` | whether all packages can be published |
//! | `licences` | licences of dependencies |
//! | `guarantees` | the tests behind `docs/robustness.md` |
//! | `pages` | length of pages, links between them, and the table of contents of the book |
//! | `marching` | distances by fast marching |
//! | `embedding` | embeddings through the whole pipeline |
//! | `invariance` | signatures of subdivided, simplified, remeshed, noisy and moved shapes |
//! | `fields` | distance fields against exact distances |
//! | `matches` | how a changed mesh is related to the original |
//! | `keepers` | which of several copies is kept |
//! | `nearest` | what a search finds |
//! | `probabilities` | what an index states of the hits of a search |
//! | `map_uses` | known pairs, points inside faces, and what maps carry |
//! | `part_maps` | dense maps between a part and a whole |
//! | `samples` | how many samples are enough, and the interval of the stress after that choice |
//! | `scale` | the same results in any unit of length |
//! | `threads` | independence of the number of threads |
//! | `shortcuts` | welds that are found and cut |
//! | `builtin` | the built-in dataset |

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
