//! Maps between several surfaces that agree with each other.

use std::borrow::Borrow;
use std::time::Instant;

use base::Observer;
use mesh::Surface;
use relations::{ConsistentMaps, CycleReport, SurfaceMap, all_pairs, consistent_maps, map_wholes};
use serde::Serialize;

use super::correspondence::VertexMap;
use super::known;
use super::mapped_surface::MappedSurface;
use super::options::CorrespondOptions;
use crate::error::Error;

/// The map of a pair of several surfaces.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairMap {
    /// The number of the first surface.
    pub a: usize,
    /// The number of the second surface.
    pub b: usize,
    /// The map from the first to the second.
    #[serde(flatten)]
    pub map: VertexMap,
    /// Whether the map that was found for these two alone agrees with those of the others. If not, it was replaced.
    pub agreed: bool,
}

/// The maps between several surfaces.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CollectionMaps {
    /// A map for every pair, the lower number first.
    pub pairs: Vec<PairMap>,
    /// How well the maps close to cycles.
    pub cycles: CycleReport,
    /// Seconds that the search took, after all surfaces were prepared.
    pub seconds: f64,
}

/// Maps several surfaces to each other, so that the maps agree: from one surface to a second and on to a third is the same as at once.
///
/// All pairs are mapped as by [`correspond`](super::correspond), but always as wholes. Maps that disagree with the others, such as one that turns a man
/// back to front, are replaced; then all of them are made consistent, see [`consistent_maps`]. Two surfaces have no cycle, and keep
/// their first map.
///
/// # Errors
/// [`Error::UnusableMap`] if something is known of the map, which only two surfaces can have, or if a pair has no map;
/// [`Error::Descriptor`] and [`Error::Exceeded`].
pub fn correspond_all<S: Borrow<Surface>>(
    surfaces: &[&MappedSurface<S>],
    options: &CorrespondOptions,
    observer: &dyn Observer,
) -> Result<CollectionMaps, Error> {
    if !options.known.is_empty() {
        return Err(Error::UnusableMap(
            "landmarks, an initial map and functions belong to two surfaces; leave them out, or map one pair at a time".into(),
        ));
    }
    let start = Instant::now();
    let shapes: Vec<_> = surfaces.iter().map(|surface| &surface.shape).collect();
    let pairs = all_pairs(shapes.len());
    observer.begin("maps", pairs.len());
    let mut found = Vec::with_capacity(pairs.len());
    for &[i, j] in &pairs {
        let maps = map_wholes(shapes[i], shapes[j], &options.known, options.eigenfunctions, observer)
            .map_err(|fault| known::named(fault, &options.known.landmarks))?;
        if maps.is_empty() {
            return Err(Error::UnusableMap(format!(
                "there is no map between the surfaces {i} and {j}, counted from 0; leave one of them out"
            )));
        }
        found.push(maps);
        observer.step();
    }
    let ConsistentMaps { maps, agreed, cycles } = match shapes.len() {
        0..3 => alone(found),
        _ => consistent_maps(&shapes, &found, observer)?,
    };
    let pair = |((&[a, b], map), agreed): ((&[usize; 2], SurfaceMap), bool)| {
        let sides = [surfaces[a].surface(), surfaces[b].surface()];
        PairMap { a, b, map: VertexMap::new(map, sides, &[]), agreed }
    };
    let pairs = pairs.iter().zip(maps).zip(agreed).map(pair).collect();
    Ok(CollectionMaps { pairs, cycles, seconds: start.elapsed().as_secs_f64() })
}

/// The first maps, where no others could disagree.
fn alone(found: Vec<Vec<SurfaceMap>>) -> ConsistentMaps {
    let agreed = vec![true; found.len()];
    let maps = found.into_iter().filter_map(|maps| maps.into_iter().next()).collect();
    ConsistentMaps { maps, agreed, cycles: CycleReport { n_cycles: 0, before: 0.0, after: 0.0 } }
}
