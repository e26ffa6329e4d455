//! A surface, prepared to be mapped.

use std::borrow::Borrow;
use std::time::Instant;

use descriptors::LaplaceSpectrum;
use geodesics::SpreadSamples;
use maps::MapShape;

use super::options::CorrespondOptions;
use crate::error::Error;
use crate::form::{embed, from_cut};
use base::Observer;
use mesh::Surface;

/// Vertices of each surface on which maps are refined before all others follow. A convention.
const SPREAD: usize = 1000;

/// A surface with everything that maps to other surfaces are found by.
#[derive(Debug)]
pub struct MappedSurface<S = Surface> {
    /// The repaired mesh.
    pub surface: S,
    /// Its form, spectrum and distances.
    pub shape: MapShape,
    /// Seconds that it took to prepare the surface.
    pub seconds: f64,
}

impl<S: Borrow<Surface>> MappedSurface<S> {
    /// Measures distances from the samples of the form, embeds the surface, and computes its spectrum.
    ///
    /// # Errors
    /// [`Error::Descriptor`] unless the form has three dimensions; those of [`embed`].
    pub fn new(surface: S, options: &CorrespondOptions, observer: &dyn Observer) -> Result<Self, Error> {
        options.form.validate()?;
        let start = Instant::now();
        let repaired = surface.borrow();
        let embedded = embed(repaired, &options.form, observer)?;
        let form = embedded.form(repaired)?;
        let solver = options.form.geodesic.prepare(repaired.intrinsic(), observer)?;
        let spread = SpreadSamples::new(solver.as_ref(), &embedded.distances, SPREAD)?;
        let from_cut = from_cut(repaired, solver.as_ref())?;
        drop(solver);
        let spectrum = LaplaceSpectrum::new(repaired.intrinsic(), options.maps.eigenfunctions, observer)?;
        let SpreadSamples { samples, nearest, .. } = spread;
        let (mesh, distances) = (repaired.mesh(), embedded.distances);
        let shape = MapShape::new(&form, mesh, spectrum, distances, samples, nearest, from_cut)?;
        Ok(Self { shape, seconds: start.elapsed().as_secs_f64(), surface })
    }

    /// The repaired mesh.
    pub fn surface(&self) -> &Surface {
        self.surface.borrow()
    }
}
