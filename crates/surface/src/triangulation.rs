//! Intrinsic triangulations and their edge flips.

use rayon::prelude::*;

use crate::ids::{CornerId, FaceId, VertexId};
use crate::intrinsic::{IntrinsicMesh, Link};
use crate::triangle::{Triangle, twice_area};

/// Limit of the number of flips per side; real meshes need less than one.
const FLIPS_PER_SIDE: usize = 32;

/// A negative sum of two cotangents is rounding if it is below this share of one plus their magnitudes.
const SLACK: f64 = 1e-10;

/// Marks a side without a neighbor.
const NONE: u32 = u32::MAX;

/// Fewest triangles or sides that one thread handles at a time.
const BLOCK: usize = 1024;

/// Triangles given by their side lengths and glued side to side, as a corner table.
///
/// A side may be free, as at the boundary, and glued triangles may have opposite orientations. Flipping a side
/// changes neither the surface nor its distances.
///
/// **Invariant.** [`opposite`](Self::opposite) joins sides of equal length between the same vertices, and is
/// its own inverse.
///
/// ```
/// use canonform_surface::{IntrinsicMesh, Loops, Topology, Triangulation, VertexId};
///
/// // A rhombus with sides of length 1, cut along its long diagonal.
/// let faces = vec![[0, 1, 2].map(VertexId), [2, 1, 3].map(VertexId)];
/// let mesh = IntrinsicMesh::new(Topology::new(4, faces), vec![1.0, 1.0, 1.8, 1.0, 1.0]);
/// let mut triangulation = Triangulation::new(&mesh);
///
/// let removed = triangulation.flip_to_delaunay(Loops::Forbidden);
/// assert_eq!((removed.len(), removed[0].length), (1, 1.8));
/// let short = 2.0 * (1.0f64 - 0.9 * 0.9).sqrt();
/// assert!(triangulation.triangles().iter().all(|t| t.lengths.iter().any(|l| (l - short).abs() < 1e-15)));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Triangulation {
    triangles: Vec<GluedTriangle>,
}

/// A triangle of a [`Triangulation`]. Sides are listed by the corner opposite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GluedTriangle {
    /// The vertices; other triangles may have the same ones.
    pub vertices: [VertexId; 3],
    /// The lengths of the sides.
    pub lengths: [f64; 3],
    /// The corners opposite the same sides in the neighboring triangles.
    opposite: [u32; 3],
}

/// Two triangles at a side that is not Delaunay.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quad {
    /// The corner opposite the side in the triangle below.
    far: CornerId,
    /// Whether the two triangles have opposite orientations.
    is_reversed: bool,
    /// The side, and those from its start and its end to the apex of the triangle above.
    above: [f64; 3],
    /// The same of the triangle below: from the end of the side and from its start.
    below: [f64; 3],
    /// The distance between the two apices.
    diagonal: f64,
}

impl Quad {
    /// The sides of the triangles after the flip.
    fn halves(&self) -> [[f64; 3]; 2] {
        let ([_, ca, bc], [_, db, ad]) = (self.above, self.below);
        [[self.diagonal, db, bc], [self.diagonal, ca, ad]]
    }
}

/// Whether the angle opposite the first of three sides is at most 90 degrees.
#[inline]
fn is_acute([base, p, q]: [f64; 3]) -> bool {
    base * base <= p * p + q * q
}

/// Whether flips may produce loops, sides from a vertex to itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loops {
    /// They may.
    Allowed,
    /// Sides whose flip would be a loop stay.
    Forbidden,
}

impl Triangulation {
    /// The faces of a mesh, glued at edges of exactly two faces.
    pub fn new(mesh: &IntrinsicMesh) -> Self {
        Self::glued_where(mesh, |_, _| true)
    }

