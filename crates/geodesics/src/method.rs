//! The choice of a solver.

use budget::Budget;
use surface::IntrinsicMesh;

use crate::breadth_first::BreadthFirst;
use crate::dijkstra::Dijkstra;
use crate::error::GeodesicError;
use crate::exact::Exact;
use crate::fast_marching::{FastMarching, FastMarchingOptions};
use crate::heat::{HeatMethod, HeatOptions};
use crate::solver::DistanceSolver;
use crate::units::InUnits;

/// A solver and its options.
///
/// ```
/// use canonform_geodesics::Method;
/// use mesh::shapes;
/// use surface::VertexId;
///
/// let sphere = shapes::icosphere(2).intrinsic();
/// for method in Method::all() {
///     let solver = method.prepare(&sphere)?;
///     let farthest = solver.distances(VertexId(0))?.into_iter().fold(0.0, f64::max);
///     println!("{:13} {farthest:.3}  {}", method.name(), method.summary());
/// }
/// assert_eq!(Method::named("fast-marching"), Some(Method::default()));
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
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
            Self::Heat(_) => ("heat", "Heat method: smooth, fast for many sources"),
            Self::Exact => ("exact", "Exact on the polyhedral surface"),
            Self::Dijkstra => ("dijkstra", "Shortest paths along edges"),
            Self::BreadthFirst => ("bfs", "Number of edges times the mean edge length"),
        }
    }

    /// Prepares a surface, without limits on time and memory.
    ///
    /// # Errors
    /// Those of [`HeatMethod::new`]; the other methods accept any surface.
    pub fn prepare(self, mesh: &IntrinsicMesh) -> Result<Box<dyn DistanceSolver>, GeodesicError> {
        self.prepare_within(mesh, &Budget::unlimited())
    }

    /// Prepares a surface within a budget, which the solver keeps to as well. A mesh with very short or very long edges
    /// is measured in a [unit](IntrinsicMesh::unit) of its own, so that scale changes no result beyond rounding.
    ///
    /// # Errors
    /// [`GeodesicError::Exceeded`] and those of [`prepare`](Self::prepare).
    pub fn prepare_within(
        self,
        mesh: &IntrinsicMesh,
        budget: &Budget,
    ) -> Result<Box<dyn DistanceSolver>, GeodesicError> {
        budget.check()?;
        let unit = mesh.unit();
        if unit != 1.0 {
            let solver = self.prepare_within(&mesh.in_units_of(unit), budget)?;
            return Ok(Box::new(InUnits { solver, unit }));
        }
        let own = budget.clone();
        let solver: Box<dyn DistanceSolver> = match self {
            Self::FastMarching(options) => Box::new(FastMarching::new(mesh, options).with_budget(own)),
            Self::Heat(options) => Box::new(HeatMethod::within(mesh, options, own)?),
            Self::Exact => Box::new(Exact::new(mesh).with_budget(own)),
            Self::Dijkstra => Box::new(Dijkstra::new(mesh).with_budget(own)),
            Self::BreadthFirst => Box::new(BreadthFirst::new(mesh).with_budget(own)),
        };
        budget.check()?;
        Ok(solver)
    }

    /// Prepares a surface as [`prepare_within`](Self::prepare_within) does. Solvers that do not keep the surface free its
    /// memory as early as they can.
    ///
    /// # Errors
    /// As [`prepare_within`](Self::prepare_within).
    pub fn prepare_owned_within(
        self,
        mesh: IntrinsicMesh,
        budget: &Budget,
    ) -> Result<Box<dyn DistanceSolver>, GeodesicError> {
        budget.check()?;
        match self {
            Self::FastMarching(options) if mesh.unit() == 1.0 => {
                let solver = FastMarching::from_owned(mesh, options).with_budget(budget.clone());
                budget.check()?;
                Ok(Box::new(solver))
            }
            _ => self.prepare_within(&mesh, budget),
        }
    }
}

#[cfg(test)]
mod tests {
    use mesh::shapes::icosphere;

    use super::*;

    #[test]
    fn every_method_has_its_own_name_and_is_found_by_it() {
        for method in Method::all() {
            assert_eq!(Method::named(method.name()), Some(method));
            assert!(!method.summary().is_empty());
        }
        assert_eq!(Method::named("fastest"), None);
    }

    #[test]
    fn bad_options_are_rejected() {
        let frozen = Method::Heat(HeatOptions { time: 0.0 });
        let error = frozen.prepare(&icosphere(1).intrinsic()).unwrap_err();
        assert_eq!(error, GeodesicError::BadHeatTime { time: 0.0 });
    }
}
