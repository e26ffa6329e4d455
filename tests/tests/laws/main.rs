//! Laws that hold across crates, and expected results on real meshes. One binary, so that everything is linked once.
//!
//! | module | subject |
//! |---|---|
//! | `architecture` | which crate may depend on which |
//! | `correspondence` | dense maps between surfaces |
//! | `cycles` | imports between the modules of a crate |
//! | `one_of_each` | unique names, no doubled functions, the packages of the project |
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
//! | `part_maps` | dense maps between a part and a whole |
//! | `samples` | how many samples are enough, and the interval of the stress after that choice |
//! | `isometry` | invariance to folding, motions, renumbering and units |
//! | `scale` | the same results in any unit of length |
//! | `threads` | independence of the number of threads |
//! | `signatures` | signatures of bodies |
//! | `shortcuts` | welds that are found and cut |
//! | `builtin` | the built-in dataset |
//! | `real_meshes` | scans and TOSCA; skipped without the meshes |

#[cfg(test)]
mod architecture;
#[cfg(test)]
mod builtin;
#[cfg(test)]
mod correspondence;
#[cfg(test)]
mod cycles;
#[cfg(test)]
mod embedding;
#[cfg(test)]
mod fields;
#[cfg(test)]
mod guarantees;
#[cfg(test)]
mod invariance;
#[cfg(test)]
mod invariants;
#[cfg(test)]
mod isometry;
#[cfg(test)]
mod keepers;
#[cfg(test)]
mod licences;
#[cfg(test)]
mod map_uses;
#[cfg(test)]
mod marching;
#[cfg(test)]
mod matches;
mod memory;
#[cfg(test)]
mod nearest;
#[cfg(test)]
mod one_of_each;
#[cfg(test)]
mod packaging;
#[cfg(test)]
mod pages;
#[cfg(test)]
mod part_maps;
#[cfg(test)]
mod real_meshes;
#[cfg(test)]
mod samples;
#[cfg(test)]
mod scale;
#[cfg(test)]
mod shortcuts;
#[cfg(test)]
mod signatures;
#[cfg(test)]
mod support;
#[cfg(test)]
mod threads;
