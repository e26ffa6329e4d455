//! Further points in an embedding: points of the same surface, and finer meshes of it.

use std::time::Instant;

use geodesics::{DistanceSolver, Observed, SurfacePoint};
use linalg::{LandmarkDistances, Matrix};
use nmds::{Embedding, NystromOptions, OutOfSample, Regularization, nystrom_extended};
use surface::VertexId;

use super::embed::{Embedded, Origin};
use super::method::EmbedMethod;
use super::plan::check_memory;
use super::report::EmbedReport;
use super::stress::{Known, Rows, StressChoice, StressOptions};
use crate::error::Error;
use base::Observer;
use mesh::{InputPoint, Surface};

impl Embedded {
    /// Refuses a surface that the embedding is not of.
    ///
    /// # Errors
    /// [`Error::OtherSurface`].
    pub(super) fn check_surface(&self, surface: &Surface) -> Result<(), Error> {
        let (n_vertices, n_points) = (surface.mesh().n_vertices(), self.embedding.n_points());
        if n_vertices == n_points { Ok(()) } else { Err(Error::OtherSurface { n_vertices, n_points }) }
    }

    /// The map that places further points by their distances to the samples.
    ///
    /// # Errors
    /// [`Error::NoExtension`] unless the method is NMDS.
    pub fn extension(&self) -> Result<OutOfSample, Error> {
        if let Some(extension) = &self.extension {
            return Ok(extension.clone());
        }
        let EmbedMethod::Nystrom { mut regularization } = self.options.method else {
            return Err(Error::NoExtension { method: self.options.method.name() });
        };
        if let Regularization::LowRank { rank } = &mut regularization {
            *rank = Some(self.embedding.rank);
        }
        let options = NystromOptions { regularization, dim: self.embedding.dim() };
        Ok(nystrom_extended(&self.distances, &options)?.1)
    }

    /// Places points of the surface in the embedding: coordinates, one row for each point, in mesh units. `surface` is the one that
    /// was embedded. Measures no distances.
    ///
    /// Coordinates are linear in the squared distances to the samples ([`OutOfSample`]). In a flat triangle, with weights `w_i` at
    /// its corners and sides `l_ij`, the squared distance from any point of its plane is
    /// `r = sum w_i r_i - sum w_i w_j l_ij^2`, the second sum over its sides. So a point is placed at the weighted mean of its
    /// corners, moved in a direction that is the same for all points. This is exact where all shortest paths from a sample to the
    /// face unfold into one plane, and else off by a share of the size of the face.
    ///
    /// ```
    /// use canonform::{FormOptions, Surface, embed, mesh::shapes};
    ///
    /// let surface = Surface::new(&shapes::fold(&shapes::grid(9, 7, 0.5), 0.8, 2.0), &Default::default(), &())?;
    /// let form = embed(&surface, &FormOptions::default(), &())?;
    /// let places = form.place(&surface, &["17".parse()?, "f8@2:1:1".parse()?, "0-1@0.3".parse()?])?;
    /// assert_eq!(places.shape(), (3, 3));
    /// assert!((places.row(0) - form.embedding.coords.row(17)).norm() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NoExtension`], [`Error::OtherSurface`], [`Error::Point`].
    pub fn place(&self, surface: &Surface, points: &[InputPoint]) -> Result<Matrix, Error> {
        self.check_surface(surface)?;
        let located = points.iter().map(|point| surface.locate(point)).collect::<Result<Vec<_>, _>>()?;
        let OutOfSample { unit, axes, .. } = self.extension()?;
        let shift = axes.row_sum() / (unit * unit);
        let coords = &self.embedding.coords;
        let mut placed = Matrix::zeros(points.len(), coords.ncols());
        for (mut row, point) in placed.row_iter_mut().zip(located) {
            let corners = corners(surface, point);
            for &(vertex, weight) in &corners {
                row += coords.row(vertex.index()) * weight;
            }
            row -= &shift * moment(surface, point, &corners);
        }
        Ok(placed)
    }
}

/// The vertices of the face or edge of a point, each with its weight.
fn corners(surface: &Surface, point: SurfacePoint) -> Vec<(VertexId, f64)> {
    let topology = surface.intrinsic().topology();
    match point {
        SurfacePoint::Vertex(vertex) => vec![(vertex, 1.0)],
        SurfacePoint::Edge { edge, t } => {
            topology.edges()[edge.index()].into_iter().zip([1.0 - t, t]).collect()
        }
        SurfacePoint::Face { face, barycentric } => {
            topology.faces()[face.index()].into_iter().zip(barycentric).collect()
        }
    }
}

