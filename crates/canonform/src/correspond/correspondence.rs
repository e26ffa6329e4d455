//! The maps between two surfaces.

use std::borrow::Borrow;
use std::collections::BTreeSet;
use std::time::Instant;

use linalg::Matrix;
use maps::{KnownMap, MapError, MapKind, PartOfWhole, SurfaceMap, map_surfaces};
use serde::Serialize;
use surface::VertexId;

use super::known;
use super::mapped_surface::MappedSurface;
use super::options::CorrespondOptions;
use super::point_map::Mapping;
use crate::error::Error;
use base::Observer;
use mesh::Surface;

/// A map from the vertices of one surface to those of another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VertexMap {
    /// Whether it keeps the orientation, as a motion does, or reverses it, as a mirror does.
    pub kind: MapKind,
    /// The mean change of distances, as a share of the square root of the area.
    pub distortion: f64,
    /// How far it keeps the orientation, from -1 to 1; `None` if a surface cannot be oriented.
    pub agreement: Option<f64>,
    /// How likely this map is the right one of its kind: below [`SurfaceMap::CERTAIN`] it is a mixture, or another one is nearly as
    /// good, such as one that turns people back to front.
    pub confidence: f64,
    /// The next best map of this kind, if this one is uncertain.
    pub alternative: Option<Box<VertexMap>>,
    /// Which surface is a part of the other, and how much of the whole it covers; `None` if both are mapped as wholes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part: Option<PartOfWhole>,
    /// For every vertex of the first input, its partner among the vertices of the second input; `None` for a vertex that the
    /// repair dropped, and for one of a whole that is missing in the part.
    #[serde(skip)]
    pub vertices: Vec<Option<VertexId>>,
    /// For every vertex of the first input, how well the map keeps distances around it, from 0 to 1; 0 for a vertex that the
    /// repair dropped. See [`SurfaceMap::vertex_confidence`].
    #[serde(skip)]
    pub vertex_confidence: Vec<f64>,
    /// The map of functions of the second surface to functions of the first: its columns are the coefficients of the
    /// eigenfunctions of the second, pulled back, in those of the first. [`MapShape::spectrum`](maps::MapShape::spectrum)
    /// has them. That of a part has fewer eigenfunctions of the part, and functions of the part are zero elsewhere.
    #[serde(skip)]
    pub functional: Matrix,
    /// The landmarks that it was given and contains.
    #[serde(skip)]
    pub landmarks: Vec<[VertexId; 2]>,
}

/// The maps from one surface to another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correspondence {
    /// At most two, of different kinds: the direct one first, unless it distorts distances clearly more.
    pub maps: Vec<VertexMap>,
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
/// [`Error::Point`] and [`Error::UnusableMap`], if what is known of the map does not fit the meshes;
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
/// As [`correspond`]; [`Error::UnusableMap`], if fewer than four vertices have a partner.
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
        true => Err(Error::UnusableMap(
            "too few vertices have a partner; give a map of at least four vertices to score it".into(),
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
    let maps = found.into_iter().map(|map| VertexMap::new(map, surfaces, &landmarks));
    Ok(Correspondence { maps: maps.collect(), seconds: start.elapsed().as_secs_f64() })
}

impl VertexMap {
    /// A map of the vertices of the repaired meshes as one of the inputs.
    fn new(map: SurfaceMap, [from, to]: [&Surface; 2], landmarks: &[[VertexId; 2]]) -> Self {
        let in_input = |partners: &[Option<VertexId>], from: &Surface, to: &Surface| {
            let partners: Vec<_> = partners.iter().map(|v| v.map(|v| to.input_vertex(v))).collect();
            from.in_input_order(&partners, None)
        };
        let part = map.part.map(|part| {
            let [of_first, of_second] = &part.partners;
            PartOfWhole { partners: [in_input(of_first, from, to), in_input(of_second, to, from)], ..part }
        });
        let vertices = match &part {
            Some(part) => part.partners[0].clone(),
            None => in_input(&map.vertices.iter().copied().map(Some).collect::<Vec<_>>(), from, to),
        };
        Self {
            kind: map.kind,
            distortion: map.distortion,
            agreement: map.agreement,
            confidence: map.confidence,
            alternative: map.alternative.map(|other| Box::new(Self::new(*other, [from, to], landmarks))),
            part,
            vertices,
            vertex_confidence: from.in_input_order(&map.vertex_confidence, 0.0),
            functional: map.functional,
            landmarks: landmarks.to_vec(),
        }
    }

    /// The map between the surfaces that it was found for, which takes points into faces and carries functions.
    pub fn between<'a, S>(&'a self, shapes: [&'a MappedSurface<S>; 2]) -> Mapping<'a, S> {
        let partners = self.part.as_ref().map(|part| &part.partners);
        Mapping { shapes, functional: &self.functional, landmarks: &self.landmarks, partners }
    }

    /// Whether no other map of its kind is nearly as good.
    pub fn is_certain(&self) -> bool {
        self.confidence >= SurfaceMap::CERTAIN
    }
}
