//! Generated shapes.

use ::datasets::{
    ArticulatedOptions, CreatureOptions, DatasetError, Family, LabeledShape, RestedShape,
    articulated_at_rest, creature_body, creature_plans,
};
use canonform::mesh::TriMesh;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{Rows, faces, positions};
use crate::error::Exception;
use crate::run::run;

/// A shape: name, class, vertices, faces, and the vertices at rest, if the shapes of its family correspond there.
type Generated = (String, String, Rows<f64>, Rows<i64>, Option<Rows<f64>>);

/// The families of articulated shapes, each with its number of shapes, and the plans of creatures, which have as many as you like.
#[pyfunction]
pub(crate) fn families() -> Vec<(&'static str, Option<usize>)> {
    let articulated = articulated_families().map(|family| (family.name(), Some(family.n_shapes())));
    articulated.chain(creature_plans().into_iter().map(|plan| (plan, None))).collect()
}

/// The families of the dataset, and people.
fn articulated_families() -> impl Iterator<Item = Family> {
    Family::all().into_iter().chain([Family::Person])
}

/// Shapes of one of the families, by pose.
#[pyfunction]
pub(crate) fn generate(
    py: Python<'_>,
    family: &str,
    poses: Vec<usize>,
    n_vertices: usize,
    seed: u64,
) -> PyResult<Vec<Generated>> {
    let articulated = articulated_families().find(|known| known.name() == family);
    let plan = creature_plans().iter().position(|plan| *plan == family).unwrap_or_default();
    let n_poses = poses.iter().max().map_or(0, |pose| pose + 1);
    let of_bodies = ArticulatedOptions { seed, n_vertices };
    let of_creatures = CreatureOptions { seed, n_families: plan + 1, n_poses, n_vertices };
    let made = run(py, |observer| {
        observer.begin("shapes", poses.len());
        let shape = |&pose: &usize| {
            let made = match articulated {
                Some(family) => articulated_at_rest(family, 0, pose, &of_bodies, observer)
                    .map(|RestedShape { shape, rest }| (shape, Some(rest))),
                None => creature_body(plan, 0, pose, &of_creatures, observer).map(|shape| (shape, None)),
            };
            if let Err(DatasetError::Exceeded(why)) = made {
                return Err(why.into());
            }
            observer.step();
            Ok(made)
        };
        poses.par_iter().map(shape).collect::<Result<Vec<_>, canonform::Error>>()
    })?;
    let arrays = |made: Result<(LabeledShape, Option<TriMesh>), DatasetError>| {
        let (LabeledShape { name, label, mesh }, rest) =
            made.map_err(|fault| Exception::OptionError.with(fault))?;
        let rest = rest.map(|rest| positions(&rest.positions));
        Ok((name, label, positions(&mesh.positions), faces(&mesh.faces), rest))
    };
    made.into_iter().map(arrays).collect()
}
