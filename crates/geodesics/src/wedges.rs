//! What a vertex does when the front leaves it, laid out in the order in which it is needed.

use mesh::{CornerId, IntrinsicMesh};

use crate::graph::EdgeGraph;
use crate::unfold::{Unfolding, base, sides, unfold};
use crate::update::Corner;

/// How a fast-marching solver treats corners wider than 90 degrees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ObtuseTreatment {
    /// Unfold the surface behind the corner and split it.
    #[default]
    Unfold,
    /// Treat it like an acute one: faster to set up, and wrong wherever the front arrives out of order.
    Ignore,
}

/// Facts about the preparation of a surface for marching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CornerReport {
    /// Number of corners.
    pub corners: usize,
    /// Corners wider than 90 degrees.
    pub obtuse: usize,
    /// Obtuse corners that unfolding could not split, at boundaries and non-manifold edges.
    pub not_split: usize,
}

/// One step of the front away from a vertex `v`: along the edge to `target`, and through the
/// triangle over the base from `v` to `other` whose apex is `target`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wedge {
    /// The vertex that may be reached.
    pub(crate) target: u32,
    /// The other end of the base.
    pub(crate) other: u32,
    /// The apex over the base, laid out from `v`.
    pub(crate) corner: Corner,
    /// Length of the edge from `v` to `target`; infinite where another wedge of `v` carries it.
    pub(crate) edge: f64,
}

/// The wedges of every vertex, stored back to back, over vertices renumbered for locality.
#[derive(Debug, Clone)]
pub(crate) struct Wedges {
    offsets: Vec<u32>,
    wedges: Vec<Wedge>,
    /// Mesh vertex of every internal number.
    pub(crate) order: Vec<u32>,
    /// Internal number of every mesh vertex.
    pub(crate) rank: Vec<u32>,
}

impl Wedges {
    #[inline]
    pub(crate) fn of(&self, vertex: u32) -> &[Wedge] {
        let v = vertex as usize;
        &self.wedges[self.offsets[v] as usize..self.offsets[v + 1] as usize]
    }

    pub(crate) fn new(mesh: &IntrinsicMesh, obtuse: ObtuseTreatment) -> (Self, CornerReport) {
        let graph = EdgeGraph::new(mesh);
        let order = graph.breadth_first_order();
        let n = order.len();
        let mut rank = vec![0; n];
        for (internal, v) in order.iter().enumerate() {
            rank[*v as usize] = internal as u32;
        }
        let mut list =
            WedgeList { mesh, rank: &rank, wedges: Vec::with_capacity(6 * mesh.topology().n_faces()) };
        let report = list.add_corners(obtuse);
        let mut wedges = list.wedges;
        // Wedges of a vertex side by side, those with the same target too, so that its edge is carried once.
        wedges.sort_by_key(|(v, wedge)| (*v, wedge.target));
        let mut offsets = vec![0u32; n + 1];
        let mut previous = None;
        let mut packed = Vec::with_capacity(wedges.len());
        for (v, mut wedge) in wedges {
            if let Some(last) = packed.last_mut().filter(|_| previous == Some((v, wedge.target))) {
                let last: &mut Wedge = last;
                wedge.edge = wedge.edge.min(std::mem::replace(&mut last.edge, f64::INFINITY));
            }
            previous = Some((v, wedge.target));
            offsets[v as usize + 1] += 1;
            packed.push(wedge);
        }
        for v in 0..n {
            offsets[v + 1] += offsets[v];
        }
        (Self { offsets, wedges: packed, order, rank }, report)
    }
}

struct WedgeList<'a> {
    mesh: &'a IntrinsicMesh,
    rank: &'a [u32],
    wedges: Vec<(u32, Wedge)>,
}

impl WedgeList<'_> {
    fn add_corners(&mut self, obtuse: ObtuseTreatment) -> CornerReport {
        let topology = self.mesh.topology();
        let mut report = CornerReport { corners: 3 * topology.n_faces(), ..Default::default() };
        for corner in (0..report.corners as u32).map(CornerId) {
            let [a, b] = base(topology, corner).map(|v| self.rank[v.index()]);
            let apex = self.rank[topology.corner_vertex(corner).index()];
            let [c, from_a, from_b] = sides(self.mesh, corner);
            let wide = from_a * from_a + from_b * from_b < c * c;
            report.obtuse += usize::from(wide);
            self.add(apex, a, b, c, from_a, from_b, [from_a, from_b]);
            if wide && obtuse == ObtuseTreatment::Unfold {
                match unfold(self.mesh, corner) {
                    Unfolding::Split(split) => {
                        let middle = self.rank[split.vertex.index()];
                        self.add(
                            apex,
                            a,
                            middle,
                            split.left.base,
                            from_a,
                            split.length,
                            [f64::INFINITY, split.length],
                        );
                        self.add(
                            apex,
                            middle,
                            b,
                            split.right.base,
                            split.length,
                            from_b,
                            [split.length, f64::INFINITY],
                        );
                        // The segment inside the strip is a way back, too.
                        self.wedges.push((
                            apex,
                            Wedge { target: middle, other: apex, corner: Corner::VOID, edge: split.length },
                        ));
                    }
                    Unfolding::Stopped => report.not_split += 1,
                    Unfolding::Acute => {}
                }
            }
        }
        for link in self.mesh.links() {
            let [a, b] = link.ends.map(|v| self.rank[v.index()]);
            for (from, target) in [(a, b), (b, a)] {
                self.wedges
                    .push((from, Wedge { target, other: from, corner: Corner::VOID, edge: link.length }));
            }
        }
        report
    }

    /// The wedges of the corner at `apex` over the base from `a` to `b`, one at either end.
    #[allow(clippy::too_many_arguments, reason = "a triangle is three vertices and three lengths")]
    fn add(&mut self, apex: u32, a: u32, b: u32, base: f64, from_a: f64, from_b: f64, edges: [f64; 2]) {
        let wedge = |other, edge, corner| Wedge { target: apex, other, corner, edge };
        self.wedges.push((a, wedge(b, edges[0], Corner::from_lengths(base, from_a, from_b))));
        self.wedges.push((b, wedge(a, edges[1], Corner::from_lengths(base, from_b, from_a))));
    }
}
