//! The heat method.

mod flow;
mod system;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use base::{Budget, Exceeded, Observer};
use linalg::Matrix;
use rayon::prelude::*;
use surface::laplacian::{Element, Laplacian, Metric};
use surface::{
    Components, EdgeGraph, Frontier, IntrinsicMesh, Link, Rows, SurfacePoint, VertexId, components_with_links,
};

use crate::error::GeodesicError;
use crate::solver::{DistanceSolver, Pool, within};
use crate::source::{Source, point_within};
use flow::{HeatBar, LONGEST_BAR};
use system::System;

/// Options of [`HeatMethod`].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct HeatOptions {
    /// How long heat flows, positive; longer times give smoother distances. In units of `h^2`, where `h` is the mean
    /// side of the Delaunay triangles; on fine meshes in units of `h l`, `l` being a 200th of the square root of the
    /// area.
    ///
    /// Default: 0.85, a compromise over ten meshes of 3,000 to 43,000 vertices with known exact distances, whose best
    /// values are between 0.5 and 1.3. For a surface without features as small as its edges, the best value is
    /// between `2 h l` and `5 h l`.
    pub time: f64,
}

impl Default for HeatOptions {
    fn default() -> Self {
        Self { time: 0.85 }
    }
}

/// Heat put into a source; it can fall by `exp(-1390)` before it underflows.
const AMPLITUDE: f64 = 1e280;

/// The mean side, as a share of the square root of the area, below which heat flows for longer than the square of the
/// side, so that the error vanishes under refinement. `make bench-peers` measures the errors of the heat method.
const FINE: f64 = 1.0 / 200.0;

/// How far heat can travel, in heat lengths, before it underflows.
const RANGE: f64 = 1300.0;

/// Number of sources solved for at once, if there are many.
const LANES: usize = 4;

/// Approximate geodesic distances from the direction of heat flow (Crane, Weischedel and Wardetzky 2013,
/// [`crane2013`]), on an intrinsic Delaunay triangulation.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `A` | `M` | p x p, diagonal | lumped mass: a third of the area around each vertex |
/// | `-L_C` | `L` | p x p | cotangent stiffness, positive semidefinite |
/// | `t` | `time` | | heat time, see [`HeatOptions::time`] |
/// | `u` | `u` | p | heat at that time: `(M + t L) u = delta` |
/// | `X` | | one per triangle | `-grad u / abs(grad u)` |
/// | `phi` | `phi` | p | `L phi = -div X`, shifted |
///
/// * Triangles are flipped until they are Delaunay, on the tufted cover of the surface, where boundaries and
///   non-manifold edges need no special treatment (Sharp and Crane 2020, [`sharp2020`]). Heat is then positive
///   everywhere. The surface and its vertices stay the same.
/// * Both factorizations are done once, in one order of elimination; a source then costs three passes over a factor.
///   Many sources are solved [four at a time](DistanceSolver::distance_columns), with the same bits as one at a time.
/// * A smooth approximation: it is **not** 1-Lipschitz along edges, can be below or above the distance, and rounds
///   off creases where fronts meet. Compared with exact distances, the mean error is 1 to 3 % on meshes of thousands
///   of vertices, and ten times that at single vertices near the source. Never NaN or negative, zero at a source
///   vertex.
/// * Near a source, distances are at most the straight ones.
/// * From inside a face the mean error is the same, but up to ten times that in needles at a boundary.
/// * No heat leaves through the boundary (Neumann), so level lines are perpendicular to it.
/// * A link is a bar one heat length wide: it adds its length. Infinite exactly where no edge or link leads.
///
/// Cost on a surface: `O(p^1.5)` to set up; `O(p log p)` memory, and time per source.
///
/// **Deviations.** The potential is shifted to fit around the source, not at it, where the direction of flow is
/// undefined: this halves the largest errors. On fine meshes, heat flows for longer than the square of the mean side
/// (see
/// [`HeatOptions::time`]), so that the error vanishes under refinement, and long enough to reach the far end.
///
/// ```
/// use canonform_geodesics::{DistanceSolver, HeatMethod, HeatOptions};
/// use mesh::shapes;
/// use surface::VertexId;
///
/// // From one pole of a unit sphere to the other.
/// let method = HeatMethod::new(&shapes::icosphere(4).intrinsic(), HeatOptions::default(), &())?;
/// let farthest = method.distances(VertexId(0))?.into_iter().fold(0.0, f64::max);
/// assert!((farthest / std::f64::consts::PI - 1.0).abs() < 0.02);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
///
/// [`crane2013`]: https://doi.org/10.1145/2516971.2516977
/// [`sharp2020`]: https://doi.org/10.1111/cgf.14069
#[derive(Debug)]
pub struct HeatMethod {
    /// Mesh units in one unit of length inside.
    unit: f64,
    components: Components,
    /// The sides of the triangles, in units; inner ones come twice.
    sides: EdgeGraph,
    /// The step that eliminates each vertex, which is its place in all vectors.
    step: Vec<u32>,
    /// The triangles and links; their vertices are given by their steps.
    elements: Vec<Element>,
    /// The triangles at each vertex, once a source is not a vertex.
    at_vertices: OnceLock<Rows<u32>>,
    bars: Vec<HeatBar>,
    system: System,
    scratch: Pool<Vec<f64>>,
    budget: Budget,
}