/// `sum w_i w_j l_ij^2` over the sides of the face, or the edge, of a point.
fn moment(surface: &Surface, point: SurfacePoint, corners: &[(VertexId, f64)]) -> f64 {
    let intrinsic = surface.intrinsic();
    let side = |[(a, v), (b, w)]: [(VertexId, f64); 2]| {
        let edge = intrinsic.topology().edge_between(a, b);
        v * w * edge.map_or(0.0, |edge| intrinsic.length(edge)).powi(2)
    };
    match (point, corners) {
        (SurfacePoint::Edge { .. }, &[a, b]) => side([a, b]),
        (SurfacePoint::Face { .. }, &[a, b, c]) => [[a, b], [b, c], [c, a]].map(side).iter().sum(),
        _ => 0.0,
    }
}

/// Embeds a finer mesh of a surface in the coordinates of a coarser one: measures distances from the samples of the coarser form
/// and places all vertices by them. Levels of one surface then have forms that lie on top of each other.
///
/// A sample is found on the finer mesh as the vertex nearest to its position, which must not be farther than a mean edge of the
/// coarser mesh: both meshes are in the same place. `stress` is measured on the finer mesh.
///
/// ```
/// use canonform::{FormOptions, StressOptions, Surface, embed, embed_finer, mesh::shapes};
///
/// let [coarse, fine] = [3, 4].map(|level| Surface::new(&shapes::icosphere(level), &Default::default(), &()));
/// let (coarse, fine) = (coarse?, fine?);
/// let form = embed(&coarse, &FormOptions::default(), &())?;
/// let finer = embed_finer(&fine, &coarse, &form, &StressOptions::default(), &())?;
/// assert_eq!(finer.embedding.n_points(), 2562);
/// // The first vertices are those of the coarser sphere.
/// let gap = finer.embedding.coords.rows(0, 642) - &form.embedding.coords;
/// assert!(gap.amax() < 0.02);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::NotThere`] if a sample has no vertex of the finer mesh near it, [`Error::NoExtension`], [`Error::OtherSurface`] if
/// `form` is not of `coarse`, and as [`embed`](crate::embed).
pub fn embed_finer(
    fine: &Surface,
    coarse: &Surface,
    form: &Embedded,
    stress: &StressOptions,
    observer: &dyn Observer,
) -> Result<Embedded, Error> {
    let start = Instant::now();
    form.check_surface(coarse)?;
    let extension = form.extension()?;
    let samples = samples_on(fine, coarse, form)?;
    let (budget, geodesic, p) = (observer.budget(), form.options.geodesic, fine.mesh().n_vertices());
    check_memory(p, samples.len(), &budget)?;
    observer.begin("distances", samples.len());
    let solver = geodesic.prepare(fine.intrinsic(), observer)?;
    let solver = Observed { solver: solver.as_ref(), observer };
    let sources: Vec<VertexId> = samples.iter().copied().map(VertexId::from).collect();
    let columns = solver.distance_columns(&sources)?;
    let distances = LandmarkDistances::new(samples, columns)?;
    let geodesics = start.elapsed().as_secs_f64();

    let coords = extension.place(&distances.to_matrix()?)?;
    let embedding = Embedding { coords, ..form.embedding.clone() };
    let elapsed = start.elapsed().as_secs_f64();
    let known =
        Known { coords: &embedding.coords, samples: &distances, searched: form.report.auto.is_some() };
    let stress = match stress.choice {
        StressChoice::Skip => None,
        _ => Some(known.stress(Rows::Solved(&solver), geodesic, stress, observer)?),
    };
    let origin = Origin::of(fine);
    let seconds = origin.seconds(geodesics, elapsed - geodesics, start.elapsed().as_secs_f64() - elapsed);
    let report = origin.facts(&form.options, &embedding, &distances);
    let report = EmbedReport { stress, seconds, ..report };
    Ok(Embedded { options: form.options.clone(), embedding, distances, report, extension: Some(extension) })
}

/// The vertices of a finer mesh that are nearest to the samples of a form.
fn samples_on(fine: &Surface, coarse: &Surface, form: &Embedded) -> Result<Vec<usize>, Error> {
    let allowed = coarse.intrinsic().mean_edge_length();
    let positions = &fine.mesh().positions;
    let near = |&sample: &usize| {
        let place = coarse.mesh().positions[sample];
        let gaps = positions.iter().map(|position| (position - place).norm()).enumerate();
        match gaps.min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((vertex, gap)) if gap <= allowed => Ok(vertex),
            nearest => Err(Error::NotThere {
                sample: coarse.input_vertex(VertexId::from(sample)),
                gap: nearest.map_or(f64::INFINITY, |(_, gap)| gap),
                allowed,
            }),
        }
    };
    form.distances.landmarks().iter().map(near).collect()
}

#[cfg(test)]
mod tests {
    use geodesics::{Method, Sampling};
    use mesh::shapes;

    use super::*;
    use crate::form::{FormOptions, Samples, embed, embed_again, embed_and_measure};
    use mesh::shapes::lopsided_torus;

    fn surface(mesh: &mesh::TriMesh) -> Surface {
        Surface::new(mesh, &Default::default(), &()).unwrap()
    }

