//! The faces around a vertex, and the directions in which a shortest path may leave it.

use std::f64::consts::PI;

use surface::{FanCorner, IntrinsicMesh, OneRing, Rows, VertexId, VertexKind, Winding};

use super::faces::Faces;
use super::front::Arrival;

/// Excess of a total angle, in radians, up to which it is rounding and paths do not bend at a vertex; it affects no
/// distance measurably.
const LEAST_EXCESS: f64 = 1e-12;

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
        let mut fans = Self { sectors: Rows::default(), kinds: Vec::with_capacity(n_vertices) };
        let mut ring = OneRing::default();
        for vertex in (0..n_vertices).map(VertexId::from) {
            ring.collect(topology, vertex);
            let mut angle = 0.0;
            let sector = |corner: &FanCorner| {
                let start = angle;
                angle += faces.of(corner.corner.face()).angle(corner.corner.slot());
                FanSector { corner: *corner, start, end: angle }
            };
            fans.sectors.push_row(ring.fans().flat_map(|fan| fan.corners).map(sector));
            fans.kinds.push(ring.kind(angle, LEAST_EXCESS));
        }
        for link_end in mesh.links().iter().flat_map(|link| link.ends) {
            fans.kinds[link_end.index()] = VertexKind::Irregular;
        }
        // An edge without length has no direction.
        for face in &faces.all {
            for slot in (0..3).filter(|slot| face.is_point_like(*slot)) {
                for end in [1, 2].map(|step| face.vertices[(slot + step) % 3]) {
                    fans.kinds[end as usize] = VertexKind::Irregular;
                }
            }
        }
        fans
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
