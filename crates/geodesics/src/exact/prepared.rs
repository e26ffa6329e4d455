//! The surface: renumbered for locality, its faces one cache line each, and the corners around its vertices.

use std::f64::consts::PI;

use surface::{
    CornerId, EdgeGraph, FaceId, FanCorner, IntrinsicMesh, Link, OneRing, Rows, Topology, VertexId,
    VertexKind, Winding, power_of_two_below, scalar_product, twice_area,
};

use crate::order::{patches_of, ranks};
use crate::plane::around;

/// Limit of the mean number of windows propagated per face. Real surfaces of a million vertices need less than a
/// hundred; only needles with angles below 1e-6 around one vertex come near the limit.
const WINDOWS_PER_FACE: usize = 10_000;

/// How the shortest known path arrives at a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Arrival {
    /// From a source or over a link: it may continue in any direction.
    Anywhere,
    /// Through the face of a corner at the vertex. The angle from the side to the start of the corner's base has this
    /// sine and cosine, times any factor.
    Through { corner: CornerId, sin: f64, cos: f64 },
}

/// The face of a corner, laid out with its base `ab`, the side opposite the corner, on the x-axis from zero, and the
/// corner `c` above.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaceFrame {
    /// Length of `ab`.
    pub(super) base: f64,
    /// Position of `c`.
    pub(super) apex: [f64; 2],
    /// Lengths of `ac` and `bc`.
    pub(super) sides: [f64; 2],
    /// Direction of `ac` from `a`.
    pub(super) from_a: [f64; 2],
    /// Direction of `bc` from `b`, mirrored: in the frame with `b` at zero.
    pub(super) from_b: [f64; 2],
    /// `a`, `b`, `c`.
    pub(super) vertices: [u32; 3],
}

impl FaceFrame {
    /// The face of a corner whose base has a length.
    ///
    /// Does not use [`surface::Triangle`]: the area is known, which saves a square root in the innermost loop.
    #[inline]
    pub(super) fn new(faces: &Faces, corner: CornerId) -> Self {
        let (face, slot) = (faces.of(corner.face()), corner.slot());
        let [a, b] = around(slot);
        // A side is in the place of the corner opposite: `ac` in that of `b`.
        let (base, ac, bc) = (face.lengths[slot], face.lengths[b], face.lengths[a]);
        let per_base = 1.0 / base;
        let height = face.twice_area * per_base;
        // The differences are exact on short sides, where the squares are not.
        let skew = (ac - bc) * (ac + bc) * per_base;
        let (from_a, from_b) = (0.5 * (base + skew), 0.5 * (base - skew));
        let (per_ac, per_bc) = (1.0 / ac, 1.0 / bc);
        Self {
            base,
            apex: [from_a, height],
            sides: [ac, bc],
            from_a: [from_a * per_ac, height * per_ac],
            from_b: [from_b * per_bc, height * per_bc],
            vertices: [face.vertices[a], face.vertices[b], face.vertices[slot]],
        }
    }
}

/// A surface prepared for the propagation of windows; vertices and faces are renumbered.
#[derive(Debug)]
pub(super) struct PreparedSurface {
    pub(super) faces: Faces,
    pub(super) fans: Fans,
    /// In mesh units.
    pub(super) links: EdgeGraph,
    /// How many faces a window may cross in a row around one vertex.
    pub(super) max_turn: i32,
    /// How many windows a run may propagate.
    pub(super) max_windows: usize,
    /// The new number of every vertex and face. The corners of a face keep their order, or have that of the face it repeats.
    pub(super) new_vertices: Vec<u32>,
    pub(super) new_faces: Vec<u32>,
}

impl PreparedSurface {
    pub(super) fn new(mesh: &IntrinsicMesh) -> Self {
        let (mesh, new_vertices, new_faces) = renumbered(mesh);
        let faces = Faces::new(&mesh);
        let fans = Fans::new(&mesh, &faces);
        let links = EdgeGraph::new(mesh.n_vertices(), mesh.links().iter().copied());
        // A shortest path crosses no face twice.
        let max_turn = i32::try_from(fans.max_valence()).unwrap_or(i32::MAX);
        let max_windows = WINDOWS_PER_FACE.saturating_mul(faces.all.len());
        Self { faces, fans, links, max_turn, max_windows, new_vertices, new_faces }
    }

    pub(super) fn n_vertices(&self) -> usize {
        self.new_vertices.len()
    }

    /// The face of a corner.
    #[inline]
    pub(super) fn face(&self, corner: CornerId) -> &Face {
        self.faces.of(corner.face())
    }
}

