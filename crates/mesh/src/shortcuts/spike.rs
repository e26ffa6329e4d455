//! Vertices that stick out of their surface.

use std::f64::consts::PI;

use nalgebra::Point3;
use surface::{OneRing, Topology, VertexId};

use crate::tri_mesh::TriMesh;

/// The mean of the neighbors of an inner vertex, if its median edge is more than `limit` times as long as the radius of a
/// regular polygon with the median edge around it.
pub(super) fn flattened(mesh: &TriMesh, topology: &Topology, v: VertexId, limit: f64) -> Option<Point3<f64>> {
    let mut ring = OneRing::default();
    ring.collect(topology, v);
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
        let middle = lengths.len() / 2;
        *lengths.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    let spoke = median(&mut around.iter().map(|p| (p - at(v)).norm()));
    let rim = median(&mut around.iter().zip(around.iter().cycle().skip(1)).map(|(p, q)| (p - q).norm()));
    let mean = around.iter().map(|p| p.coords).sum::<nalgebra::Vector3<f64>>() / around.len() as f64;
    let radius = rim / (2.0 * (PI / around.len() as f64).sin());
    (spoke > limit * radius).then(|| Point3::from(mean))
}
