//! The choice between solvers.

use mesh::IntrinsicMesh;

use crate::{BreadthFirst, Dijkstra, DistanceSolver, FastMarching, FastMarchingOptions};

/// A way of measuring distances on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// [`FastMarching`].
    FastMarching(FastMarchingOptions),
    /// [`Dijkstra`].
    Dijkstra,
    /// [`BreadthFirst`].
    BreadthFirst,
}

impl Default for Method {
    fn default() -> Self {
        Self::FastMarching(FastMarchingOptions::default())
    }
}

impl Method {
    /// The name used on the command line and in records.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::FastMarching(_) => "fast-marching",
            Self::Dijkstra => "dijkstra",
            Self::BreadthFirst => "bfs",
        }
    }

    /// Prepares a surface for this method.
    #[must_use]
    pub fn prepare(self, mesh: &IntrinsicMesh) -> Box<dyn DistanceSolver> {
        match self {
            Self::FastMarching(options) => Box::new(FastMarching::new(mesh, options)),
            Self::Dijkstra => Box::new(Dijkstra::new(mesh)),
            Self::BreadthFirst => Box::new(BreadthFirst::new(mesh)),
        }
    }
}
