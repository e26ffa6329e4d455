//! The choice between solvers.

use surface::IntrinsicMesh;

use crate::{
    BreadthFirst, Dijkstra, DistanceSolver, Exact, FastMarching, FastMarchingOptions, GeodesicError,
    HeatMethod, HeatOptions,
};

/// A way of measuring distances on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// [`FastMarching`].
    FastMarching(FastMarchingOptions),
    /// [`HeatMethod`].
    Heat(HeatOptions),
    /// [`Exact`].
    Exact,
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
            Self::Heat(_) => "heat",
            Self::Exact => "exact",
            Self::Dijkstra => "dijkstra",
            Self::BreadthFirst => "bfs",
        }
    }

    /// Prepares a surface for this method.
    ///
    /// # Errors
    /// Those of [`HeatMethod::new`]; the other methods take any surface.
    pub fn prepare(self, mesh: &IntrinsicMesh) -> Result<Box<dyn DistanceSolver>, GeodesicError> {
        Ok(match self {
            Self::FastMarching(options) => Box::new(FastMarching::new(mesh, options)),
            Self::Heat(options) => Box::new(HeatMethod::new(mesh, options)?),
            Self::Exact => Box::new(Exact::new(mesh)),
            Self::Dijkstra => Box::new(Dijkstra::new(mesh)),
            Self::BreadthFirst => Box::new(BreadthFirst::new(mesh)),
        })
    }
}

#[cfg(test)]
mod tests {
    use mesh::shapes::icosphere;

    use super::*;

    #[test]
    fn every_method_prepares_or_says_why_not() {
        let mesh = icosphere(1).intrinsic();
        let heat = Method::Heat(HeatOptions::default());
        for method in [Method::default(), heat, Method::Dijkstra, Method::BreadthFirst] {
            assert_eq!(method.prepare(&mesh).unwrap().n_vertices(), 42, "{}", method.name());
        }
        let frozen = Method::Heat(HeatOptions { time: 0.0 });
        assert_eq!(frozen.prepare(&mesh).unwrap_err(), GeodesicError::BadHeatTime { time: 0.0 });
    }
}