/// Numbers vertices by patches, and faces by their vertices. Returns the new mesh and the new numbers of all vertices and faces.
///
/// Of faces with the same vertices, only the first is kept: any path through another can run through it, and windows
/// would multiply at every face.
fn renumbered(mesh: &IntrinsicMesh) -> (IntrinsicMesh, Vec<u32>, Vec<u32>) {
    let topology = mesh.topology();
    let vertices = ranks(&patches_of(mesh));
    let new = |face: &[VertexId; 3]| face.map(|v| VertexId(vertices[v.index()]));
    let mut sorted: Vec<([VertexId; 3], u32)> = (0u32..)
        .zip(topology.faces())
        .map(|(f, face)| {
            let mut key = new(face);
            key.sort_unstable();
            (key, f)
        })
        .collect();
    sorted.sort_unstable();

    let mut faces = vec![0; topology.n_faces()];
    let mut kept: Vec<u32> = Vec::with_capacity(sorted.len());
    for group in sorted.chunk_by(|p, q| p.0 == q.0) {
        for (_, f) in group {
            faces[*f as usize] = kept.len() as u32;
        }
        kept.push(group[0].1);
    }
    let renumbered = Topology::new(
        topology.n_vertices(),
        kept.iter().map(|f| new(&topology.faces()[*f as usize])).collect(),
    );
    let mut lengths = vec![0.0; renumbered.n_edges()];
    for (now, before) in (0u32..).zip(&kept) {
        for (old, new) in FaceId(*before).corners().into_iter().zip(FaceId(now).corners()) {
            lengths[renumbered.opposite_edge(new).index()] = mesh.opposite_length(old);
        }
    }
    let link = |link: &Link| Link { ends: link.ends.map(|v| VertexId(vertices[v.index()])), ..*link };
    let links = mesh.links().iter().map(link).collect();
    (IntrinsicMesh::new(renumbered, lengths).with_links(links), vertices, faces)
}

/// The faces of a surface and their neighbors.
#[derive(Debug)]
pub(super) struct Faces {
    pub(super) all: Vec<Face>,
    /// The unit of all lengths here, in mesh units; a power of two, so that scaling is exact.
    pub(super) unit: f64,
    pub(super) longest_edge: f64,
}

/// A face; its sides are listed by the corner opposite.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Face {
    pub(super) lengths: [f64; 3],
    pub(super) twice_area: f64,
    pub(super) vertices: [u32; 3],
    /// For each side, the next of the corners opposite to it in the faces that share it; the same corner again if no other
    /// does.
    across: [CornerId; 3],
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
const MIN_HEIGHT: f64 = 1e-12;

/// The same in lengths of the shortest edge, whose direction must not change.
const MIN_SLOPE: f64 = 1e-3;

/// Share of the longest edge of a face below which rounding hides the direction of its shortest edge.
const MIN_EDGE: f64 = 1e-13;

/// Share of the longest edge of a face by which rounding may reduce it below the sum of the other two.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Faces {
    pub(super) fn new(mesh: &IntrinsicMesh) -> Self {
        let topology = mesh.topology();
        let longest = mesh.edge_lengths().iter().copied().fold(0.0, f64::max);
        let unit = power_of_two_below(longest);
        let after = |corner: CornerId| {
            let around = topology.edge_corners(topology.opposite_edge(corner));
            around[around.partition_point(|other| *other <= corner) % around.len()]
        };
        let all = (0u32..)
            .zip(topology.faces())
            .map(|(f, vertices)| {
                let corners = FaceId(f).corners();
                let lengths = corners.map(|c| mesh.opposite_length(c) / unit);
                let (lengths, twice_area) = triangle(lengths);
                Face { lengths, twice_area, vertices: vertices.map(|v| v.0), across: corners.map(after) }
            })
            .collect();
        Self { all, unit, longest_edge: longest / unit }
    }

    #[inline]
    pub(super) fn of(&self, face: FaceId) -> &Face {
        &self.all[face.index()]
    }

    /// Visits the corners opposite the same edge as this one in other faces.
    #[inline]
    pub(super) fn for_each_facing(&self, own: CornerId, mut visit: impl FnMut(CornerId, Along)) {
        let start = |corner: CornerId| self.of(corner.face()).vertices[around(corner.slot())[0]];
        let after = |corner: CornerId| self.of(corner.face()).across[corner.slot()];
        let mut corner = after(own);
        while corner != own {
            visit(corner, if start(corner) == start(own) { Along::Same } else { Along::Opposite });
            corner = after(corner);
        }
    }
}

