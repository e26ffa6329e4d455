//! Generated datasets of labeled shapes.
//!
//! `ArticulatedOptions` -> **datasets** -> `LabeledShape` (`mesh::TriMesh`, name, class) -> `experiments`
//!
//! [`articulated()`] generates thirty closed surfaces of three families, cats, centaurs and men, in different
//! poses. They need no download, unlike scanned datasets. A shape is made in steps, one module each:
//!
//! ```text
//! model, bodies/*.toml    a body (implicit), a skeleton, typical poses
//!   -> extract            the rest surface, on a randomly placed lattice
//!   -> simplify, relax    the wanted number of vertices, well-shaped triangles
//!   -> pose, clearance    the surface bent along the skeleton, without intersecting limbs
//!   -> shape              vertices and faces in random order
//! ```
//!
//! [`creatures`] generates any number of further families from a seed, some with handles.
//!
//! [`mechanical_parts`] makes screws, brackets and other parts as CAD programs export them.
//!
//! [`Damage`] changes meshes, generated or not, in ways that leave the shape recognizable.
//!
//! **Invariant.** The same options give the same bytes on any machine and any number of threads: every shape
//! has its own random streams, and all arithmetic consists of operations that IEEE 754 defines exactly.
//! Nothing here depends on distances, embeddings or the algorithms that will use the shapes.

mod articulated;
mod cases;
mod clearance;
mod corner_table;
mod creature;
mod damage;
mod error;
mod extract;
mod implicit;
mod model;
mod parts;
mod pose;
mod relax;
mod scan;
mod shape;
mod simplify;
mod skeleton;
mod stream;
mod trig;

pub use articulated::{
    ArticulatedOptions, Family, LabeledShape, RestedShape, articulated, articulated_at_rest,
    articulated_body, articulated_shape,
};
pub use creature::{CreatureOptions, creature_body, creature_family, creature_plans, creatures};
pub use damage::{Damage, WeldPair};
pub use error::DatasetError;
pub use parts::{Diagonals, MechanicalPart, PartFamily, PartMesh, mechanical_parts};
pub use scan::{ScannedPoint, scan};
