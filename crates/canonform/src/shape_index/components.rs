//! Describing the components of a mesh.

use base::Budget;
use mesh::TriMesh;

use crate::error::Error;
use crate::form::{DescribeOptions, ShapeDescription, describe};
use mesh::Surface;
use relations::MeshGeometry;

/// Most different components of an indexed mesh that are described, the largest by area.
const MOST: usize = 8;

/// Components of an indexed mesh with a smaller share of its area are not described.
const LEAST_SHARE: f64 = 0.01;

/// A component, described as the shapes of an index are; `None` if it has no description.
pub(super) fn described(
    component: &MeshGeometry,
    options: &DescribeOptions,
    budget: &Budget,
) -> Result<Option<ShapeDescription>, Error> {
    let found = Surface::new(&component.to_mesh(), &options.form.repair, budget)
        .map_err(Error::from)
        .and_then(|surface| describe(&surface, options, budget));
    match found {
        Ok(description) => Ok(Some(description)),
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
        vectors.extend(described(component, options, budget)?.map(|description| description.fused));
    }
    Ok(vectors)
}