impl HeatMethod {
    /// Flips the surface to Delaunay and factorizes its matrices.
    ///
    /// Lengths that violate the triangle inequality are corrected, see [`Metric`]. If rounding makes a matrix
    /// indefinite, 1e-12, 1e-9 or 1e-6 of its diagonal is added. The solver keeps to the budget of the observer, as its
    /// preparation does.
    ///
    /// # Errors
    /// [`GeodesicError::BadHeatTime`]; [`GeodesicError::NotFactorized`] if that does not help, or memory runs out;
    /// [`GeodesicError::Exceeded`].
    pub fn new(
        mesh: &IntrinsicMesh,
        options: HeatOptions,
        observer: &dyn Observer,
    ) -> Result<Self, GeodesicError> {
        let budget = observer.budget();
        if !(options.time > 0.0 && options.time.is_finite()) {
            return Err(GeodesicError::BadHeatTime { time: options.time });
        }
        let laplacian = Laplacian::new(mesh);
        budget.check()?;
        let metric = &laplacian.metric;
        let components = components_with_links(mesh);
        let grounded = components.lowest_vertices();
        let (side, area) = laplacian.mean_side_and_area();
        let time = options.time * side * side.max(FINE * area.sqrt());
        let time = time.max((extent(mesh, metric, &components, &budget)? / RANGE).powi(2));
        let links = metric.links.iter().filter(|link| link.ends[0] != link.ends[1]);
        let mut bars: Vec<HeatBar> = links.map(|link| HeatBar::new(link, time.sqrt())).collect();
        let system = System::new(&laplacian, &bars, time, &grounded, &budget)?;
        let sides = laplacian.elements.iter().flat_map(|element| {
            let [a, b, c] = element.vertices.map(VertexId);
            let [ab, ca, bc] = element.triangle.sides();
            [([a, b], ab), ([b, c], bc), ([c, a], ca)].map(|(ends, length)| Link { ends, length })
        });
        let sides = EdgeGraph::new(mesh.n_vertices(), sides);
        let mut step = vec![0; mesh.n_vertices()];
        for (i, row) in system.heat.order().rows().iter().enumerate() {
            step[*row] = i as u32;
        }
        let renamed =
            |element: &Element| Element { vertices: element.vertices.map(|v| step[v as usize]), ..*element };
        let elements = laplacian.elements.iter().map(renamed).collect();
        for bar in &mut bars {
            bar.ends = bar.ends.map(|v| step[v as usize]);
        }
        Ok(Self {
            unit: metric.unit,
            components,
            sides,
            step,
            elements,
            at_vertices: OnceLock::new(),
            bars,
            system,
            scratch: Pool::default(),
            budget,
        })
    }