    #[test]
    fn points_of_a_flat_sheet_are_placed_exactly() {
        let sheet = surface(&shapes::grid(12, 9, 0.5));
        let options = FormOptions {
            samples: Samples::Count(20),
            geodesic: Method::Exact,
            dim: 2,
            ..FormOptions::default()
        };
        let form = embed(&sheet, &options, &()).unwrap();
        let points = ["f3@1:2:4", "f40@1:0:1", "0-1@0.3", "17", "f99"].map(|text| text.parse().unwrap());
        let placed = form.place(&sheet, &points).unwrap();
        let coords = &form.embedding.coords;
        for (row, point) in placed.row_iter().zip(&points) {
            let at = sheet.position(sheet.locate(point).unwrap());
            for v in 0..sheet.mesh().n_vertices() {
                let gap = (row - coords.row(v)).norm() - (at - sheet.mesh().positions[v]).norm();
                assert!(gap.abs() < 1e-7, "{point}, {v}: {gap:e}");
            }
        }
    }

    #[test]
    fn points_are_placed_as_by_their_distances() {
        let surface = surface(&lopsided_torus());
        let form = embed(&surface, &FormOptions::default(), &()).unwrap();
        let solver = Method::Exact.prepare(surface.intrinsic(), &()).unwrap();
        let extension = form.extension().unwrap();
        let size = form.embedding.coords.amax();
        for text in ["f100@1:2:4", "f7", "f300@1:1:0"] {
            let point: InputPoint = text.parse().unwrap();
            let source =
                geodesics::Source::new(surface.intrinsic(), surface.locate(&point).unwrap()).unwrap();
            let mut found = vec![0.0; surface.mesh().n_vertices()];
            solver.solve_into(&[source], f64::INFINITY, &mut found).unwrap();
            let samples = form.distances.landmarks();
            let row = Matrix::from_fn(1, samples.len(), |_, j| found[samples[j]]);
            let gap = (extension.place(&row).unwrap() - form.place(&surface, &[point]).unwrap()).norm();
            println!("{text}: {:.4} of the size", gap / size);
            assert!(gap < 0.03 * size, "{text}: {gap} of {size}");
        }
    }

    #[test]
    fn more_samples_are_added_without_measuring_the_first_again() {
        let [surface, other] = [lopsided_torus(), shapes::icosphere(2)].map(|mesh| surface(&mesh));
        let stress = StressOptions::default();
        for sampling in Sampling::ALL {
            let of =
                |n| FormOptions { samples: Samples::Count(n), sampling, seed: 3, ..FormOptions::default() };
            let few = embed_and_measure(&surface, &of(20), &stress, &()).unwrap();
            let all = embed_and_measure(&surface, &of(45), &stress, &()).unwrap();
            let more = embed_again(&surface, &few, &of(45), &stress, &()).unwrap();
            assert_eq!(more.embedding, all.embedding, "{sampling:?}");
            assert_eq!(more.distances, all.distances, "{sampling:?}");
            assert_eq!(more.report.stress, all.report.stress);
        }
        let few = embed(&surface, &FormOptions::default(), &()).unwrap();
        let mut bent = lopsided_torus();
        bent.positions[7] += nalgebra::Vector3::repeat(0.05);
        for other in [other, self::surface(&bent)] {
            let fault = embed_again(&other, &few, &FormOptions::default(), &stress, &()).unwrap_err();
            assert!(matches!(fault, Error::OtherSurface { .. }));
        }
    }

    #[test]
    fn a_finer_mesh_elsewhere_and_other_methods_are_refused() {
        let [coarse, fine] = [2, 3].map(|level| surface(&shapes::icosphere(level)));
        let form = embed(&coarse, &FormOptions::default(), &()).unwrap();
        let mut moved = shapes::icosphere(3);
        moved.positions.iter_mut().for_each(|p| p.x += 1.0);
        let finer = |fine: &Surface, form: &Embedded| {
            embed_finer(fine, &coarse, form, &StressOptions::default(), &())
        };
        assert!(matches!(finer(&surface(&moved), &form), Err(Error::NotThere { .. })));
        let options = FormOptions { method: EmbedMethod::Landmark, ..FormOptions::default() };
        let other = embed(&coarse, &options, &()).unwrap();
        assert!(matches!(finer(&fine, &other), Err(Error::NoExtension { method: "landmark" })));
        let found = finer(&fine, &form).unwrap();
        let placed = found.place(&fine, &["300".parse().unwrap()]).unwrap();
        assert!((placed.row(0) - found.embedding.coords.row(300)).norm() < 1e-12);
        let found = found.report;
        let direct =
            embed_and_measure(&fine, &FormOptions::default(), &StressOptions::default(), &()).unwrap();
        let [found, direct] =
            [found.stress.unwrap(), direct.report.stress.unwrap()].map(|stress| stress.value);
        assert!((found / direct - 1.0).abs() < 0.02, "{found} {direct}");
    }
}
