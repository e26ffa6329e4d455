//! Further points in an embedding: points of the same surface, and finer meshes of it.

use geodesics::SurfacePoint;
use linalg::{LandmarkDistances, Matrix};
use mesh::{InputPoint, Surface};
use nmds::{Embedding, OutOfSample, Regularization, nystrom_extended};
use surface::VertexId;

use super::distances::Measurement;
use super::embedded::Embedded;
use super::method::EmbedMethod;
use super::outcome::Outcome;
use crate::error::Error;

impl Embedded {
    /// Refuses a surface of another number of vertices than the embedding is of.
    ///
    /// # Errors
    /// [`Error::Refused`].
    pub(super) fn check_points(&self, n_vertices: usize) -> Result<(), Error> {
        let n_points = self.embedding.n_points();
        if n_vertices == n_points {
            return Ok(());
        }
        Err(Error::refused(format!(
            "the embedding is of another surface: it has {n_points} points and this surface {n_vertices} vertices"
        )))
    }

    /// The map that places further points by their distances to the samples.
    ///
    /// # Errors
    /// [`Error::Refused`] unless the method is NMDS.
    pub fn extension(&self) -> Result<OutOfSample, Error> {
        if let Some(extension) = &self.extension {
            return Ok(extension.clone());
        }
        let EmbedMethod::Nystrom { mut regularization } = self.options.method else {
            let method = self.options.method.name();
            return Err(Error::refused(format!(
                "{method} cannot place further points in its embedding; nmds can"
            )));
        };
        if let Regularization::LowRank { rank } = &mut regularization {
            *rank = Some(self.embedding.rank);
        }
        Ok(nystrom_extended(&self.distances, regularization, self.embedding.dim())?.1)
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
    /// use canonform::Surface;
    /// use canonform::embed::{FormOptions, embed};
    /// use canonform::mesh::shapes;
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
    /// [`Error::Refused`] for another surface or method than NMDS, [`Error::Point`].
    pub fn place(&self, surface: &Surface, points: &[InputPoint]) -> Result<Matrix, Error> {
        self.check_points(surface.mesh().n_vertices())?;
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
            row -= &shift * moment(surface, &corners);
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
fn moment(surface: &Surface, corners: &[(VertexId, f64)]) -> f64 {
    let intrinsic = surface.intrinsic();
    let sides = corners.iter().enumerate().flat_map(|(i, a)| corners[..i].iter().map(move |b| (a, b)));
    let of_side = |((a, v), (b, w)): (&(VertexId, f64), &(VertexId, f64))| {
        let edge = intrinsic.topology().edge_between(*a, *b);
        v * w * edge.map_or(0.0, |edge| intrinsic.length(edge)).powi(2)
    };
    sides.map(of_side).sum()
}

/// The form of a coarser mesh, in whose coordinates a finer one is embedded.
#[derive(Debug, Clone)]
pub(super) struct Coarser<'a> {
    form: &'a Embedded,
    /// The samples of the form, as vertices of the finer mesh.
    samples: Vec<usize>,
    pub(super) extension: OutOfSample,
}

impl<'a> Coarser<'a> {
    /// # Errors
    /// [`Error::Refused`].
    pub(super) fn new(fine: &Surface, coarse: &Surface, form: &'a Embedded) -> Result<Self, Error> {
        form.check_points(coarse.mesh().n_vertices())?;
        let extension = form.extension()?;
        Ok(Self { form, samples: samples_on(fine, coarse, form)?, extension })
    }

    /// Measures distances from the samples and places all vertices.
    pub(super) fn place(&self, measurement: &Measurement<'_>) -> Result<Outcome, Error> {
        measurement.observer.begin("distances", self.samples.len());
        let distances = LandmarkDistances::new(self.samples.clone(), measurement.columns(&self.samples)?)?;
        let coords = self.extension.place(&distances.to_matrix()?)?;
        let embedding = Embedding { coords, ..self.form.embedding.clone() };
        Ok(Outcome { embedding, distances, search: None, all: None, descent: None })
    }
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
            nearest => Err(Error::refused(format!(
                "the finer mesh has no vertex near sample {} of the coarser one: the nearest is {:.4} away, and a mean edge is \
                 {allowed:.4} long; both must be meshes of one surface in one place",
                coarse.input_vertex(VertexId::from(sample)),
                nearest.map_or(f64::INFINITY, |(_, gap)| gap),
            ))),
        }
    };
    form.distances.landmarks().iter().map(near).collect()
}

#[cfg(test)]
mod tests {
    use geodesics::Method;
    use mesh::shapes;

    use super::*;
    use crate::form::{EmbedOptions, FormOptions, Samples, embed};

    fn surface(mesh: &mesh::TriMesh) -> Surface {
        Surface::new(mesh, &Default::default(), &()).unwrap()
    }

    #[test]
    fn points_of_a_flat_sheet_are_placed_exactly() {
        let sheet = surface(&shapes::grid(12, 9, 0.5));
        let (samples, geodesic) = (Samples::Count(20), Method::Exact);
        let options = FormOptions { samples, geodesic, dim: 2, ..FormOptions::default() };
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
    fn a_finer_mesh_elsewhere_and_other_methods_are_refused() {
        let [coarse, fine] = [2, 3].map(|level| surface(&shapes::icosphere(level)));
        let form = embed(&coarse, &FormOptions::default(), &()).unwrap();
        let moved = testkit::moved(&shapes::icosphere(3), |p| p + nalgebra::Vector3::x());
        let finer =
            |fine: &Surface, form: &Embedded| embed(fine, EmbedOptions::finer(fine, &coarse, form)?, &());
        let refused = |found: Result<Embedded, Error>| found.unwrap_err().to_string();
        assert!(refused(finer(&surface(&moved), &form)).contains("has no vertex near sample"));
        let options = FormOptions { method: EmbedMethod::Landmark, ..FormOptions::default() };
        let other = embed(&coarse, &options, &()).unwrap();
        assert!(refused(finer(&fine, &other)).starts_with("landmark cannot place"));
        assert!(
            refused(finer(&coarse, &embed(&fine, &FormOptions::default(), &()).unwrap()))
                .contains("642 points")
        );
        let found = finer(&fine, &form).unwrap();
        let placed = found.place(&fine, &["300".parse().unwrap()]).unwrap();
        assert!((placed.row(0) - found.embedding.coords.row(300)).norm() < 1e-12);
    }
}