    /// The same, but glued only where two opposite corners say so, whichever of them comes first.
    pub fn glued_where(mesh: &IntrinsicMesh, is_glued: impl Fn(CornerId, CornerId) -> bool + Sync) -> Self {
        let topology = mesh.topology();
        let far = |corner| {
            let far = topology.opposite(corner).filter(|far| is_glued(corner.min(*far), corner.max(*far)));
            far.map_or(NONE, |far| far.0)
        };
        let triangle = |(f, vertices): (usize, &[VertexId; 3])| {
            let [a, b, c] = FaceId(f as u32).corners();
            let lengths = [mesh.opposite_length(a), mesh.opposite_length(b), mesh.opposite_length(c)];
            GluedTriangle { vertices: *vertices, lengths, opposite: [far(a), far(b), far(c)] }
        };
        let faces = topology.faces().par_iter().with_min_len(BLOCK);
        Self { triangles: faces.enumerate().map(triangle).collect() }
    }

    /// Triangles with the given vertices, whose sides have neither lengths nor neighbors yet.
    pub(crate) fn loose(vertices: impl Iterator<Item = [VertexId; 3]>) -> Self {
        let triangle = |vertices| GluedTriangle { vertices, lengths: [0.0; 3], opposite: [NONE; 3] };
        Self { triangles: vertices.map(triangle).collect() }
    }

    pub(crate) fn set_length(&mut self, corner: CornerId, length: f64) {
        self.triangles[corner.face().index()].lengths[corner.slot()] = length;
    }

    pub(crate) fn glue(&mut self, a: CornerId, b: CornerId) {
        self.triangles[a.face().index()].opposite[a.slot()] = b.0;
        self.triangles[b.face().index()].opposite[b.slot()] = a.0;
    }

    /// Glues a side to the one with the given number, if there is one.
    fn set_neighbor(&mut self, side: CornerId, neighbor: u32) {
        if neighbor == NONE {
            self.triangles[side.face().index()].opposite[side.slot()] = NONE;
        } else {
            self.glue(side, CornerId(neighbor));
        }
    }

    /// The number of the corner opposite the same side as another, or [`NONE`].
    #[inline]
    fn neighbor(&self, side: CornerId) -> u32 {
        self.triangles[side.face().index()].opposite[side.slot()]
    }

    /// The corner opposite the same side in the neighboring triangle; `None` if the side is free.
    #[inline]
    pub fn opposite(&self, corner: CornerId) -> Option<CornerId> {
        let far = self.neighbor(corner);
        (far != NONE).then_some(CornerId(far))
    }

    /// The vertex in a corner.
    #[inline]
    pub fn corner_vertex(&self, corner: CornerId) -> VertexId {
        self.triangles[corner.face().index()].vertices[corner.slot()]
    }

    /// The triangles.
    pub fn triangles(&self) -> &[GluedTriangle] {
        &self.triangles
    }

    /// The lengths of the three sides of a corner's triangle, as in [`IntrinsicMesh::sides`].
    #[inline]
    pub fn sides(&self, corner: CornerId) -> [f64; 3] {
        let lengths = &self.triangles[corner.face().index()].lengths;
        let slot = corner.slot();
        [lengths[slot], lengths[(slot + 2) % 3], lengths[(slot + 1) % 3]]
    }

    /// Flips sides until the two angles opposite each sum to at most 180 degrees, and returns the original sides that
    /// were removed (the intrinsic Delaunay triangulation; Bobenko and Springborn 2007, `bobenko2007`).
    ///
    /// Free sides stay. The number of flips is limited, so a very degenerate surface may not become Delaunay.
    ///
    /// All sides are tested in parallel; only those to be flipped, and the sides around every flip, are visited one after
    /// the other.
    pub fn flip_to_delaunay(&mut self, loops: Loops) -> Vec<Link> {
        let mut removed = Vec::new();
        let mut waiting = self.sides_to_flip(loops);
        if waiting.is_empty() {
            return removed;
        }
        let n_sides = 3 * self.triangles.len();
        let mut is_new = vec![false; n_sides];
        let mut budget = FLIPS_PER_SIDE * n_sides;
        while let Some(corner) = waiting.pop() {
            let Some(quad) = self.flippable_quad(corner, loops) else { continue };
            let triangles = self.flip(corner, quad, &mut is_new, &mut removed);
            waiting.extend(triangles.into_iter().flat_map(|t| [1, 2].map(|slot| CornerId::new(t, slot))));
            budget -= 1;
            if budget == 0 {
                break;
            }
        }
        removed
    }

