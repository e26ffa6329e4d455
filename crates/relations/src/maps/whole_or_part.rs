//! Maps of surfaces that are both whole, or one a part of the other.

use base::Observer;

use super::error::MapError;
use super::known::KnownMap;
use super::part::part_maps;
use super::search::map_wholes;
use super::shape::MapShape;
use super::surface_map::SurfaceMap;
use crate::relation::Side;

/// A surface with a boundary may be a part if its area is such a share of that of the other surface, both in the same unit. A
/// larger one is mapped as a whole, and of a smaller one too little is known. Safety limits.
const SHARES: [f64; 2] = [0.25, 0.92];

/// The best maps of the first surface to the second, one for each orientation: the direct one first, unless it distorts
/// distances clearly more.
///
/// If one surface has a boundary and is clearly smaller, it may be a part of the other that a cut has left, if both have the
/// same unit of length. Then maps of a part are sought, too, and those that change distances less are returned.
/// [`SurfaceMap::part`] tells which. With known functions, both are mapped as wholes.
///
/// [`map_wholes`] says how wholes are mapped, and what is done with what is `known`.
///
/// A part:
/// 1. Twelve landmarks of the part go one after the other to all landmarks of the whole. What keeps distances, curvature and
///    areas of discs is kept.
/// 2. All other samples go where their distances from these fit best, and then all again by their distances from all
///    landmarks. Of distances that a path through what is missing may shorten, only bounds are known.
/// 3. Of each orientation, the map that keeps distances, curvature and the products of functions best is taken.
///
/// # Errors
/// [`MapError::Contradiction`]; [`MapError::Descriptor`], also if the budget of the observer is exceeded.
pub fn map_surfaces(
    a: &MapShape,
    b: &MapShape,
    known: &KnownMap,
    eigenfunctions: usize,
    observer: &dyn Observer,
) -> Result<Vec<SurfaceMap>, MapError> {
    let side = possible_part(a, b);
    known.check([a, b], side)?;
    let of_wholes = map_wholes(a, b, known, eigenfunctions, observer)?;
    let Some(side) = side.filter(|_| known.functions.is_none()) else { return Ok(of_wholes) };
    let [part, whole] = if side == Side::First { [a, b] } else { [b, a] };
    let of_part = part_maps(part, whole, side, known, observer)?;
    let least = |maps: &[SurfaceMap]| maps.iter().map(|map| map.distortion).fold(f64::INFINITY, f64::min);
    Ok(if least(&of_part) < least(&of_wholes) { of_part } else { of_wholes })
}

/// The surface that may be a part of the other; `None` if neither has a boundary and is much smaller.
fn possible_part(a: &MapShape, b: &MapShape) -> Option<Side> {
    let share = (a.size / b.size).powi(2);
    let sides = [(Side::First, a, share), (Side::Second, b, 1.0 / share)];
    let part = sides
        .into_iter()
        .find(|(_, shape, share)| shape.from_cut.is_some() && *share > SHARES[0] && *share < SHARES[1]);
    part.map(|(side, ..)| side)
}
