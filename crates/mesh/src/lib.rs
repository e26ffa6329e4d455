//! Triangle meshes: validation, repair, analytic shapes.
//!
//! file -> `mesh-io` -> [`TriMesh`] -> [`repair()`] -> `surface::IntrinsicMesh` -> `geodesics`
//!
//! * [`validate`] reports the properties and defects of a mesh.
//! * [`repair()`] removes defects that algorithms cannot handle, as [`RepairOptions`] say, and reports every change.
//! * [`cut_shortcuts`] separates surfaces that touch and were welded.
//! * [`denoise`] smooths noisy meshes, [`fill_holes`] closes small holes, [`refine()`] splits long edges,
//!   [`collapse_edges`] merges vertices.
//! * [`triangulate_points`] makes a surface of a point cloud; [`repair()`] does so for a mesh without faces.
//! * [`shapes`] has small analytic surfaces for tests, benches and documentation.
//!
//! **Invariant.** Vertices keep the order of the file: repair drops and merges vertices but never reorders
//! them, and tells where each input vertex went.
//!
//! The crate knows nothing of distances, embeddings or matrices.
//!
//! ```
//! use canonform_mesh::{RepairOptions, repair, shapes};
//!
//! let cubes = shapes::disjoint(&[shapes::cube(2), shapes::cube(0)]);
//! let repaired = repair(&cubes, &RepairOptions::default(), &())?;
//! let summary = repaired.report.summary();
//! assert_eq!(summary.len(), 1);
//! assert!(summary[0].starts_with("1 of 2 components dropped, 12 faces and 8 vertices"));
//! assert_eq!(repaired.intrinsic.n_vertices(), 98);
//! # Ok::<(), canonform_mesh::MeshError>(())
//! ```

mod boundary;
mod box_tree;
mod coincidence;
mod collapse;
mod error;
mod face_set;
mod holes;
mod input;
mod noise;
mod orientation;
mod outward;
mod points;
mod refine;
mod regions;
mod remap;
mod repair;
pub mod shapes;
mod shortcuts;
mod tri_mesh;
mod validate;

pub use collapse::collapse_edges;
pub use error::{Fault, MIN_POINTS, MeshError, Place};
pub use face_set::{check_finite, check_input};
pub use holes::fill_holes;
pub use input::{InputMap, InputPoint, ParsePointError, PointError, Surface};
pub use noise::{denoise, is_noisy};
pub use orientation::orient_consistently;
pub use outward::{oriented_faces, outward};
pub use points::{PointsReport, TriangulatedPoints, triangulate_points};
pub use refine::refine;
pub use regions::{RegionShape, SmoothRegion, SmoothRegions, circle_through};
pub use remap::{Remap, Remapped};
pub use repair::{
    ComponentPolicy, FacePart, Orient, RepairOptions, RepairReport, Repaired, Weld, coordinate_spacing,
    repair,
};
pub use shortcuts::{CutSurface, Shortcut, ShortcutKind, cut_shortcuts};
pub use tri_mesh::TriMesh;
pub use validate::{MeshReport, validate};