    /// The sides that are not Delaunay, in ascending order; each at the corners that are obtuse.
    fn sides_to_flip(&self, loops: Loops) -> Vec<CornerId> {
        let sides = (0..3 * self.triangles.len()).into_par_iter().with_min_len(BLOCK).map(CornerId::from);
        let is_flippable =
            |side: &CornerId| !is_acute(self.sides(*side)) && self.flippable_quad(*side, loops).is_some();
        sides.filter(is_flippable).collect()
    }

    /// The two triangles at a side, if it is not Delaunay and can be flipped.
    pub(crate) fn flippable_quad(&self, corner: CornerId, loops: Loops) -> Option<Quad> {
        let far = self.opposite(corner)?;
        if corner.face() == far.face() {
            return None;
        }
        // The triangles a b c above the side from a to b, and b a d below it.
        let is_reversed = self.is_reversed(corner, far);
        let above = self.sides(corner);
        let mut below = self.sides(far);
        if is_reversed {
            below.swap(1, 2);
        }
        // Nearly all sides face two acute angles, and stay.
        if is_acute(above) && is_acute(below) {
            return None;
        }
        let [upper, lower] = [above, below].map(Triangle::from_sides);
        let (at_c, at_d) = (upper.apex_cotangent(), lower.apex_cotangent());
        // Infinite for flat triangles; NaN, which is neither, if one of their apices lies between the ends of the side.
        let sum = at_c + at_d;
        let exceeds_180_degrees = sum == f64::NEG_INFINITY || sum < -SLACK * (1.0 + at_c.abs() + at_d.abs());
        if !exceeds_180_degrees {
            return None;
        }
        let diagonal = upper.apex_to_apex(lower);
        let quad = Quad { far, is_reversed, above, below, diagonal };
        // Two flat triangles become flat ones, whose long sides lead on to others. Their sum falls, so that this ends.
        let has_area = quad.halves().iter().all(|sides| twice_area(*sides) > 0.0);
        let [c, d] = [corner, far].map(|apex| self.corner_vertex(apex));
        let may_flip = (has_area || diagonal < above[0]) && (loops == Loops::Allowed || c != d);
        may_flip.then_some(quad)
    }

    /// Replaces a side by the other diagonal, the side opposite slot 0 of both triangles.
    fn flip(
        &mut self,
        corner: CornerId,
        quad: Quad,
        is_new: &mut [bool],
        removed: &mut Vec<Link>,
    ) -> [FaceId; 2] {
        let Quad { far, is_reversed, above: [base, ..], .. } = quad;
        let [f, g] = [corner.face(), far.face()];
        let [c, d] = [corner, far].map(|apex| self.corner_vertex(apex));
        if is_reversed {
            self.turn_over(far, is_new);
        }
        let [a, b] = [corner.next(), corner.prev()].map(|end| self.corner_vertex(end));
        if !is_new[corner.index()] {
            removed.push(Link { ends: [a, b], length: base });
        }
        let outer = [far.prev(), corner.next(), corner.prev(), far.next()];
        let moved = [(f, 1), (f, 2), (g, 1), (g, 2)].map(|(triangle, slot)| CornerId::new(triangle, slot));
        let new_number = |side: u32| outer.iter().position(|old| old.0 == side).map_or(side, |i| moved[i].0);
        let neighbors = outer.map(|old| new_number(self.neighbor(old)));
        let were_new = outer.map(|old| is_new[old.index()]);
        let triangle = |vertices, lengths| GluedTriangle { vertices, lengths, opposite: [NONE; 3] };
        let halves = quad.halves();
        self.triangles[f.index()] = triangle([b, c, d], halves[0]);
        self.triangles[g.index()] = triangle([a, d, c], halves[1]);
        for ((side, neighbor), was_new) in moved.into_iter().zip(neighbors).zip(were_new) {
            self.set_neighbor(side, neighbor);
            is_new[side.index()] = was_new;
        }
        let diagonals = [f, g].map(|triangle| CornerId::new(triangle, 0));
        self.glue(diagonals[0], diagonals[1]);
        diagonals.iter().for_each(|side| is_new[side.index()] = true);
        [f, g]
    }

