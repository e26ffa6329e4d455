//! Maps between a part of a surface, which a cut has left, and the whole.
//!
//! ```text
//! part, whole -> Sides -> placements of a few landmarks -> places of all samples -> one for each orientation -> SurfaceMap
//! ```
//!
//! Eigenfunctions and the canonical form of a part are not those of the whole. Its distances are, as far as the cut does not
//! change them, and so is curvature.

mod landmarks;
mod places;
mod search;
mod sides;
mod vertices;

pub(super) use search::part_maps;
