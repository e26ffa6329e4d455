//! Generated shapes.

use ::datasets::{
    ArticulatedOptions, CreatureOptions, DatasetError, Family, LabeledShape, RestedShape,
    articulated_at_rest, creature_body, creature_plans,
};
use canonform::Observer;
use canonform::mesh::TriMesh;
use numpy::PyArray2;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays;
use crate::error::of_dataset;
use crate::run::run;

/// A shape: name, class, vertices, faces, and the vertices at rest, if the shapes of its family correspond there.
type Generated<'py> =
    (String, String, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i64>>, Option<Bound<'py, PyArray2<f64>>>);

/// The families of articulated shapes, each with its number of shapes, and the plans of creatures.
#[pyfunction]
pub(crate) fn families() -> (Vec<(&'static str, usize)>, Vec<&'static str>) {
    (articulated_families().map(|family| (family.name(), family.n_shapes())).collect(), creature_plans())
}

/// The families of the dataset, and people.
fn articulated_families() -> impl Iterator<Item = Family> {
    Family::all().into_iter().chain([Family::Person])
}

/// Shapes of one of the articulated families, by pose.
#[pyfunction]
pub(crate) fn generate<'py>(
    py: Python<'py>,
    shapes: Vec<(usize, usize)>,
    n_vertices: usize,
    seed: u64,
) -> PyResult<Vec<Generated<'py>>> {
    let options = ArticulatedOptions { seed, n_vertices };
    options.validate().map_err(|fault| of_dataset(&fault))?;
    let families: Vec<Family> = articulated_families().collect();
    made(py, &shapes, |(family, pose), observer| {
        let RestedShape { shape, rest } = articulated_at_rest(families[family], 0, pose, &options, observer)?;
        Ok((shape, Some(rest)))
    })
}

/// Creatures, by family and pose.
#[pyfunction]
pub(crate) fn creatures<'py>(
    py: Python<'py>,
    shapes: Vec<(usize, usize)>,
    n_vertices: usize,
    seed: u64,
) -> PyResult<Vec<Generated<'py>>> {
    let n_families = shapes.iter().map(|(family, _)| family + 1).max().unwrap_or(0);
    let n_poses = shapes.iter().map(|(_, pose)| pose + 1).max().unwrap_or(0);
    let options = CreatureOptions { seed, n_families, n_poses, n_vertices };
    made(py, &shapes, |(family, pose), observer| {
        Ok((creature_body(family, 0, pose, &options, observer)?, None))
    })
}

fn made<'py>(
    py: Python<'py>,
    shapes: &[(usize, usize)],
    make: impl Fn((usize, usize), &dyn Observer) -> Result<(LabeledShape, Option<TriMesh>), DatasetError> + Sync,
) -> PyResult<Vec<Generated<'py>>> {
    let made = run(py, |observer| {
        observer.begin("shapes", shapes.len());
        let of_shape = |shape: &(usize, usize)| {
            let made = match make(*shape, observer) {
                Err(DatasetError::Exceeded(why)) => return Err(why.into()),
                made => made,
            };
            observer.step();
            Ok(made)
        };
        shapes.par_iter().map(of_shape).collect::<Result<Vec<_>, canonform::Error>>()
    })?;
    let arrays = |shape: Result<(LabeledShape, Option<TriMesh>), DatasetError>| {
        let (LabeledShape { name, label, mesh, .. }, rest) = shape.map_err(|fault| of_dataset(&fault))?;
        let rest = rest.map(|rest| arrays::positions(py, &rest.positions)).transpose()?;
        Ok((name, label, arrays::positions(py, &mesh.positions)?, arrays::faces(py, &mesh.faces)?, rest))
    };
    made.into_iter().map(arrays).collect()
}