impl Face {
    /// Scalar product of the two sides at a corner.
    pub(super) fn cosine(&self, slot: usize) -> f64 {
        let [p, q] = around(slot).map(|side| self.lengths[side]);
        scalar_product(self.lengths[slot], p, q)
    }

    pub(super) fn angle(&self, slot: usize) -> f64 {
        self.twice_area.atan2(self.cosine(slot))
    }

    /// Whether the direction of the side opposite a corner is lost.
    pub(super) fn is_point_like(&self, slot: usize) -> bool {
        self.lengths[slot] <= MIN_EDGE * self.lengths.iter().copied().fold(0.0, f64::max)
    }
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
    let is_needle = lengths[shortest] <= MIN_EDGE * lengths[longest];
    if is_needle {
        lengths[middle] = lengths[longest];
    }
    let [a, b, c] = order.map(|i| lengths[i]);
    let least = a * (MIN_HEIGHT * a).min(MIN_SLOPE * c);
    if c - (a - b) <= ROUNDING * a && !is_needle {
        return (lengths, least);
    }
    (lengths, twice_area([a, b, c]).max(least))
}

/// Excess of a total angle, in radians, up to which it is rounding and paths do not bend at a vertex; it affects no
/// distance measurably.
const MIN_EXCESS: f64 = 1e-12;

/// A corner in the fan of a vertex, with angles.
#[derive(Debug, Clone, Copy)]
pub(super) struct FanSector {
    pub(super) corner: FanCorner,
    /// Angles from the fan's first side to the corner's first and last.
    pub(super) start: f64,
    pub(super) end: f64,
}

/// The corners around every vertex, fan by fan.
#[derive(Debug)]
pub(super) struct Fans {
    sectors: Rows<FanSector>,
    kinds: Vec<VertexKind>,
}

impl Fans {
    pub(super) fn new(mesh: &IntrinsicMesh, faces: &Faces) -> Self {
        let topology = mesh.topology();
        let n_vertices = topology.n_vertices();
        let (mut sectors, mut ends, mut kinds) = (Vec::new(), vec![0], Vec::with_capacity(n_vertices));
        let mut ring = OneRing::default();
        for vertex in (0..n_vertices).map(VertexId::from) {
            ring.collect(topology, vertex);
            let mut angle = 0.0;
            let sector = |corner: &FanCorner| {
                let start = angle;
                angle += faces.of(corner.corner.face()).angle(corner.corner.slot());
                FanSector { corner: *corner, start, end: angle }
            };
            sectors.extend(ring.fans().flat_map(|fan| fan.corners).map(sector));
            ends.push(sectors.len() as u32);
            kinds.push(ring.kind(angle, MIN_EXCESS));
        }
        for link_end in mesh.links().iter().flat_map(|link| link.ends) {
            kinds[link_end.index()] = VertexKind::Irregular;
        }
        // An edge without length has no direction.
        for face in &faces.all {
            for slot in (0..3).filter(|slot| face.is_point_like(*slot)) {
                for end in around(slot).map(|end| face.vertices[end]) {
                    kinds[end as usize] = VertexKind::Irregular;
                }
            }
        }
        Self { sectors: Rows::from_offsets(ends, sectors), kinds }
    }

    pub(super) fn kind(&self, vertex: u32) -> VertexKind {
        self.kinds[vertex as usize]
    }

    pub(super) fn around(&self, vertex: u32) -> &[FanSector] {
        self.sectors.row(vertex as usize)
    }

    pub(super) fn max_valence(&self) -> usize {
        (0..self.kinds.len()).map(|v| self.sectors.row(v).len()).max().unwrap_or(0)
    }

    /// The angles, from the fan's first side, between which a path with this arrival may continue; `None` for all.
    pub(super) fn open_angles(&self, vertex: u32, arrival: Arrival) -> Option<[[f64; 2]; 2]> {
        let kind = self.kind(vertex);
        let (VertexKind::Saddle | VertexKind::Boundary, Arrival::Through { corner, sin, cos }) =
            (kind, arrival)
        else {
            return None;
        };
        let fan = self.around(vertex);
        let FanSector { corner: FanCorner { winding, .. }, start, end } =
            *fan.iter().find(|sector| sector.corner.corner == corner)?;
        let angle = fan.last()?.end;
        let within = sin.atan2(cos);
        let at = match winding {
            Winding::Forward => start + within,
            Winding::Backward => end - within,
        };
        let at = at.max(start).min(end);
        Some(match kind {
            VertexKind::Saddle => [[at + PI, at + angle - PI], [at + PI - angle, at - PI]],
            _ => [[at + PI, angle], [0.0, at - PI]],
        })
    }
}
