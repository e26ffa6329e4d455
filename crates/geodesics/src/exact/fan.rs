//! The faces around a vertex, and the directions in which a shortest path may leave it.

use std::f64::consts::PI;

use surface::{CornerId, IntrinsicMesh, Topology, VertexId};

use super::faces::{Surface, next};
use super::front::Arrival;

/// How shortest paths may run through a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bend {
    /// Not at all but straight on, which windows see to.
    Never,
    /// Around an inner vertex with a total angle above a full turn: at least half a turn is left on
    /// either side.
    Inside,
    /// Around a boundary vertex with more than half a turn: at least half a turn is left on the
    /// side of the surface.
    Boundary,
    /// Where faces do not form one fan, where an edge has no length, and at the ends of links.
    Anyhow,
}

/// Excess of a total angle below which a vertex does not bend paths; far below what any distance shows.
const LEAST_EXCESS: f64 = 1e-12;

/// A corner of a fan.
#[derive(Debug, Clone, Copy)]
pub(super) struct FanCorner {
    pub(super) corner: u32,
    pub(super) winding: Winding,
    /// Angles from the fan's first side to the corner's first and to its last.
    pub(super) start: f64,
    pub(super) end: f64,
}

/// Which side of a corner comes first in the fan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Winding {
    /// That to the start of the corner's base.
    Forward,
    /// That to the end of the corner's base.
    Backward,
}

/// The corners around every vertex, in order of angle where they form a fan.
#[derive(Debug)]
pub(super) struct Fans {
    offsets: Vec<u32>,
    corners: Vec<FanCorner>,
    bends: Vec<Bend>,
}

impl Fans {
    pub(super) fn new(mesh: &IntrinsicMesh, surface: &Surface) -> Self {
        let topology = mesh.topology();
        let mut fans = Self {
            offsets: vec![0],
            corners: Vec::with_capacity(3 * topology.n_faces()),
            bends: Vec::with_capacity(topology.n_vertices()),
        };
        for vertex in (0..topology.n_vertices()).map(VertexId::from) {
            let bend = walk(topology, surface, vertex, &mut fans.corners);
            fans.bends.push(bend);
            fans.offsets.push(fans.corners.len() as u32);
        }
        for link_end in mesh.links().iter().flat_map(|link| link.ends) {
            fans.bends[link_end.index()] = Bend::Anyhow;
        }
        for face in &surface.faces {
            for slot in (0..3).filter(|slot| face.is_point_like(*slot)) {
                for end in [next(slot), next(next(slot))] {
                    fans.bends[face.vertices[end] as usize] = Bend::Anyhow;
                }
            }
        }
        fans
    }

    pub(super) fn bend(&self, vertex: u32) -> Bend {
        self.bends[vertex as usize]
    }

    /// The corners at a vertex.
    pub(super) fn around(&self, vertex: u32) -> &[FanCorner] {
        &self.corners[self.offsets[vertex as usize] as usize..self.offsets[vertex as usize + 1] as usize]
    }

    /// The largest number of faces around a vertex.
    pub(super) fn max_valence(&self) -> usize {
        self.offsets.windows(2).map(|w| (w[1] - w[0]) as usize).max().unwrap_or(0)
    }

    /// The angles from the fan's first side between which a shortest path with this arrival may go
    /// on; `None` for all of them.
    pub(super) fn open_angles(&self, vertex: u32, arrival: Arrival) -> Option<[[f64; 2]; 2]> {
        let bend = self.bend(vertex);
        let (Bend::Inside | Bend::Boundary, Arrival::Through { corner, sin, cos }) = (bend, arrival) else {
            return None;
        };
        let fan = self.around(vertex);
        let FanCorner { winding, start, end, .. } = *fan.iter().find(|c| c.corner == corner)?;
        let angle = fan.last()?.end;
        let within = sin.atan2(cos);
        let at = match winding {
            Winding::Forward => start + within,
            Winding::Backward => end - within,
        };
        let at = at.max(start).min(end);
        Some(match bend {
            Bend::Inside => [[at + PI, at + angle - PI], [at + PI - angle, at - PI]],
            _ => [[at + PI, angle], [0.0, at - PI]],
        })
    }
}

/// Appends the corners around a vertex, walking from face to face.
fn walk(topology: &Topology, surface: &Surface, vertex: VertexId, fan: &mut Vec<FanCorner>) -> Bend {
    let corners = topology.vertex_corners(vertex);
    let first = fan.len();
    // A side of a corner lies opposite the face's third corner, which this is for the first side.
    let third = |corner: CornerId, winding: Winding, side: Side| match (winding, side) {
        (Winding::Forward, Side::First) | (Winding::Backward, Side::Last) => corner.prev(),
        (Winding::Forward, Side::Last) | (Winding::Backward, Side::First) => corner.next(),
    };
    let faces_on = |corner| topology.edge_corners(topology.opposite_edge(corner)).len();
    let sides = corners.iter().flat_map(|c| [(*c, Winding::Forward), (*c, Winding::Backward)]);
    let rim = sides.clone().find(|(c, w)| faces_on(third(*c, *w, Side::First)) == 1);
    let mut step = rim.or_else(|| sides.clone().next());
    let mut angle = 0.0;
    let is_fan = loop {
        let Some((corner, winding)) = step else { break true };
        if fan.get(first).is_some_and(|c| c.corner == corner.0) {
            // All around; there may be a second fan at the vertex.
            break fan.len() - first == corners.len();
        }
        let start = angle;
        angle += surface.face(corner.0).angle(corner.slot());
        fan.push(FanCorner { corner: corner.0, winding, start, end: angle });
        let across = third(corner, winding, Side::Last);
        step = topology.opposite(across).map(|far| {
            // The vertex is in one of the two other corners of the far face; the side between it and
            // the corner `far` is not the one shared.
            let at = [far.next(), far.prev()]
                .into_iter()
                .find(|c| topology.corner_vertex(*c) == vertex)
                .unwrap_or(far);
            let winding = if third(at, Winding::Forward, Side::First) == far {
                Winding::Forward
            } else {
                Winding::Backward
            };
            (at, winding)
        });
        if step.is_none() {
            break faces_on(across) == 1 && rim.is_some() && fan.len() - first == corners.len();
        }
    };
    if !is_fan {
        fan.truncate(first);
        let loose = |c: &CornerId| FanCorner { corner: c.0, winding: Winding::Forward, start: 0.0, end: 0.0 };
        fan.extend(corners.iter().map(loose));
        return Bend::Anyhow;
    }
    match rim {
        None if angle > 2.0 * PI + LEAST_EXCESS => Bend::Inside,
        Some(_) if angle > PI + LEAST_EXCESS => Bend::Boundary,
        _ => Bend::Never,
    }
}

/// The sides of a corner in the order of its fan.
#[derive(Debug, Clone, Copy)]
enum Side {
    First,
    Last,
}
