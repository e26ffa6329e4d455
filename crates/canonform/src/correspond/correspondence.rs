//! The maps between two surfaces.

use std::borrow::Borrow;
use std::collections::BTreeSet;
use std::time::Instant;

use maps::{KnownMap, MapError, PartOfWhole, SurfaceMap, map_surfaces};
use serde::Serialize;
use surface::VertexId;

use super::known;
use super::mapped_surface::MappedSurface;
use super::options::CorrespondOptions;
use crate::error::Error;
use base::Observer;
use mesh::Surface;

/// The maps from one surface to another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correspondence {
    /// At most two, of different kinds, in the numbers of the inputs: the direct one first, unless it distorts distances clearly more.
    pub maps: Vec<SurfaceMap>,
    /// Seconds that the search took, after both surfaces were prepared.
    pub seconds: f64,
}

/// Maps the vertices of one surface to those of another.
///
/// Shapes that are alike under a mirror have two maps of small distortion, one for each orientation. Both are returned. One
/// surface may be a part of the other that a cut has left. See [`map_surfaces`] for how maps are found; the result does not
/// depend on the number of threads.
///
/// ```
/// use canonform::Surface;
/// use canonform::maps::{CorrespondOptions, MappedSurface, correspond};
/// use canonform::mesh::shapes;
///
/// // A sheet, flat and folded.
/// let flat = shapes::grid(21, 17, 0.1);
/// let folded = shapes::fold(&flat, 0.8, 1.2);
/// let options = CorrespondOptions::default();
/// let a = MappedSurface::new(Surface::new(&flat, &options.form.repair, &())?, &options, &())?;
/// let b = MappedSurface::new(Surface::new(&folded, &options.form.repair, &())?, &options, &())?;
/// let found = correspond(&a, &b, &options, &())?;
/// assert_eq!(found.maps.len(), 2, "directly and mirrored");
/// assert_eq!(found.maps[0].vertices.len(), 21 * 17);
/// assert!(found.maps[0].distortion < 0.02);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::Point`] and [`Error::Refused`], if what is known of the map does not fit the meshes;
/// [`Error::ContradictoryLandmarks`]; [`Error::Descriptor`] and [`Error::Exceeded`].
pub fn correspond<S: Borrow<Surface>>(
    a: &MappedSurface<S>,
    b: &MappedSurface<S>,
    options: &CorrespondOptions,
    observer: &dyn Observer,
) -> Result<Correspondence, Error> {
    found(a, b, options, &|known| map_surfaces(&a.shape, &b.shape, known, &options.maps, observer))
}

/// What the [initial](maps::KnownMap::initial) map is worth, without its refinement: the one map of the result has its vertices.
/// See [`maps::score_map`].
///
/// # Errors
/// As [`correspond`]; [`Error::Refused`], if fewer than four vertices have a partner.
pub fn score_map<S: Borrow<Surface>>(
    a: &MappedSurface<S>,
    b: &MappedSurface<S>,
    options: &CorrespondOptions,
    observer: &dyn Observer,
) -> Result<Correspondence, Error> {
    let found = found(a, b, options, &|known| {
        Ok(maps::score_map(&a.shape, &b.shape, known, &options.maps, observer)?.into_iter().collect())
    })?;
    match found.maps.is_empty() {
        true => Err(Error::refused(
            "too few vertices have a partner; give a map of at least four vertices to score it",
        )),
        false => Ok(found),
    }
}

fn found<S: Borrow<Surface>>(
    a: &MappedSurface<S>,
    b: &MappedSurface<S>,
    options: &CorrespondOptions,
    maps_of: &dyn Fn(&KnownMap) -> Result<Vec<SurfaceMap>, MapError>,
) -> Result<Correspondence, Error> {
    let start = Instant::now();
    let surfaces = [a.surface(), b.surface()];
    // Sorted, so that their order does not matter.
    let landmarks: BTreeSet<[VertexId; 2]> = options.known.landmarks.iter().copied().collect();
    let landmarks: Vec<_> = landmarks.into_iter().collect();
    let known = known::repaired(&options.known, &landmarks, surfaces)?;
    let found = maps_of(&known).map_err(|fault| known::named(fault, &landmarks))?;
    let maps = found.into_iter().map(|map| in_inputs(map, surfaces, &landmarks));
    Ok(Correspondence { maps: maps.collect(), seconds: start.elapsed().as_secs_f64() })
}

/// A map of the vertices of the repaired meshes as one of the inputs: a vertex that the repair dropped has no partner and no
/// confidence, and one of a whole that is missing in the part has no partner.
fn in_inputs(map: SurfaceMap, [from, to]: [&Surface; 2], landmarks: &[[VertexId; 2]]) -> SurfaceMap {
    let in_input = |partners: &[Option<VertexId>], from: &Surface, to: &Surface| {
        let partners: Vec<_> = partners.iter().map(|v| v.map(|v| to.input_vertex(v))).collect();
        from.in_input_order(&partners, None)
    };
    let part = map.part.map(|part| {
        let [of_first, of_second] = &part.partners;
        PartOfWhole { partners: [in_input(of_first, from, to), in_input(of_second, to, from)], ..part }
    });
    SurfaceMap {
        vertices: match &part {
            Some(part) => part.partners[0].clone(),
            None => in_input(&map.vertices, from, to),
        },
        vertex_confidence: from.in_input_order(&map.vertex_confidence, 0.0),
        alternative: map.alternative.map(|other| Box::new(in_inputs(*other, [from, to], landmarks))),
        part,
        landmarks: landmarks.to_vec(),
        ..map
    }
}
