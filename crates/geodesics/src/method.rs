//! The choice of a solver.

use std::borrow::Cow;

use base::Observer;
use surface::IntrinsicMesh;

use crate::dijkstra::Dijkstra;
use crate::error::GeodesicError;
use crate::exact::Exact;
use crate::fast_marching::{FastMarching, FastMarchingOptions};
use crate::heat::{HeatMethod, HeatOptions};
use crate::solver::DistanceSolver;

/// A solver and its options.
///
/// ```
/// use canonform_geodesics::Method;
/// use mesh::shapes;
/// use surface::VertexId;
///
/// let sphere = shapes::icosphere(2).intrinsic();
/// for method in Method::all() {
///     let solver = method.prepare(&sphere, &())?;
///     let farthest = solver.distances(VertexId(0))?.into_iter().fold(0.0, f64::max);
///     println!("{:13} {farthest:.3}", method.name());
/// }
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Method {
    /// [`FastMarching`].
    FastMarching(FastMarchingOptions),
    /// [`HeatMethod`].
    Heat(HeatOptions),
    /// [`Exact`].
    Exact,
    /// [`Dijkstra`].
    Dijkstra,
    /// [`Dijkstra::of_hops`].
    #[serde(rename = "bfs")]
    #[strum(serialize = "bfs")]
    BreadthFirst,
}

impl Default for Method {
    fn default() -> Self {
        Self::FastMarching(FastMarchingOptions::default())
    }
}

impl Method {
    /// All methods with their default options; the default method comes first.
    pub fn all() -> [Self; 5] {
        let heat = Self::Heat(HeatOptions::default());
        [Self::default(), Self::Exact, heat, Self::Dijkstra, Self::BreadthFirst]
    }

    /// The name on the command line and in records.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Prepares a surface. The solver keeps to the budget of the observer, as its preparation does. The memory of a
    /// surface that is given away is free before that of fast marching is needed.
    ///
    /// # Errors
    /// [`GeodesicError::Exceeded`] and those of [`HeatMethod::new`]; the other methods accept any surface.
    pub fn prepare<'a>(
        self,
        mesh: impl Into<Cow<'a, IntrinsicMesh>>,
        observer: &dyn Observer,
    ) -> Result<Box<dyn DistanceSolver>, GeodesicError> {
        let (mesh, budget) = (mesh.into(), observer.budget());
        budget.check()?;
        let solver: Box<dyn DistanceSolver> = match self {
            Self::FastMarching(options) => Box::new(FastMarching::new(mesh, options, observer)),
            Self::Heat(options) => Box::new(HeatMethod::new(&mesh, options, observer)?),
            Self::Exact => Box::new(Exact::new(&mesh, observer)),
            Self::Dijkstra => Box::new(Dijkstra::new(&mesh, observer)),
            Self::BreadthFirst => Box::new(Dijkstra::of_hops(&mesh, observer)),
        };
        budget.check()?;
        Ok(solver)
    }
}
