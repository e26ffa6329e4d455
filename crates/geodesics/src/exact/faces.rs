//! The surface as windows travel over it: one cache line a face.

use surface::{CornerId, FaceId, IntrinsicMesh, Topology, double_area, scalar_product};

/// The faces of a surface and who is next to whom.
#[derive(Debug)]
pub(super) struct Surface {
    pub(super) faces: Vec<Face>,
    /// The facing corners beyond each side of each non-manifold edge.
    fans: Vec<Vec<Facing>>,
    /// Mesh units in a unit of length in here; a power of two, so that scaling is exact.
    pub(super) unit: f64,
    /// Length of the longest edge.
    pub(super) longest_edge: f64,
}

/// A face: its edges, each in the place of the corner opposite.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Face {
    pub(super) lengths: [f64; 3],
    pub(super) double_area: f64,
    pub(super) vertices: [u32; 3],
    pub(super) beyond: [Beyond; 3],
}

/// What lies beyond an edge of a face, packed: nothing, a corner of another face that faces the
/// edge, or a list of such corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Beyond(u32);

/// A corner that faces an edge from beyond.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Facing {
    pub(super) corner: u32,
    pub(super) along: Along,
}

/// How the base of a corner, from the next corner of its face to the next but one, runs compared
/// with that of the corner on this side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Along {
    /// The same way.
    Same,
    /// The other way; so it is on consistently oriented faces.
    Opposite,
}

/// Least height of a face over its longest edge, in lengths of that edge: a face without area is
/// blown up that much, so that light from a vertex that lies on the edge has room to pass through.
const LEAST_HEIGHT: f64 = 1e-12;

/// The same in lengths of the shortest edge, whose shape must not suffer.
const LEAST_SLOPE: f64 = 1e-3;

/// Share of the longest edge of a face below which the direction of its shortest is lost in the
/// rounding of the others.
const LEAST_EDGE: f64 = 1e-13;

/// Share of the longest edge of a face by which it may be shorter than the others together, and
/// still as long but for rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Surface {
    pub(super) fn new(mesh: &IntrinsicMesh) -> Self {
        let topology = mesh.topology();
        let longest = mesh.edge_lengths().iter().copied().fold(0.0, f64::max);
        let unit = power_of_two_near(longest);
        let mut fans = Vec::new();
        let faces = (0u32..)
            .zip(topology.faces())
            .map(|(f, vertices)| {
                let corners = FaceId(f).corners();
                let lengths = corners.map(|c| mesh.opposite_length(c) / unit);
                let (lengths, double_area) = triangle(lengths);
                let beyond = corners.map(|c| beyond(topology, c, &mut fans));
                Face { lengths, double_area, vertices: vertices.map(|v| v.0), beyond }
            })
            .collect();
        Self { faces, fans, unit, longest_edge: longest / unit }
    }

    /// The face of a corner.
    #[inline]
    pub(super) fn face(&self, corner: u32) -> &Face {
        &self.faces[corner as usize / 3]
    }

    /// The corner beyond an edge if there is no other.
    #[inline]
    pub(super) fn only_facing(&self, beyond: Beyond) -> Option<Facing> {
        (beyond.0 & Beyond::LIST == 0).then(|| beyond.facing())
    }

    /// Visits every corner beyond an edge.
    #[inline]
    pub(super) fn for_each_facing(&self, beyond: Beyond, mut visit: impl FnMut(Facing)) {
        match self.only_facing(beyond) {
            Some(facing) => visit(facing),
            None if beyond == Beyond::NOTHING => {}
            None => self.fans[(beyond.0 & !Beyond::LIST) as usize].iter().copied().for_each(visit),
        }
    }
}

impl Beyond {
    const NOTHING: Self = Self(u32::MAX);
    /// Marks the index of a list.
    const LIST: u32 = 1 << 31;

    fn one(facing: Facing) -> Self {
        Self(facing.corner << 1 | u32::from(facing.along == Along::Same))
    }

    #[inline]
    fn facing(self) -> Facing {
        let along = if self.0 & 1 == 1 { Along::Same } else { Along::Opposite };
        Facing { corner: self.0 >> 1, along }
    }
}

impl Face {
    /// Scalar product of the two sides at a corner.
    pub(super) fn cosine(&self, slot: usize) -> f64 {
        let [base, p, q] = [slot, next(slot), next(next(slot))].map(|i| self.lengths[i]);
        scalar_product(base, p, q)
    }

    /// Angle at a corner.
    pub(super) fn angle(&self, slot: usize) -> f64 {
        self.double_area.atan2(self.cosine(slot))
    }

    /// Whether the direction of the edge opposite a corner is lost.
    pub(super) fn is_point_like(&self, slot: usize) -> bool {
        self.lengths[slot] <= LEAST_EDGE * self.lengths.iter().copied().fold(0.0, f64::max)
    }
}

/// The slot after `slot` in a face.
#[inline]
pub(super) fn next(slot: usize) -> usize {
    // A table, because a branch would be mispredicted every third time.
    [1, 2, 0][slot]
}

/// One for zero.
fn power_of_two_near(length: f64) -> f64 {
    if length > 0.0 { 2f64.powi(length.log2().floor().clamp(-1020.0, 1020.0) as i32) } else { 1.0 }
}

/// The sides of a triangle and twice its area, from lengths that rounding may have made impossible.
///
/// The longest is no longer than the others together; of two that differ by rounding alone, beside
/// a third that is lost in it, both are equal. Where rounding hides whether there is an area, there
/// is as good as none: one unit in the last place of a length may stand for a height of `1e-8`.
fn triangle(mut lengths: [f64; 3]) -> ([f64; 3], f64) {
    let mut order = [0, 1, 2];
    order.sort_unstable_by(|i, j| lengths[*j].total_cmp(&lengths[*i]));
    let [longest, middle, shortest] = order;
    lengths[longest] = lengths[longest].min(lengths[middle] + lengths[shortest]);
    let is_needle = lengths[shortest] <= LEAST_EDGE * lengths[longest];
    if is_needle {
        lengths[middle] = lengths[longest];
    }
    let [a, b, c] = order.map(|i| lengths[i]);
    let excess = c - (a - b);
    let least = a * (LEAST_HEIGHT * a).min(LEAST_SLOPE * c);
    if excess <= ROUNDING * a && !is_needle {
        return (lengths, least);
    }
    (lengths, double_area([a, b, c]).max(least))
}

fn beyond(topology: &Topology, corner: CornerId, fans: &mut Vec<Vec<Facing>>) -> Beyond {
    let start = |c: CornerId| topology.corner_vertex(c.next());
    let facing = |other: CornerId| {
        let along = if start(other) == start(corner) { Along::Same } else { Along::Opposite };
        Facing { corner: other.0, along }
    };
    match topology.edge_corners(topology.opposite_edge(corner)) {
        [_] => Beyond::NOTHING,
        [p, q] => Beyond::one(facing(if *p == corner { *q } else { *p })),
        many => {
            fans.push(many.iter().filter(|c| **c != corner).map(|c| facing(*c)).collect());
            Beyond(Beyond::LIST | (fans.len() - 1) as u32)
        }
    }
}
