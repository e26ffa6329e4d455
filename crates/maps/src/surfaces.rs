//! The best maps of two surfaces.

use base::Observer;
use descriptors::Side;

use crate::error::MapError;
use crate::known::KnownMap;
use crate::params::MapParams;
use crate::part::part_maps;
use crate::refine::{best_of_each_kind, scored_as_given};
use crate::search::MapSearch;
use crate::shape::MapShape;
use crate::surface_map::SurfaceMap;

/// A surface with a boundary may be a part if its area is such a share of that of the other surface, both in the same unit. A
/// larger one is mapped as a whole, and of a smaller one too little is known. Safety limits.
const SHARES: [f64; 2] = [0.25, 0.92];

/// The best maps of the first surface to the second, one for each orientation: the direct one first, unless it distorts
/// distances clearly more.
///
/// 1. Maps of functions are fitted in closed form to the curvature and the wave kernels of both surfaces, once for each
///    orientation (`ren2018` in `REFERENCES.bib`). Each alignment of the forms maps samples to the nearest ones, too.
/// 2. All these maps are refined with few samples, by taking in eigenfunctions of higher frequency, there and back (ZoomOut,
///    `melzi2019`). Each of the best different ones is turned: another one takes the ends of limbs to the same places, with the
///    other orientation. Of people, it exchanges front and back.
/// 3. The best different ones are refined with more samples.
/// 4. Each map is followed by the mirrors of the surfaces, which exchange left and right, or front and back. A map and one that
///    differs by a mirror are scored together.
/// 5. Of each orientation, those that keep distances, the products of functions and the orientation best are refined on all
///    samples and eigenfunctions. The one that keeps fine curvature best, too, is taken, and all vertices follow. How much worse
///    the next best is says how certain it is.
///
/// Shapes that are alike under a mirror have two maps of small distortion; for others, one of the two has a large
/// distortion. If a surface cannot be oriented, there is one map.
///
/// What is `known` of the map enters all of it: landmarks, as heat that is placed at them, and functions are fitted, too; how far
/// maps miss the landmarks is part of their score, and the last fit is to them as well; and an initial map is one more start, which
/// comes out unless another map is clearly better.
///
/// If one surface has a boundary and is clearly smaller, it may be a part of the other that a cut has left, if both have the
/// same unit of length. Then maps of a part are sought, too, and those that change distances less are returned.
/// [`SurfaceMap::part`] tells which. With known functions, both are mapped as wholes. A part:
///
/// 1. Twelve landmarks of the part go one after the other to all landmarks of the whole. What keeps distances and curvature
///    is kept.
/// 2. All other samples go where their distances from these fit best, and then all again by their distances from all
///    landmarks. Of distances that a path through what is missing may shorten, only bounds are known.
/// 3. Of each orientation, the map that keeps distances and curvature best is taken.
///
/// # Errors
/// [`MapError::Contradiction`] for landmarks that cannot all be right; [`MapError::Descriptor`], also if the budget of the observer
/// is exceeded.
pub fn map_surfaces(
    a: &MapShape,
    b: &MapShape,
    known: &KnownMap,
    params: &MapParams,
    observer: &dyn Observer,
) -> Result<Vec<SurfaceMap>, MapError> {
    let side = possible_part(a, b);
    known.check([a, b], side)?;
    let budget = observer.budget();
    let search = MapSearch { shapes: [a, b], known, params, budget: &budget };
    let best = best_of_each_kind(&search, search.sketches()?)?;
    let mut maps: Vec<SurfaceMap> =
        best.iter().map(|best| best.on_all_vertices([a, b])).collect::<Result<_, _>>()?;
    if let Some(side) = side.filter(|_| known.functions.is_none()) {
        let of_part = part_maps(&search, side)?;
        let least = |maps: &[SurfaceMap]| maps.iter().map(|map| map.distortion).fold(f64::INFINITY, f64::min);
        if least(&of_part) < least(&maps) {
            maps = of_part;
        }
    }
    Ok(known.finished(maps, b, params)?)
}

/// A map that is given, the `initial` one of `known`, without its refinement: how much it changes distances, how far it keeps the
/// orientation, and how likely it is right, and not the best map of its kind that [`map_surfaces`] finds, or of another one if there
/// is none. That one is its [alternative](SurfaceMap::alternative), unless both are the same or there is no doubt. Vertices that are given no partner get one.
/// `None` if fewer than four vertices have one.
///
/// # Errors
/// As [`map_surfaces`].
pub fn score_map(
    a: &MapShape,
    b: &MapShape,
    known: &KnownMap,
    params: &MapParams,
    observer: &dyn Observer,
) -> Result<Option<SurfaceMap>, MapError> {
    known.check([a, b], None)?;
    let budget = observer.budget();
    let others = KnownMap { initial: Vec::new(), ..known.clone() };
    scored_as_given(&MapSearch { shapes: [a, b], known: &others, params, budget: &budget }, known)
}

/// The surface that may be a part of the other; `None` if neither has a boundary and is much smaller.
fn possible_part(a: &MapShape, b: &MapShape) -> Option<Side> {
    let share = (a.size / b.size).powi(2);
    let is_part =
        |shape: &MapShape, share: f64| shape.from_cut.is_some() && share > SHARES[0] && share < SHARES[1];
    match () {
        () if is_part(a, share) => Some(Side::First),
        () if is_part(b, 1.0 / share) => Some(Side::Second),
        () => None,
    }
}
