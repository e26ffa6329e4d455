//! A surface as its inhabitants know it: connectivity and edge lengths, no coordinates.

use serde::Serialize;

use crate::{EdgeId, Topology, VertexId};

/// A triangle mesh reduced to its intrinsic geometry.
///
/// Everything measured on it is invariant to isometries by construction: two meshes that differ
/// by a rigid motion or by folding along edges give the same `IntrinsicMesh` up to rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct IntrinsicMesh {
    topology: Topology,
    edge_lengths: Vec<f64>,
    links: Vec<Link>,
}

/// A straight connection between two vertices that belongs to no face, for example the bridge
/// between two components.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Link {
    /// The two vertices it joins.
    pub ends: [VertexId; 2],
    /// Its length, in mesh units.
    pub length: f64,
}

impl IntrinsicMesh {
    /// A surface given by connectivity and one length per edge, in the order of
    /// [`Topology::edges`].
    ///
    /// # Panics
    /// When the number of lengths differs from the number of edges, or one is negative or not
    /// finite.
    #[must_use]
    pub fn new(topology: Topology, edge_lengths: Vec<f64>) -> Self {
        assert_eq!(topology.n_edges(), edge_lengths.len(), "one length per edge");
        assert!(
            edge_lengths.iter().all(|l| l.is_finite() && *l >= 0.0),
            "edge lengths are finite and not negative"
        );
        Self { topology, edge_lengths, links: Vec::new() }
    }

    /// The same surface with extra straight connections, such as bridges between components.
    #[must_use]
    pub fn with_links(mut self, links: Vec<Link>) -> Self {
        self.links = links;
        self
    }

    /// The connectivity.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Number of vertices.
    #[must_use]
    pub fn n_vertices(&self) -> usize {
        self.topology.n_vertices()
    }

    /// The length of every edge, in mesh units, in the order of [`Topology::edges`].
    #[must_use]
    pub fn edge_lengths(&self) -> &[f64] {
        &self.edge_lengths
    }

    /// The length of one edge, in mesh units.
    #[inline]
    #[must_use]
    pub fn length(&self, edge: EdgeId) -> f64 {
        self.edge_lengths[edge.index()]
    }

    /// Connections that belong to no face.
    #[must_use]
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Mean length of the edges, in mesh units; zero without edges.
    #[must_use]
    pub fn mean_edge_length(&self) -> f64 {
        match self.edge_lengths.len() {
            0 => 0.0,
            n => self.edge_lengths.iter().sum::<f64>() / n as f64,
        }
    }
}
