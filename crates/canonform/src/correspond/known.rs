//! What is known of a map, from the numbers of the inputs to those of the repaired meshes.

use linalg::Matrix;
use maps::{KnownMap, MapError};
use mesh::Surface;
use surface::VertexId;

use crate::error::Error;

/// What is known of a map, in the numbers of the repaired meshes.
///
/// # Errors
/// [`Error::Point`] for a landmark that a surface does not have; [`Error::Refused`] for an initial map or functions of the
/// wrong length, or that are not finite.
pub(super) fn repaired(
    known: &KnownMap,
    landmarks: &[[VertexId; 2]],
    [a, b]: [&Surface; 2],
) -> Result<KnownMap, Error> {
    let pair = |[x, y]: &[VertexId; 2]| -> Result<[VertexId; 2], Error> {
        Ok([a.repaired_vertex(*x)?, b.repaired_vertex(*y)?])
    };
    let landmarks = landmarks.iter().map(pair).collect::<Result<_, Error>>()?;
    let functions = match &known.functions {
        None => None,
        Some([f, g]) if f.ncols() != g.ncols() => {
            let counts = format!("{} and {}", f.ncols(), g.ncols());
            return Err(Error::refused(format!(
                "{counts} functions were given for the two surfaces; give as many for one as for the other"
            )));
        }
        Some([f, g]) => Some([of_repaired(f, a)?, of_repaired(g, b)?]),
    };
    Ok(KnownMap { landmarks, initial: initial(&known.initial, [a, b])?, functions })
}

/// An error of a map, with landmarks as they were given.
pub(super) fn named(fault: MapError, landmarks: &[[VertexId; 2]]) -> Error {
    match fault {
        MapError::Descriptor(fault) => fault.into(),
        MapError::Contradiction { landmarks: at, how } => {
            Error::ContradictoryLandmarks { pairs: at.map(|i| landmarks[i]), how }
        }
    }
}

fn initial(given: &[Option<VertexId>], [a, b]: [&Surface; 2]) -> Result<Vec<Option<VertexId>>, Error> {
    if given.is_empty() {
        return Ok(Vec::new());
    }
    check_rows("the initial map", given.len(), a)?;
    let mut found = vec![None; a.mesh().n_vertices()];
    for (vertex, partner) in a.input.remap.all_to_new().zip(given) {
        if let (Some(vertex), Some(partner)) = (vertex, partner) {
            // A partner that the repair dropped is as good as none; one that the mesh does not have is a mistake.
            match b.repaired_vertex(*partner) {
                Ok(partner) => found[vertex.index()] = Some(partner),
                Err(mesh::PointError::Dropped { .. }) => {}
                Err(fault) => return Err(fault.into()),
            }
        }
    }
    match found.iter().flatten().count() {
        0 => Err(Error::refused(
            "the initial map gives no vertex a partner; give the number of a vertex of the second mesh for some of them",
        )),
        _ => Ok(found),
    }
}

/// Rows of the input as rows of the repaired mesh.
fn of_repaired(functions: &Matrix, surface: &Surface) -> Result<Matrix, Error> {
    check_rows("a matrix of functions", functions.nrows(), surface)?;
    let rows: Vec<usize> =
        (0..surface.mesh().n_vertices()).map(|v| surface.input_vertex(VertexId::from(v)).index()).collect();
    let found = functions.select_rows(&rows);
    match found.iter().position(|value| !value.is_finite()) {
        None => Ok(found),
        Some(at) => Err(Error::refused(format!(
            "function {} is not finite at vertex {}; give finite numbers",
            at / found.nrows(),
            rows[at % found.nrows()]
        ))),
    }
}

fn check_rows(what: &str, n_rows: usize, surface: &Surface) -> Result<(), Error> {
    match surface.n_input_vertices() {
        n if n == n_rows => Ok(()),
        n => Err(Error::refused(format!(
            "{what} has {n_rows} rows, but the mesh has {n} vertices; give one row for each vertex"
        ))),
    }
}
