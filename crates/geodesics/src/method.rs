//! The choice between solvers.

use surface::IntrinsicMesh;

use crate::{
    BreadthFirst, Dijkstra, DistanceSolver, Exact, FastMarching, FastMarchingOptions, GeodesicError,
    HeatMethod, HeatOptions,
};

/// A way of measuring distances on a surface.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
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
    #[serde(rename = "bfs")]
    BreadthFirst,
}

impl Default for Method {
    fn default() -> Self {
        Self::FastMarching(FastMarchingOptions::default())
    }
}

impl Method {
    /// All methods with their default options; the default method comes first.
    #[must_use]
    pub fn all() -> [Self; 5] {
        let heat = Self::Heat(HeatOptions::default());
        [Self::default(), Self::Exact, heat, Self::Dijkstra, Self::BreadthFirst]
    }

    /// The method with this [name](Self::name) and default options.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|method| method.name() == name)
    }

    /// The name on the command line and in records.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.entry().0
    }

    /// What the method computes, in one line.
    #[must_use]
    pub fn summary(self) -> &'static str {
        self.entry().1
    }

    fn entry(self) -> (&'static str, &'static str) {
        match self {
            Self::FastMarching(_) => ("fast-marching", "Fast marching on triangles"),
            Self::Heat(_) => ("heat", "From the flow of heat: smooth, fast for many sources"),
            Self::Exact => ("exact", "Exact on the polyhedral surface"),
            Self::Dijkstra => ("dijkstra", "Shortest paths along edges"),
            Self::BreadthFirst => ("bfs", "Number of edges times the mean edge length"),
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