    /// Solves for up to `K` sets of sources at once, one column of `out` each.
    fn solve_lanes<const K: usize>(
        &self,
        sets: &[&[Source]],
        max_distance: f64,
        out: &mut [f64],
    ) -> Result<(), Exceeded> {
        let n = self.step.len();
        self.scratch.with(|scratch| {
            scratch.clear();
            scratch.resize(2 * n * K, 0.0);
            let (u, phi) = scratch.split_at_mut(n * K);
            let (u, phi) = (u.as_chunks_mut::<K>().0, phi.as_chunks_mut::<K>().0);
            let around =
                |sources: &&[Source]| sources.iter().flat_map(|source| self.around(source)).collect();
            let around: Vec<Vec<(usize, f64, f64)>> = sets.iter().map(around).collect();
            for (lane, around) in around.iter().enumerate() {
                for (vertex, share, _) in around {
                    u[self.step[*vertex] as usize][lane] += AMPLITUDE * share;
                }
            }
            self.budget.check()?;
            self.system.heat.solve_ordered(u);
            self.budget.check()?;
            self.elements.iter().for_each(|element| flow::add_divergence(element, u, phi));
            self.bars.iter().for_each(|bar| bar.add_divergence(u, phi));
            self.budget.check()?;
            self.system.poisson.solve_ordered(phi);
            self.budget.check()?;
            for ((lane, around), column) in around.iter().enumerate().zip(out.chunks_exact_mut(n)) {
                self.read_lane(lane, around, phi, column);
                column.iter_mut().for_each(|distance| *distance = within(*distance, max_distance));
            }
            Ok(())
        })
    }

    /// The vertices around a source with their shares of the heat and their straight distances, in units. The shares of a point
    /// are its barycentric coordinates in the Delaunay triangle that holds it, or else in its own face.
    fn around(&self, source: &Source) -> Vec<(usize, f64, f64)> {
        let in_units = |length: f64| if self.unit > 0.0 { length / self.unit } else { 0.0 };
        let own = match source.point() {
            SurfacePoint::Vertex(vertex) => {
                let neighbors = self.sides.ways(vertex).iter().map(|way| (way.to.index(), 0.0, way.length));
                return [(vertex.index(), 1.0, 0.0)].into_iter().chain(neighbors).collect();
            }
            SurfacePoint::Edge { t, .. } => [1.0 - t, t, 0.0],
            SurfacePoint::Face { barycentric, .. } => barycentric,
        };
        let seen = source.seen().iter().map(|(v, length)| (v.index(), 0.0, in_units(*length)));
        let mut around: Vec<(usize, f64, f64)> = seen.collect();
        let places = around.iter().enumerate().map(|(place, (v, ..))| (self.step[*v], place));
        let places: BTreeMap<u32, usize> = places.collect();
        let at_vertices = self.at_vertices.get_or_init(|| {
            let corners = self.elements.iter().zip(0..);
            Rows::collect(
                self.step.len(),
                corners.flat_map(|(element, i)| element.vertices.map(|v| (v as usize, i))),
            )
        });
        let near: BTreeSet<u32> = places.keys().flat_map(|v| at_vertices.row(*v as usize)).copied().collect();
        let held = near.into_iter().find_map(|i| {
            let Element { vertices, triangle, .. } = &self.elements[i as usize];
            let [Some(a), Some(b), Some(c)] = vertices.map(|v| places.get(&v).copied()) else { return None };
            let straight = [a, b, c].map(|place| around[place].2);
            Some(([a, b, c], point_within([triangle.base, triangle.x, triangle.y], straight)?))
        });
        // A source sees the vertices of its edge or face first.
        let (corners, shares) = held.unwrap_or(([0, 1, 2], own));
        corners.into_iter().zip(shares).for_each(|(place, share)| around[place].1 += share.max(0.0));
        around
    }