    /// Whether two glued sides have the same direction, so that their triangles have opposite orientations.
    fn is_reversed(&self, corner: CornerId, far: CornerId) -> bool {
        let [start, end] = [corner.next(), corner.prev()].map(|c| self.corner_vertex(c));
        // A loop is glued as on an oriented surface.
        start != end && start == self.corner_vertex(far.next())
    }

    /// Reverses the orientation of a triangle around the given corner, which keeps its slot.
    fn turn_over(&mut self, corner: CornerId, is_new: &mut [bool]) {
        let [p, q] = [corner.next(), corner.prev()];
        let [at_p, at_q] = [p, q].map(|side| self.neighbor(side));
        let triangle = &mut self.triangles[corner.face().index()];
        triangle.vertices.swap(p.slot(), q.slot());
        triangle.lengths.swap(p.slot(), q.slot());
        is_new.swap(p.index(), q.index());
        // The two sides may be glued to each other.
        let renamed = |side: u32| match CornerId(side) {
            side if side == p => q.0,
            side if side == q => p.0,
            side => side.0,
        };
        self.set_neighbor(p, renamed(at_q));
        self.set_neighbor(q, renamed(at_p));
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use mesh::shapes;

    use super::*;
    use crate::testing::intrinsic;
    use crate::topology::Topology;

    fn flipped(mesh: &IntrinsicMesh) -> (Triangulation, Vec<Link>) {
        let mut triangulation = Triangulation::new(mesh);
        let removed = triangulation.flip_to_delaunay(Loops::Forbidden);
        (triangulation, removed)
    }

    pub(crate) fn area(triangulation: &Triangulation) -> f64 {
        triangulation.triangles.iter().map(|t| 0.5 * twice_area(t.lengths)).sum()
    }

    /// Glued sides fit together, and none can be flipped.
    pub(crate) fn assert_delaunay(triangulation: &Triangulation) {
        for corner in (0..3 * triangulation.triangles.len()).map(CornerId::from) {
            let Some(far) = triangulation.opposite(corner) else { continue };
            assert!(far != corner && triangulation.opposite(far) == Some(corner));
            let ends = |c: CornerId| {
                let mut ends = [c.next(), c.prev()].map(|end| triangulation.corner_vertex(end));
                ends.sort_unstable();
                ends
            };
            assert_eq!(ends(corner), ends(far));
            let [near, beyond] = [corner, far].map(|c| triangulation.sides(c));
            assert_eq!(near[0], beyond[0]);
            let [p, q] = [near, beyond].map(|sides| Triangle::from_sides(sides).apex_cotangent());
            assert!(corner.face() == far.face() || p + q >= -1e-9 * (1.0 + p.abs() + q.abs()), "{p} {q}");
        }
    }

    #[test]
    fn flips_give_a_delaunay_triangulation_of_the_same_area() {
        // The corners of a quad on the grid, the torus and the cylinder lie on a circle: either diagonal is Delaunay.
        for (mesh, is_delaunay) in [
            (shapes::sheared_grid(12, 9, 1.0, 1.0), false),
            (shapes::sheared_grid(12, 9, 1.0, 4.3), false),
            (shapes::jittered_grid(14, 14, 1.0, 0.24, 5), false),
            (shapes::icosphere(2), true),
            (shapes::grid(7, 5, 0.3), true),
            (shapes::torus(30, 4, 2.0, 0.5), true),
            (shapes::cylinder(5, 40, 1.0, 2.0), true),
        ] {
            let surface = intrinsic(&mesh);
            let (triangulation, removed) = flipped(&surface);
            assert_delaunay(&triangulation);
            assert_eq!(removed.is_empty(), is_delaunay, "{} faces", mesh.n_faces());
            assert!((area(&triangulation) / area(&Triangulation::new(&surface)) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn lengths_in_a_plane_are_the_distances_between_vertices() {
        let sheet = shapes::jittered_grid(12, 9, 1.0, 0.3, 5);
        let (triangulation, removed) = flipped(&intrinsic(&sheet));
        let distance =
            |a: VertexId, b: VertexId| (sheet.positions[a.index()] - sheet.positions[b.index()]).norm();
        for GluedTriangle { vertices: [a, b, c], lengths, .. } in triangulation.triangles() {
            for (length, ends) in lengths.iter().zip([[b, c], [c, a], [a, b]]) {
                assert!((length - distance(*ends[0], *ends[1])).abs() < 1e-12);
            }
        }
        for Link { ends: [a, b], length } in &removed {
            assert!((length - distance(*a, *b)).abs() < 1e-12);
        }
        // Every edge of the mesh is still there or was returned.
        let sides = triangulation.triangles.iter().map(|t| t.vertices);
        let sides = sides.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
        let known = sides.chain(removed.iter().map(|link| link.ends)).map(|[a, b]| [a.min(b), a.max(b)]);
        let known: std::collections::BTreeSet<_> = known.collect();
        let topology = Topology::new(sheet.n_vertices(), intrinsic(&sheet).topology().faces().to_vec());
        assert!(topology.edges().iter().all(|ends| known.contains(ends)));
    }

    #[test]
    fn the_orientation_of_faces_does_not_matter() {
        for mesh in [shapes::sheared_grid(12, 9, 1.0, 2.3), shapes::jittered_grid(9, 9, 1.0, 0.24, 3)] {
            let surface = intrinsic(&mesh);
            let turned = (0..).zip(surface.topology().faces());
            let turned = turned.map(|(f, [a, b, c])| if f % 3 == 0 { [*b, *a, *c] } else { [*a, *b, *c] });
            let topology = Topology::new(surface.n_vertices(), turned.collect());
            let turned = IntrinsicMesh::new(topology, surface.edge_lengths().to_vec());
            let [one, other] = [&surface, &turned].map(|mesh| {
                let (triangulation, removed) = flipped(mesh);
                assert_delaunay(&triangulation);
                let mut ends: Vec<_> = removed.iter().map(|link| [0, 1].map(|i| link.ends[i].0)).collect();
                ends.iter_mut().for_each(|ends| ends.sort_unstable());
                ends.sort_unstable();
                ends
            });
            assert_eq!(one, other);
        }
        // A Moebius strip has no orientation.
        let faces = [[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]].map(|f| f.map(VertexId));
        let topology = Topology::new(5, faces.to_vec());
        for wide in 0..topology.n_edges() {
            let lengths = (0..topology.n_edges()).map(|e| if e == wide { 1.8 } else { 1.0 }).collect();
            assert_delaunay(&flipped(&IntrinsicMesh::new(topology.clone(), lengths)).0);
        }
    }

    #[test]
    fn edges_of_one_or_three_faces_stay() {
        let faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4]].map(|f| f.map(VertexId));
        let topology = Topology::new(5, faces.to_vec());
        // The angles opposite the edge between vertices 0 and 1 are wide.
        let lengths = topology.edges().iter().map(|ends| if ends[1].0 == 1 { 1.9 } else { 1.0 }).collect();
        let surface = IntrinsicMesh::new(topology, lengths);
        assert_eq!(flipped(&surface), (Triangulation::new(&surface), Vec::new()));
    }

    #[test]
    fn loops_are_only_made_where_they_are_allowed() {
        // Two faces with all vertices in common, glued at two of their edges after another is split.
        let faces = [[0, 1, 2], [1, 0, 2]].map(|f| f.map(VertexId));
        let mesh = IntrinsicMesh::new(Topology::new(3, faces.to_vec()), vec![1.9, 1.0, 1.0]);
        assert_eq!(flipped(&mesh).1, Vec::new());
        let mut triangulation = Triangulation::new(&mesh);
        assert_eq!(triangulation.flip_to_delaunay(Loops::Allowed).len(), 1);
        assert_delaunay(&triangulation);
        assert!(triangulation.triangles.iter().all(|t| t.vertices.iter().filter(|v| v.0 == 2).count() == 2));
    }
}
