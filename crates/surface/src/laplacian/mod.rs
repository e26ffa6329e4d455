//! The Laplacian of a surface, from edge lengths alone.
//!
//! [`IntrinsicMesh`] -> [`Metric`] -> Delaunay [`Element`]s -> [`Laplacian`] ->
//! `geodesics` (heat), `descriptors` (spectra), `canonform` (spectral embeddings)
//!
//! Robust where the textbook formula is not (Sharp and Crane 2020, [`sharp2020`]): any lengths become triangles
//! ([`Metric`]); boundaries, non-manifold edges and faces of opposite orientation need no special treatment; edges
//! are flipped until no weight is negative. Matrices are returned as lists of entries.
//!
//! [`sharp2020`]: https://doi.org/10.1111/cgf.14069

mod cover;
mod elements;
mod metric;

pub use elements::Element;
pub use metric::Metric;

use crate::intrinsic::IntrinsicMesh;
use crate::triangulation::Loops;

/// Linear finite elements on an intrinsic Delaunay triangulation of a surface.
///
/// | symbol | here | meaning |
/// |---|---|---|
/// | `W` | [`stiffness_entries`](Self::stiffness_entries) | cotangent stiffness, symmetric, positive semidefinite, rows sum to zero |
/// | `A` | [`masses`](Self::masses) | lumped mass: a third of the area of the triangles around each vertex |
///
/// * The vertices are those of the mesh, in its order.
/// * `W` has no unit; `A` is in squared [units](Metric::unit) of the mean edge length, which prevents overflow and
///   underflow. `x' W x` is the Dirichlet energy of the function that is linear on every triangle, `1' A 1` the area.
/// * A link is a bar one unit wide and without mass, which couples functions on its two ends.
/// * `O(p)` memory, and time on meshes whose triangles are not all slivers.
///
/// **Deviation**: equal triangles of the front and the back of the double cover are merged.
#[derive(Debug, Clone)]
pub struct Laplacian {
    /// Number of vertices p.
    pub n_vertices: usize,
    /// The corrected lengths and their unit.
    pub metric: Metric,
    /// The triangles.
    pub elements: Vec<Element>,
}

impl Laplacian {
    /// Corrects the lengths and flips the surface to Delaunay.
    pub fn new(mesh: &IntrinsicMesh) -> Self {
        let metric = Metric::new(mesh);
        let mut cover = cover::tufted_cover(mesh, &metric.edges);
        cover.flip_to_delaunay(Loops::Allowed);
        Self { n_vertices: mesh.n_vertices(), elements: elements::elements(&cover), metric }
    }

    /// The mean length of the sides of all triangles, in units, and their area, in squared units; zeros without any.
    pub fn mean_side_and_area(&self) -> (f64, f64) {
        let [mut shares, mut perimeter, mut area] = [0.0; 3];
        for Element { triangle, share, .. } in &self.elements {
            shares += share;
            let [base, left, right] = triangle.sides();
            perimeter += share * (base + right + left);
            area += share * triangle.area();
        }
        if shares > 0.0 { (perimeter / (3.0 * shares), area) } else { (0.0, 0.0) }
    }

    /// The area around every vertex, in squared units; zero at a vertex that no face names.
    pub fn masses(&self) -> Vec<f64> {
        let mut masses = vec![0.0; self.n_vertices];
        for Element { vertices, triangle, share } in &self.elements {
            vertices.iter().for_each(|&v| masses[v as usize] += share * triangle.area() / 3.0);
        }
        masses
    }

    /// The stiffness as `(row, column, value)`. Values add up; those off the diagonal stand for their mirror images
    /// too.
    pub fn stiffness_entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let links = self.metric.links.iter().filter(|link| link.ends[0] != link.ends[1]);
        let bars = links.map(|link| (link.ends.map(|v| v.0), 1.0 / link.length));
        self.elements.iter().flat_map(Element::weights).chain(bars).flat_map(|(ends, weight)| {
            let [i, j] = ends.map(|v| v as usize);
            [(i, i, weight), (j, j, weight), (i, j, -weight)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::{TriMesh, shapes};

    use crate::testing::intrinsic;
    use crate::{Link, VertexId};

    fn of(mesh: &TriMesh) -> Laplacian {
        Laplacian::new(&intrinsic(mesh))
    }

    /// `x' W x`
    fn energy(laplacian: &Laplacian, x: impl Fn(usize) -> f64) -> f64 {
        laplacian
            .stiffness_entries()
            .map(|(i, j, value)| if i == j { value * x(i) * x(i) } else { 2.0 * value * x(i) * x(j) })
            .sum()
    }

    #[test]
    fn masses_sum_to_the_area_in_squared_units() {
        for mesh in [shapes::icosphere(3), shapes::jittered_grid(12, 9, 0.3, 0.24, 4), shapes::cube(1)] {
            let laplacian = of(&mesh);
            let area: f64 = (0..mesh.n_faces()).map(|f| 0.5 * mesh.area_vector(f).norm()).sum();
            let found = laplacian.masses().iter().sum::<f64>() * laplacian.metric.unit.powi(2);
            assert!((found / area - 1.0).abs() < 1e-12, "{found} against {area}");
        }
    }

    #[test]
    fn the_energy_of_a_linear_function_is_its_squared_slope_times_the_area() {
        let share = |mesh: &TriMesh| {
            let laplacian = of(mesh);
            let area = laplacian.mean_side_and_area().1 * laplacian.metric.unit.powi(2);
            energy(&laplacian, |v| 3.0 * mesh.positions[v].x - 4.0 * mesh.positions[v].y) / (25.0 * area)
        };
        assert!((share(&shapes::grid(14, 11, 0.5)) - 1.0).abs() < 1e-12);
        // Flips never raise an energy (Rippa 1990); those at a boundary lead to the back and lower it.
        for mesh in [shapes::jittered_grid(14, 11, 0.5, 0.24, 8), shapes::sheared_grid(9, 9, 0.5, 3.1)] {
            let found = share(&mesh);
            assert!(found > 0.5 && found < 1.0 + 1e-12, "{found}");
        }
    }

    #[test]
    fn links_join_and_have_no_mass() {
        let mesh = intrinsic(&shapes::disjoint(&[shapes::cube(1), shapes::cube(1)]));
        let n = mesh.n_vertices();
        let ends = [VertexId(0), VertexId::from(n - 1)];
        let apart = Laplacian::new(&mesh);
        let joined = Laplacian::new(
            &mesh.with_links(vec![Link { ends, length: 2.0 }, Link { ends: [ends[0]; 2], length: 1.0 }]),
        );
        let step = |v: usize| if v < n / 2 { 0.0 } else { 1.0 };
        assert!(energy(&apart, step).abs() < 1e-14);
        let length = 2.0 / joined.metric.unit;
        assert!((energy(&joined, step) - 1.0 / length).abs() < 1e-14);
        assert!((joined.masses().iter().sum::<f64>() - joined.mean_side_and_area().1).abs() < 1e-12);
    }

    #[test]
    fn vertices_without_faces_have_no_mass_and_no_weight() {
        let mut mesh = shapes::tetrahedron(0);
        mesh.positions.push(mesh.positions[0]);
        let laplacian = of(&mesh);
        assert_eq!(laplacian.masses().last(), Some(&0.0));
        assert!(laplacian.stiffness_entries().all(|(i, j, _)| i.max(j) < mesh.n_vertices() - 1));
        let none = of(&TriMesh::default());
        assert_eq!((none.n_vertices, none.masses(), none.stiffness_entries().count()), (0, vec![], 0));
    }
}
