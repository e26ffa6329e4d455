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

use base::Budget;
use serde::Serialize;

use super::search::SurfaceMap;
use super::shape::MapShape;
use crate::relation::Side;
use descriptors::DescriptorError;

/// A surface with a boundary may be a part if its area is such a share of that of the other surface, both in the same unit. A
/// larger one is mapped as a whole, and of a smaller one too little is known (`experiments run partial`).
const SHARES: [f64; 2] = [0.25, 0.92];

/// Which surface is a part of the other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartOfWhole {
    /// The surface that is a part.
    pub part: Side,
    /// The share of the area of the whole that has partners.
    pub covered: f64,
    /// Whether each vertex of the first surface has a partner. If that is the part, all have.
    #[serde(skip)]
    pub matched: Vec<bool>,
}

/// The surface that may be a part of the other; `None` if neither has a boundary and is much smaller.
fn possible_part(a: &MapShape, b: &MapShape) -> Option<Side> {
    let share = (a.size / b.size).powi(2);
    let is_part = |shape: &MapShape, share: f64| {
        shape.from_cut.is_some() && share > SHARES[0] && share < SHARES[1]
    };
    match () {
        () if is_part(a, share) => Some(Side::First),
        () if is_part(b, 1.0 / share) => Some(Side::Second),
        () => None,
    }
}

/// The maps of a part and a whole if one surface may be a part of the other and they change distances less than maps of whole
/// surfaces do; else these.
pub(super) fn or_of_part(
    maps: Vec<SurfaceMap>,
    a: &MapShape,
    b: &MapShape,
    budget: &Budget,
) -> Result<Vec<SurfaceMap>, DescriptorError> {
    let Some(side) = possible_part(a, b) else { return Ok(maps) };
    let [part, whole] = if side == Side::First { [a, b] } else { [b, a] };
    let of_part = search::part_maps(part, whole, side, budget)?;
    let least = |maps: &[SurfaceMap]| maps.iter().map(|map| map.distortion).fold(f64::INFINITY, f64::min);
    Ok(if least(&of_part) < least(&maps) { of_part } else { maps })
}
