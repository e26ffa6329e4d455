//! The Rust half of the Python package `canonform`: thin bindings of the crate `canonform`.
//!
//! ```text
//! canonform (Python: arrays of any kind, keyword arguments, pictures) -> _canonform (here) -> canonform (Rust)
//! ```
//!
//! * Every heavy call releases the GIL and ends within a fraction of a second after Ctrl-C, see `run`.
//! * Results come in the vertex order of the input, as NumPy arrays; reports come as the JSON of the command line.
//! * Errors become the exceptions of `canonform.errors`, see `error`.

#![expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]

mod arrays;
mod compare;
mod datasets;
mod error;
mod field;
mod form;
mod index;
mod matching;
mod nystrom;
mod operators;
mod picture;
mod points;
mod record;
mod run;
mod settings;
mod surface;

use pyo3::prelude::*;

#[pymodule(gil_used = false)]
mod _canonform {
    use canonform::descriptors::SignatureKind;
    use canonform::mesh::io::{Content, writable};
    use canonform::settings::{EmbeddingName, Geodesic};
    use pyo3::prelude::*;

    use crate::settings::named;

    #[pymodule_export]
    use crate::{
        compare::{align, compare},
        datasets::{families, generate},
        field::DistanceField,
        form::Form,
        index::{
            Index, agreement, content_hashes, evaluate_matrix, list_folder, merge_answers, merge_indexes,
            query_components, query_of_surface, shortlist,
        },
        matching::{map_basis, map_points, match_surfaces},
        nystrom::{Extension, nystrom},
        operators::{closest_points, eigenbasis, laplacian, log_map},
        picture::{draw, figure, scene_page, scene_scripts},
        run::{begin_call, check_call, end_call, set_threads, threads},
        settings::check_options,
        surface::{Surface, write},
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("DISTANCE_METHODS", named::<Geodesic>())?;
        module.add("EMBEDDING_METHODS", named::<EmbeddingName>())?;
        module.add("SIGNATURE_KINDS", SignatureKind::ALL.map(SignatureKind::name))?;
        module.add("MESH_FORMATS", writable(Content::Mesh).collect::<Vec<_>>())?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
