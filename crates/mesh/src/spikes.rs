//! Vertices that stick out of their surface.

use std::f64::consts::PI;

use nalgebra::Point3;
use surface::{OneRing, Topology, VertexId};

use crate::tri_mesh::TriMesh;

/// Greatest height of a vertex that is no spike: its median edge, relative to the radius of a regular polygon with the
/// median edge around it. On creatures with 3,400 vertices, 99.99 % of the vertices are below 1.5,
/// and the highest at 2.6.
const SPIKE: f64 = 3.0;

/// Greatest share of the area that the faces at a spike cover; a cone by design may have more.
const LARGEST: f64 = 0.03;

/// Rounds of moving spikes back: a spike beside another one may show only when the other is gone.
const N_ROUNDS: usize = 3;

/// The mesh with vertices that stick far out of their surface moved back; `None` if there are none.
///
/// Shot noise displaces single vertices. The edges at such a vertex are much longer than the polygon of its neighbours is
/// wide; at a tip by design, several rings of vertices share the height. The vertex is moved to the mean of its
/// neighbours. Faces with more than 3 % of the area are no spike.
///
/// # Panics
/// If a face has a repeated vertex or one that does not exist, see [`Topology::new`].
///
/// ```
/// use canonform_mesh::{shapes, without_spikes};
///
/// let ball = shapes::icosphere(4);
/// assert!(without_spikes(&ball).is_none());
/// let mut shot = ball.clone();
/// shot.positions[100].coords *= 1.5;
/// let repaired = without_spikes(&shot).unwrap();
/// assert!((repaired.positions[100] - ball.positions[100]).norm() < 0.05);
/// ```
#[must_use]
pub fn without_spikes(mesh: &TriMesh) -> Option<TriMesh> {
    let topology = Topology::new(mesh.n_vertices(), mesh.faces.clone());
    let most = LARGEST * mesh.area();
    let mut repaired: Option<TriMesh> = None;
    for _ in 0..N_ROUNDS {
        let now = repaired.as_ref().unwrap_or(mesh);
        let moved: Vec<(VertexId, Point3<f64>)> = (0..mesh.n_vertices())
            .map(VertexId::from)
            .filter_map(|v| Some((v, flattened(now, &topology, v, SPIKE)?)))
            .filter(|(v, _)| {
                let faces = topology.vertex_corners(*v).iter().map(|corner| corner.face().index());
                faces.map(|face| 0.5 * now.area_vector(face).norm()).sum::<f64>() <= most
            })
            .collect();
        if moved.is_empty() {
            break;
        }
        let mut next = now.clone();
        for (v, position) in moved {
            next.positions[v.index()] = position;
        }
        repaired = Some(next);
    }
    repaired
}

/// The mean of the neighbours of an inner vertex, if its median edge is more than `limit` times as long as the radius of a
/// regular polygon with the median edge around it.
pub(crate) fn flattened(mesh: &TriMesh, topology: &Topology, v: VertexId, limit: f64) -> Option<Point3<f64>> {
    let corners = topology.vertex_corners(v);
    let mut ring = OneRing::default();
    ring.collect(topology, corners);
    let mut fans = ring.fans();
    let only = fans.next().filter(|fan| fan.is_closed)?;
    if fans.next().is_some() {
        return None;
    }
    let at = |v: VertexId| mesh.positions[v.index()];
    let around: Vec<Point3<f64>> =
        only.corners.iter().map(|c| at(topology.corner_vertex(c.opposite_last()))).collect();
    let median = |lengths: &mut dyn Iterator<Item = f64>| {
        let mut lengths: Vec<f64> = lengths.collect();
        lengths.sort_by(f64::total_cmp);
        lengths[lengths.len() / 2]
    };
    let spoke = median(&mut around.iter().map(|p| (p - at(v)).norm()));
    let rim = median(&mut around.iter().zip(around.iter().cycle().skip(1)).map(|(p, q)| (p - q).norm()));
    let mean = around.iter().map(|p| p.coords).sum::<nalgebra::Vector3<f64>>() / around.len() as f64;
    let radius = rim / (2.0 * (PI / around.len() as f64).sin());
    (spoke > limit * radius).then(|| Point3::from(mean))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    #[test]
    fn neighbouring_spikes_are_moved_back() {
        let ball = shapes::icosphere(4);
        let mut shot = ball.clone();
        let near = ball.faces[300];
        near.iter().take(2).for_each(|v| shot.positions[v.index()].coords *= 1.5);
        shot.positions[1500].coords *= 0.3;
        let repaired = without_spikes(&shot).unwrap();
        let gap = |v: usize| (repaired.positions[v] - ball.positions[v]).norm();
        assert!((0..ball.n_vertices()).all(|v| gap(v) < 0.1), "{:?}", near.map(|v| gap(v.index())));
    }

    #[test]
    fn clean_shapes_cones_and_boundaries_stay() {
        // A cone of one ring of faces on a disc.
        let n = 24;
        let mut cone = TriMesh::default();
        cone.positions.extend([Point3::new(0.0, 0.0, 6.0), Point3::origin()]);
        cone.positions.extend((0..n).map(|i| {
            let (sin, cos) = (2.0 * PI * f64::from(i) / f64::from(n)).sin_cos();
            Point3::new(cos, sin, 0.0)
        }));
        for i in 0..n {
            let [a, b] = [i, (i + 1) % n].map(|i| VertexId(i as u32 + 2));
            cone.faces.extend([[a, b, VertexId(0)], [b, a, VertexId(1)]]);
        }
        for mesh in
            [cone, shapes::tetrahedron(0), shapes::cube(1), shapes::grid(6, 6, 1.0), TriMesh::default()]
        {
            assert!(without_spikes(&mesh).is_none());
        }
    }
}
