//! Datasets of labelled shapes, made on the spot.
//!
//! `ArticulatedOptions` -> **datasets** -> `LabeledShape` (`mesh::TriMesh`, name, class) -> `experiments`
//!
//! [`articulated()`] gives thirty closed surfaces of three families, cats, centaurs and men, in different
//! poses: a stand-in for scanned datasets that needs no download. A shape is made in steps, one module
//! each:
//!
//! ```text
//! cat | centaur | david   a body (implicit), a skeleton, typical poses
//!   -> extract            the rest surface, on a lattice placed at random
//!   -> simplify, relax    the wanted number of vertices, well-shaped triangles
//!   -> pose, clearance    bent along the skeleton, lengths kept, limbs clear of each other
//!   -> shape              vertices and faces in random order
//! ```
//!
//! **Invariant.** The same options give the same bytes on any machine and any number of threads: every
//! shape draws from random streams of its own, and all arithmetic is made of operations that IEEE 754
//! fixes. Nothing here knows a distance, an embedding or an algorithm that will see the shapes.

mod articulated;
mod cases;
mod cat;
mod centaur;
mod clearance;
mod corner_table;
mod david;
mod error;
mod extract;
mod human;
mod implicit;
mod model;
mod pose;
mod relax;
mod shape;
mod simplify;
mod skeleton;
mod stream;
mod trig;

pub use articulated::{ArticulatedOptions, Family, LabeledShape, articulated, articulated_shape};
pub use error::DatasetError;
