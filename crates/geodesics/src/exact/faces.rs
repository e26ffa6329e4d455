//! The faces of a surface, one cache line each.

use surface::{CornerId, FaceId, IntrinsicMesh, Topology, double_area, power_of_two_below, scalar_product};

/// The faces of a surface and their neighbours.
#[derive(Debug)]
pub(super) struct Faces {
    pub(super) all: Vec<Face>,
    /// For each side of a non-manifold edge, the other corners opposite that edge.
    non_manifold: Vec<Vec<Facing>>,
    /// The unit of all lengths here, in mesh units; a power of two, so that scaling is exact.
    pub(super) unit: f64,
    pub(super) longest_edge: f64,
}

/// A face; its sides are listed by the corner opposite.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Face {
    pub(super) lengths: [f64; 3],
    pub(super) double_area: f64,
    pub(super) vertices: [u32; 3],
    pub(super) beyond: [Beyond; 3],
}

/// What lies beyond a side of a face: nothing, the corner opposite in another face, or a list of such corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Beyond(u32);

/// A corner opposite a side, in the face beyond it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Facing {
    pub(super) corner: CornerId,
    pub(super) along: Along,
}

/// The direction of the base of a corner, from the next corner of its face to the previous one, compared with that of
/// the same edge in the face on this side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Along {
    /// The same direction.
    Same,
    /// The opposite direction, as on consistently oriented faces.
    Opposite,
}

/// Least height of a face over its longest edge, in lengths of that edge: faces without area are inflated, so that
/// windows can pass a vertex that lies on the edge.
const LEAST_HEIGHT: f64 = 1e-12;

/// The same in lengths of the shortest edge, whose direction must not change.
const LEAST_SLOPE: f64 = 1e-3;

/// Share of the longest edge of a face below which rounding hides the direction of its shortest edge.
const LEAST_EDGE: f64 = 1e-13;

/// Share of the longest edge of a face by which rounding may reduce it below the sum of the other two.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Faces {
    pub(super) fn new(mesh: &IntrinsicMesh) -> Self {
        let topology = mesh.topology();
        let longest = mesh.edge_lengths().iter().copied().fold(0.0, f64::max);
        let unit = power_of_two_below(longest);
        let mut non_manifold = Vec::new();
        let all = (0u32..)
            .zip(topology.faces())
            .map(|(f, vertices)| {
                let corners = FaceId(f).corners();
                let lengths = corners.map(|c| mesh.opposite_length(c) / unit);
                let (lengths, double_area) = triangle(lengths);
                let beyond = corners.map(|c| beyond(topology, c, &mut non_manifold));
                Face { lengths, double_area, vertices: vertices.map(|v| v.0), beyond }
            })
            .collect();
        Self { all, non_manifold, unit, longest_edge: longest / unit }
    }

    #[inline]
    pub(super) fn of(&self, face: FaceId) -> &Face {
        &self.all[face.index()]
    }

    /// Visits every corner beyond a side.
    #[inline]
    pub(super) fn for_each_facing(&self, beyond: Beyond, mut visit: impl FnMut(Facing)) {
        match beyond {
            Beyond::NOTHING => {}
            Beyond(bits) if bits & Beyond::LIST == 0 => visit(beyond.facing()),
            Beyond(bits) => {
                self.non_manifold[(bits & !Beyond::LIST) as usize].iter().copied().for_each(visit)
            }
        }
    }
}

impl Beyond {
    const NOTHING: Self = Self(u32::MAX);
    /// Marks the index of a list.
    const LIST: u32 = 1 << 31;

    fn one(facing: Facing) -> Self {
        Self(facing.corner.0 << 1 | u32::from(facing.along == Along::Same))
    }

    #[inline]
    fn facing(self) -> Facing {
        let along = if self.0 & 1 == 1 { Along::Same } else { Along::Opposite };
        Facing { corner: CornerId(self.0 >> 1), along }
    }
}

impl Face {
    /// Scalar product of the two sides at a corner.
    pub(super) fn cosine(&self, slot: usize) -> f64 {
        let [base, p, q] = [slot, next(slot), next(next(slot))].map(|i| self.lengths[i]);
        scalar_product(base, p, q)
    }

    pub(super) fn angle(&self, slot: usize) -> f64 {
        self.double_area.atan2(self.cosine(slot))
    }

    /// Whether the direction of the side opposite a corner is lost.
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

/// The sides of a triangle and twice its area, from lengths that may violate the triangle inequality by rounding.
///
/// The longest side is cut to the sum of the other two. If the third side is lost in the rounding of the other two,
/// these become equal. If rounding hides whether the area is positive, it is the least allowed: one unit in the last
/// place of a length may amount to a height of `1e-8`.
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
    let least = a * (LEAST_HEIGHT * a).min(LEAST_SLOPE * c);
    if c - (a - b) <= ROUNDING * a && !is_needle {
        return (lengths, least);
    }
    (lengths, double_area([a, b, c]).max(least))
}

fn beyond(topology: &Topology, corner: CornerId, non_manifold: &mut Vec<Vec<Facing>>) -> Beyond {
    let start = |c: CornerId| topology.corner_vertex(c.next());
    let facing = |other: CornerId| {
        let along = if start(other) == start(corner) { Along::Same } else { Along::Opposite };
        Facing { corner: other, along }
    };
    match topology.edge_corners(topology.opposite_edge(corner)) {
        [_] => Beyond::NOTHING,
        [p, q] => Beyond::one(facing(if *p == corner { *q } else { *p })),
        many => {
            non_manifold.push(many.iter().filter(|c| **c != corner).map(|c| facing(*c)).collect());
            Beyond(Beyond::LIST | (non_manifold.len() - 1) as u32)
        }
    }
}
