//! Describing the components of a mesh.

use std::sync::Arc;

use base::{Budget, Observer};
use index::Shape;
use mesh::TriMesh;

use super::found::ComponentResult;
use super::query::Query;
use crate::error::Error;
use crate::form::{DescribeOptions, describe};
use mesh::Surface;
use relations::MeshGeometry;

/// Most different components of an indexed mesh that are described, the largest by area.
const MOST: usize = 8;

/// Components of an indexed mesh with a smaller share of its area are not described.
const LEAST_SHARE: f64 = 0.01;

/// A component, described as the shapes of an index are; `None` if it has no description.
fn described(
    component: &MeshGeometry,
    options: &DescribeOptions,
    budget: &Budget,
) -> Result<Option<Shape>, Error> {
    let found = Surface::new(&component.to_mesh(), &options.form.repair, budget)
        .map_err(Error::from)
        .and_then(|surface| describe(&surface, options, budget));
    match found {
        Ok(shape) => Ok(Some(shape)),
        Err(fault @ Error::Exceeded(_)) => Err(fault),
        Err(_) => Ok(None),
    }
}

/// The fused vectors of the different components of a mesh, but the largest.
pub(super) fn other_components(
    mesh: &TriMesh,
    options: &DescribeOptions,
    budget: &Budget,
) -> Result<Vec<Vec<f32>>, Error> {
    let Some(whole) = MeshGeometry::new(mesh, None) else { return Ok(Vec::new()) };
    let mut vectors = Vec::new();
    for (component, _) in whole.different_components().into_iter().skip(1).take(MOST) {
        if (component.size() / whole.size()).powi(2) < LEAST_SHARE {
            break;
        }
        vectors.extend(described(component, options, budget)?.map(|shape| shape.fused));
    }
    Ok(vectors)
}

/// Most different components of a query that are searched for, the largest by area.
const MOST_SEARCHED: usize = 12;

impl Query {
    /// The different components of a query that comes with its mesh and has several, as queries of their own, largest first, and
    /// what is said of each. Results are to be found for each. One that cannot be described is left out.
    ///
    /// # Errors
    /// [`Error::Exceeded`].
    pub fn components(&self, observer: &dyn Observer) -> Result<Vec<(ComponentResult, Self)>, Error> {
        let whole = self.geometry.as_deref().filter(|_| !self.is_component);
        let options = DescribeOptions::from_text(&self.options);
        let (Some(whole), Some(options)) = (whole, options) else { return Ok(Vec::new()) };
        let budget = observer.budget();
        let mut found = Vec::new();
        for (geometry, copies) in whole.different_components().into_iter().take(MOST_SEARCHED) {
            budget.check()?;
            let Some(shape) = described(geometry, &options, &budget)? else { continue };
            let name = match copies {
                1 => format!("a component of {}", self.name),
                _ => format!("each of {copies} components of {}", self.name),
            };
            let area_share = (geometry.size() / whole.size()).powi(2);
            let about =
                ComponentResult { copies, area_share, n_vertices: geometry.n_vertices(), nearest: None };
            let geometry = MeshGeometry::new(&geometry.to_mesh(), None).map(Arc::new);
            let query = Self::new(shape, &options).named(&name, None);
            found.push((about, Self { geometry, is_component: true, ..query }));
        }
        Ok(found)
    }
}
