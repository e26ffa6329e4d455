//! Laws that hold across crates, and what real meshes must come out as.
//!
//! One binary, so that everything is linked once. The modules, from the house to its contents:
//! `architecture` (which crate may know which), `licences` (what may come in), `marching` (distances), `embedding` (coordinates),
//! `isometry` (what must change nothing), `threads` (the same bytes for any number of them),
//! `signatures` (what tells bodies apart), `builtin` (the built-in dataset) and `real_meshes`, which is skipped without the meshes.

#[cfg(test)]
mod architecture;
#[cfg(test)]
mod builtin;
#[cfg(test)]
mod embedding;
#[cfg(test)]
mod isometry;
#[cfg(test)]
mod licences;
#[cfg(test)]
mod marching;
#[cfg(test)]
mod real_meshes;
#[cfg(test)]
mod signatures;
#[cfg(test)]
mod support;
#[cfg(test)]
mod threads;
