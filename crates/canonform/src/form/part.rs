//! A part of a surface, to be compared with whole shapes.

use base::Observer;
use descriptors::PartDiscAreas;
use geodesics::{DistanceSolver, Method, Source};

use super::embed::embed;
use super::options::DescribeOptions;
use crate::error::Error;
use mesh::Surface;

/// What is known of the discs of a whole shape, of which the surface is a part that ends at its boundaries. Those of small
/// holes do not count.
///
/// ```
/// use canonform::descriptors::DiscAreas;
/// use canonform::{DescribeOptions, Surface, describe};
/// use canonform::embed::describe_part;
/// use canonform::mesh::shapes;
///
/// let options = DescribeOptions::default();
/// let (ball, mut half) = (shapes::icosphere(4), shapes::icosphere(4));
/// half.faces.retain(|face| face.iter().all(|v| half.positions[v.index()].z >= 0.0));
/// let ring = shapes::torus(48, 24, 2.0, 0.7);
///
/// let part = describe_part(&Surface::new(&half, &Default::default(), &())?, &options, &())?;
/// let distance = |mesh| {
///     let whole = describe(&Surface::new(mesh, &Default::default(), &())?, &options, &())?;
///     let areas = DiscAreas::from_numbers(&whole.disc_areas).expect("numbers of all landmarks");
///     Ok::<_, canonform::Error>(part.distance(&areas))
/// };
/// let (of_ball, of_ring) = (distance(&ball)?, distance(&ring)?);
/// assert!(of_ball.distance < of_ring.distance && of_ball.share == 0.5, "{of_ball:?}, {of_ring:?}");
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::Refused`], [`Error::Exceeded`] and those of measuring distances.
pub fn describe_part(
    surface: &Surface,
    options: &DescribeOptions,
    observer: &dyn Observer,
) -> Result<PartDiscAreas, Error> {
    options.validate()?;
    let part = surface.for_part(observer)?;
    let embedded = embed(&part, &options.form, observer)?;
    let masses = part.mesh().vertex_areas();
    let (_, length) = part.boundary_vertices();
    let solver = Method::default().prepare(part.intrinsic(), observer)?;
    let from_cut = from_cut(&part, solver.as_ref())?.unwrap_or_else(|| vec![f64::INFINITY; masses.len()]);
    Ok(PartDiscAreas::new(&embedded.distances, &masses, &from_cut, length)?)
}

/// The distance of each vertex from the boundary; `None` without one.
pub(crate) fn from_cut(surface: &Surface, solver: &dyn DistanceSolver) -> Result<Option<Vec<f64>>, Error> {
    let (cut, _) = surface.boundary_vertices();
    if cut.is_empty() {
        return Ok(None);
    }
    let sources: Vec<Source> = cut.into_iter().map(Source::vertex).collect();
    let mut from_cut = vec![f64::INFINITY; solver.n_vertices()];
    solver.solve_into(&sources, f64::INFINITY, &mut from_cut)?;
    Ok(Some(from_cut))
}
