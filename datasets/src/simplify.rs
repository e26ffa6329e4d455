//! Simplification to a given number of vertices.

use base::{Budget, Exceeded};
use nalgebra::Point3;
use surface::{CornerId, NearestFirst, VertexId};

use crate::corner_table::EditableCorners;

/// A closed surface under construction.
#[derive(Debug, Clone)]
pub(crate) struct RestSurface {
    pub(crate) table: EditableCorners,
    pub(crate) positions: Vec<Point3<f64>>,
    /// Target edge length at each vertex, up to a common factor.
    pub(crate) grain: Vec<f64>,
}

/// Smallest cosine between the normals of a triangle before and after a collapse.
const MIN_COSINE: f64 = 0.2;

/// Most neighbors of a vertex after a collapse; with more, it would block further collapses.
const MAX_NEIGHBORS: usize = 12;

/// Collapses edges, the shortest relative to their grain first, until `n_vertices` vertices are left.
///
/// A vertex is merged into its neighbor without moving it, so that all vertices stay on the surface. An edge stays
/// if its collapse would break the manifold or invert a triangle. Edges far shorter than those of the result are
/// collapsed in a few sweeps, `O(m)` for the bulk, the others in the order of a queue, `O(k log k)` for the rest.
/// More vertices are left only if no other edge can be collapsed.
pub(crate) fn simplify(
    surface: &mut RestSurface,
    n_vertices: usize,
    budget: &Budget,
) -> Result<(), Exceeded> {
    // The cost c of the final edges: equilateral triangles cover 2 sqrt(3) c grains^2 per vertex.
    let final_cost = surface.area_in_grains() / (12f64.sqrt() * n_vertices as f64);
    for share in [1.0 / 64.0, 1.0 / 24.0, 1.0 / 10.0, 0.2] {
        sweep(surface, final_cost * share, n_vertices, budget)?;
    }
    let mut n_before = usize::MAX;
    // An edge that could not be collapsed in one round may be possible in the next.
    while (n_vertices + 1..n_before).contains(&surface.table.n_vertices()) {
        n_before = surface.table.n_vertices();
        collapse_by_queue(surface, n_vertices, budget)?;
    }
    Ok(())
}

/// Operations that a vertex or an edge counts for in the meter of a budget.
const OPERATIONS: usize = 64;

/// Collapses edges with a cost below `limit` in the order of their vertices.
///
/// A vertex into which another was merged stays until the next sweep. Otherwise a whole region of short edges
/// would collapse into a single vertex.
fn sweep(surface: &mut RestSurface, limit: f64, n_vertices: usize, budget: &Budget) -> Result<(), Exceeded> {
    let mut meter = budget.meter();
    let mut neighbors = Vec::new();
    let mut stays = vec![false; surface.positions.len()];
    for v in (0..surface.positions.len()).map(VertexId::from) {
        meter.count(OPERATIONS)?;
        if surface.table.n_vertices() <= n_vertices {
            break;
        }
        if stays[v.index()] || !surface.table.is_alive(v) {
            continue;
        }
        neighbors.clear();
        neighbors.extend(surface.table.neighbors(v).map(|x| (surface.cost(v, x), x)));
        neighbors.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut short = neighbors.iter().take_while(|(cost, _)| *cost < limit);
        if let Some((_, kept)) = short.find(|(_, x)| surface.collapse(v, *x)) {
            stays[kept.index()] = true;
        }
    }
    Ok(())
}

fn collapse_by_queue(surface: &mut RestSurface, n_vertices: usize, budget: &Budget) -> Result<(), Exceeded> {
    let mut meter = budget.meter();
    let mut queue = NearestFirst::default();
    for v in surface.table.vertices() {
        let above = surface.table.neighbors(v).filter(|&x| v < x);
        above.for_each(|x| queue.push(surface.cost(v, x), [v, x]));
    }
    while surface.table.n_vertices() > n_vertices
        && let Some((_, [u, w])) = queue.pop()
    {
        meter.count(OPERATIONS)?;
        // Collapses never remove an edge between two living vertices.
        if !(surface.table.is_alive(u) && surface.table.is_alive(w)) {
            continue;
        }
        let ways = [[u, w], [w, u]];
        let Some([_, kept]) = ways.into_iter().find(|[gone, kept]| surface.collapse(*gone, *kept)) else {
            continue;
        };
        for x in surface.table.neighbors(kept) {
            queue.push(surface.cost(kept, x), [kept.min(x), kept.max(x)]);
        }
    }
    Ok(())
}

impl RestSurface {
    /// Renumbers vertices and faces without the removed ones.
    pub(crate) fn compact(&mut self) {
        self.positions = self.table.vertices().map(|v| self.positions[v.index()]).collect();
        self.grain = self.table.vertices().map(|v| self.grain[v.index()]).collect();
        self.table = self.table.compacted();
    }

    /// Area of the surface in squared grains.
    fn area_in_grains(&self) -> f64 {
        let at = |v: VertexId| self.positions[v.index()];
        let area = |[a, b, c]: [VertexId; 3]| {
            let grain = [a, b, c].map(|v| self.grain[v.index()]).iter().sum::<f64>() / 3.0;
            0.5 * (at(b) - at(a)).cross(&(at(c) - at(a))).norm() / (grain * grain)
        };
        self.table.faces().map(area).sum()
    }

    /// Squared length of an edge over the squared sum of the grains of its ends.
    fn cost(&self, u: VertexId, w: VertexId) -> f64 {
        let (a, b) = (u.index(), w.index());
        let grain = self.grain[a] + self.grain[b];
        (self.positions[a] - self.positions[b]).norm_squared() / (grain * grain)
    }

    /// Merges `gone` into `kept` if possible; returns whether it was.
    fn collapse(&mut self, gone: VertexId, kept: VertexId) -> bool {
        let before = |c: &CornerId| self.table.vertex(c.next()) == kept;
        let Some(c) = self.table.around(gone).find(before).map(CornerId::prev) else { return false };
        let n_neighbors = self.table.neighbors(gone).count() + self.table.neighbors(kept).count() - 4;
        let possible =
            n_neighbors <= MAX_NEIGHBORS && self.table.can_collapse(c) && self.stays_unfolded(gone, kept);
        if possible {
            self.table.collapse(c);
        }
        possible
    }

    /// Whether no triangle around `gone` is inverted when it moves to `kept`.
    fn stays_unfolded(&self, gone: VertexId, kept: VertexId) -> bool {
        let at = |v: VertexId| self.positions[v.index()];
        self.table.around(gone).all(|c| {
            let (b, d) = (self.table.vertex(c.next()), self.table.vertex(c.prev()));
            if b == kept || d == kept {
                return true;
            }
            let edge = at(d) - at(b);
            let (old, new) = ((at(gone) - at(b)).cross(&edge), (at(kept) - at(b)).cross(&edge));
            old.dot(&new) > MIN_COSINE * (old.norm_squared() * new.norm_squared()).sqrt()
        })
    }
}