    /// Distances from the potential.
    ///
    /// At a source, the direction of flow is undefined and the potential is wrong by a good part of an edge. So it is
    /// shifted to agree, in the mean of relative errors, with the straight distances to the vertices around.
    fn read_lane<const K: usize>(
        &self,
        lane: usize,
        around: &[(usize, f64, f64)],
        phi: &[[f64; K]],
        out: &mut [f64],
    ) {
        let potential = |v: usize| phi[self.step[v] as usize][lane];
        out.fill(f64::INFINITY);
        for (v, _, straight) in around {
            out[*v] = out[*v].min(*straight);
        }
        let component = |v| self.components.of(VertexId::from(v));
        let mut shifts = vec![Shift::default(); self.components.count];
        for (v, straight) in out.iter().enumerate().filter(|(_, straight)| straight.is_finite()) {
            if let Some(component) = component(v) {
                shifts[component].add(potential(v), *straight);
            }
        }
        for (v, distance) in out.iter_mut().enumerate() {
            if let Some(shift) = component(v).and_then(|component| shifts[component].mean()) {
                *distance = self.unit * distance.min((potential(v) - shift).max(0.0));
            }
        }
    }
}

/// A vertex this close to a source, in units, is at the source: a safety limit of the weights `1 / distance`.
const AT_SOURCE: f64 = 1e-6;

/// By how much the potential of a component exceeds known distances.
#[derive(Debug, Clone, Copy, Default)]
struct Shift {
    /// Sum and weights around sources.
    around: [f64; 2],
    /// Sum and number at sources, for sources without neighbors.
    at: [f64; 2],
}

impl Shift {
    fn add(&mut self, potential: f64, distance: f64) {
        let (sum, weight) =
            if distance > AT_SOURCE { (&mut self.around, 1.0 / distance) } else { (&mut self.at, 1.0) };
        sum[0] += weight * (potential - distance);
        sum[1] += weight;
    }

    /// The mean excess; `None` for a component without a source.
    fn mean(&self) -> Option<f64> {
        [self.around, self.at].into_iter().find(|[_, weight]| *weight > 0.0).map(|[sum, weight]| sum / weight)
    }
}

impl DistanceSolver for HeatMethod {
    fn n_vertices(&self) -> usize {
        self.step.len()
    }

    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        match out {
            [] => Ok(()),
            out => self.solve_lanes::<1>(&[sources], max_distance, out),
        }
    }

    /// Solves for four sources at a time, in parallel. The result depends neither on the threads nor on the grouping.
    fn distance_columns(&self, sources: &[VertexId]) -> Result<Matrix, Exceeded> {
        let p = self.n_vertices();
        let mut columns = self.budget.vector(p.saturating_mul(sources.len()))?;
        if p > 0 {
            let batches = columns.par_chunks_mut(LANES * p).zip(sources.par_chunks(LANES));
            batches.try_for_each(|(columns, sources)| match sources {
                [source] => self.distances_into(*source, columns),
                _ => {
                    let sets: Vec<[Source; 1]> = sources.iter().map(|v| [Source::vertex(*v)]).collect();
                    let sets: Vec<&[Source]> = sets.iter().map(|set| &set[..]).collect();
                    self.solve_lanes::<LANES>(&sets, f64::INFINITY, columns)
                }
            })?;
        }
        Ok(Matrix::from_vec(p, sources.len(), columns))
    }
}

/// The width of the widest component along edges, in units: the distance to the vertex farthest from the vertex
/// farthest from the first one.
fn extent(
    mesh: &IntrinsicMesh,
    metric: &Metric,
    components: &Components,
    budget: &Budget,
) -> Result<f64, Exceeded> {
    let links = metric.links.iter().map(|link| Link { length: link.length.min(LONGEST_BAR), ..*link });
    let edges = mesh.topology().edges().iter().zip(&metric.edges);
    let edges = edges.map(|(ends, length)| Link { ends: *ends, length: *length });
    let (graph, mut front) = (EdgeGraph::new(mesh.n_vertices(), edges.chain(links)), Frontier::default());
    let mut farthest = components.lowest_vertices();
    for _ in 0..2 {
        budget.check()?;
        front.reset(mesh.n_vertices());
        farthest.iter().for_each(|v| _ = front.relax(*v, 0.0));
        // The last vertex of a component that is visited is the farthest.
        let visit = |v, _| components.of(v).map(|component| farthest[component] = v).is_some();
        graph.search(&mut front, f64::INFINITY, visit, |_, _| ());
    }
    Ok(farthest.iter().map(|v| front.distance(*v)).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests;
