//! Surfaces and canonical forms for figures.

use anyhow::Result;
use descriptors::CanonicalForm;
use mesh::{TriMesh, orient_consistently};
use report::record::Tile;
use report::viewer::Geometry;
use rigid::{PointSet, Reflections, align_points};

use crate::families::coarse;

/// The greatest number of vertices of a surface in a record, for a page of about 20 MB.
const MOST_VERTICES: usize = 20_000;

/// A tile of a figure, with distances from a vertex as values. A surface of too many vertices is simplified and has none.
pub(crate) fn tile(mesh: &TriMesh, is_form: bool, distances: &[f64], captions: Vec<String>) -> Tile {
    let mut mesh = mesh.clone();
    orient_consistently(&mut mesh);
    let surface = match mesh.n_vertices() > MOST_VERTICES {
        true => Geometry::new(&coarse(&mesh, MOST_VERTICES)),
        false => Geometry::new(&mesh).with_values("distance (mesh units)", distances),
    };
    Tile { captions, is_form, surface }
}

/// A form over the faces of its shape, aligned with `first`; without a first one, it becomes the first.
pub(crate) fn aligned(
    form: &CanonicalForm,
    shape: &TriMesh,
    first: &mut Option<PointSet>,
) -> Result<TriMesh> {
    let mut surface = form.to_mesh(shape);
    let prepared = form.prepared()?;
    if let Some(target) = first {
        let motion = align_points(&prepared, target, Reflections::Allow).map;
        surface.positions.iter_mut().for_each(|p| *p = motion.apply(p));
    } else {
        *first = Some(prepared);
    }
    Ok(surface)
}
