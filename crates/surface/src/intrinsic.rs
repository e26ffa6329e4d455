//! Intrinsic geometry: connectivity and edge lengths, no coordinates.

use std::borrow::Cow;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::ids::{CornerId, EdgeId, VertexId};
use crate::topology::Topology;

/// A triangle mesh reduced to its intrinsic geometry: connectivity and edge lengths.
///
/// All that is computed from it is invariant to isometries: two meshes that differ by a rigid motion, or by folding
/// along edges, have the same `IntrinsicMesh` up to rounding.
///
/// ```
/// use canonform_surface::{CornerId, IntrinsicMesh, Topology, VertexId};
///
/// // A right triangle; edges are sorted by their ends: 0-1, 0-2, 1-2.
/// let topology = Topology::new(3, vec![[0, 1, 2].map(VertexId)]);
/// let mesh = IntrinsicMesh::new(topology, vec![3.0, 4.0, 5.0]);
/// assert_eq!(mesh.mean_edge_length(), 4.0);
/// // The side opposite vertex 0, and those from vertices 1 and 2 to vertex 0.
/// assert_eq!(mesh.sides(CornerId(0)), [5.0, 3.0, 4.0]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct IntrinsicMesh {
    topology: Topology,
    edge_lengths: Vec<f64>,
    links: Vec<Link>,
}

impl<'a> From<&'a IntrinsicMesh> for Cow<'a, IntrinsicMesh> {
    fn from(mesh: &'a IntrinsicMesh) -> Self {
        Cow::Borrowed(mesh)
    }
}

impl From<IntrinsicMesh> for Cow<'_, IntrinsicMesh> {
    fn from(mesh: IntrinsicMesh) -> Self {
        Cow::Owned(mesh)
    }
}

/// Number of edges that one thread measures at a time.
const BLOCK: usize = 4096;

/// A straight connection of two vertices outside all faces, such as a bridge between two components.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Link {
    /// The two vertices that it joins.
    pub ends: [VertexId; 2],
    /// Its length, in mesh units.
    pub length: f64,
}

/// The largest power of two that is not above a length, within the normal range of numbers; 1 for zero.
///
/// ```
/// use canonform_surface::power_of_two_below;
///
/// assert_eq!([0.3, 1.0, 7.9, 0.0].map(power_of_two_below), [0.25, 1.0, 4.0, 1.0]);
/// ```
pub fn power_of_two_below(length: f64) -> f64 {
    /// The bits of the exponent of a number.
    const EXPONENT: u64 = 0x7ff << 52;
    match length.abs() {
        0.0 => 1.0,
        length if length.is_nan() => 1.0,
        // The inverse of either bound is a normal number.
        length => f64::from_bits(length.clamp(f64::MIN_POSITIVE, 2f64.powi(1022)).to_bits() & EXPONENT),
    }
}

/// The unit to measure a computation in whose typical length this is: 1 from 1e-19 to 1e19, where products of several
/// lengths neither overflow nor vanish, otherwise a power of two near it.
///
/// ```
/// use canonform_surface::unit_for;
///
/// assert_eq!(unit_for(0.3), 1.0);
/// assert_eq!(unit_for(3e-100), 2f64.powi(-331));
/// ```
pub fn unit_for(length: f64) -> f64 {
    let ordinary = 2f64.powi(-64)..=2f64.powi(64);
    if ordinary.contains(&length) { 1.0 } else { power_of_two_below(length) }
}

impl IntrinsicMesh {
    /// A surface given by its connectivity and one length per edge, in the order of [`Topology::edges`].
    ///
    /// # Panics
    /// If the number of lengths differs from the number of edges, or a length is negative or not finite.
    pub fn new(topology: Topology, edge_lengths: Vec<f64>) -> Self {
        assert_eq!(topology.n_edges(), edge_lengths.len(), "one length per edge");
        assert!(
            edge_lengths.iter().all(|l| l.is_finite() && *l >= 0.0),
            "edge lengths are finite and not negative"
        );
        Self { topology, edge_lengths, links: Vec::new() }
    }

    /// A surface given by its connectivity and the length of an edge between two vertices, computed in parallel.
    ///
    /// # Panics
    /// If a length is negative or not finite.
    pub fn with_lengths(topology: Topology, length: impl Fn([VertexId; 2]) -> f64 + Sync) -> Self {
        let edges = topology.edges().par_iter().with_min_len(BLOCK);
        let edge_lengths = edges.map(|ends| length(*ends)).collect();
        Self::new(topology, edge_lengths)
    }

    /// The connectivity, without the lengths.
    pub fn into_topology(self) -> Topology {
        self.topology
    }

    /// The same surface with the given links instead of its own.
    #[must_use]
    pub fn with_links(mut self, links: Vec<Link>) -> Self {
        self.links = links;
        self
    }

    /// The connectivity.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.topology.n_vertices()
    }

    /// The length of every edge, in mesh units, in the order of [`Topology::edges`].
    pub fn edge_lengths(&self) -> &[f64] {
        &self.edge_lengths
    }

    /// The length of an edge, in mesh units.
    #[inline]
    pub fn length(&self, edge: EdgeId) -> f64 {
        self.edge_lengths[edge.index()]
    }

    /// The length of the side opposite a corner, in mesh units.
    #[inline]
    pub fn opposite_length(&self, corner: CornerId) -> f64 {
        self.length(self.topology.opposite_edge(corner))
    }

    /// The lengths of the three sides of a corner's face, in mesh units: the side opposite the corner, then those
    /// from the vertices in the next and in the previous corner to the corner's own.
    #[inline]
    pub fn sides(&self, corner: CornerId) -> [f64; 3] {
        [corner, corner.prev(), corner.next()].map(|c| self.opposite_length(c))
    }

    /// Connections outside all faces.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// The unit that lengths are best measured in, see [`unit_for`], in mesh units.
    pub fn unit(&self) -> f64 {
        unit_for(self.mean_edge_length())
    }

    /// The same surface with all lengths divided by `unit`.
    pub fn in_units_of(&self, unit: f64) -> Self {
        Self {
            topology: self.topology.clone(),
            edge_lengths: self.edge_lengths.iter().map(|length| length / unit).collect(),
            links: self.links.iter().map(|link| Link { length: link.length / unit, ..*link }).collect(),
        }
    }

    /// Mean length of the edges, in mesh units; zero without edges.
    pub fn mean_edge_length(&self) -> f64 {
        match self.edge_lengths.len() {
            0 => 0.0,
            n => self.edge_lengths.iter().sum::<f64>() / n as f64,
        }
    }
}
