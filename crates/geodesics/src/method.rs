//! The choice between solvers.

use std::str::FromStr;

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
    /// Every method, each with its default options.
    #[must_use]
    pub fn all() -> [Self; 5] {
        let marching = Self::FastMarching(FastMarchingOptions::default());
        [marching, Self::Exact, Self::Heat(HeatOptions::default()), Self::Dijkstra, Self::BreadthFirst]
    }

    /// One line for help texts.
    #[must_use]
    pub fn summary(self) -> &'static str {
        match self {
            Self::FastMarching(_) => "Fast marching on triangles",
            Self::Heat(_) => "From the flow of heat: smooth, fast for many sources",
            Self::Exact => "Exact on the polyhedral surface",
            Self::Dijkstra => "Shortest paths along edges",
            Self::BreadthFirst => "Number of edges times the mean edge length",
        }
    }

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

impl FromStr for Method {
    type Err = GeodesicError;

    /// The method of this [name](Method::name), with its default options.
    fn from_str(name: &str) -> Result<Self, GeodesicError> {
        let known = || Self::all().map(Self::name).join(", ");
        let found = Self::all().into_iter().find(|method| method.name() == name);
        found.ok_or_else(|| GeodesicError::UnknownName { name: name.to_owned(), known: known() })
    }
}

#[cfg(test)]
mod tests {
    use mesh::shapes::icosphere;

    use super::*;

    #[test]
    fn methods_are_read_by_their_names() {
        for method in Method::all() {
            assert_eq!(method.name().parse(), Ok(method));
        }
        let error = "walking".parse::<Method>().unwrap_err().to_string();
        assert!(error.contains("`walking`") && error.contains("fast-marching, exact"), "{error}");
    }

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
