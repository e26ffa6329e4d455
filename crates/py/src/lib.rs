//! The Rust half of the Python package `canonform`: thin bindings of the crate `canonform`.
//!
//! ```text
//! canonform (Python: arrays of any kind, keyword arguments, pictures) -> _canonform (here) -> canonform (Rust)
//! ```
//!
//! * Every heavy call releases the GIL and ends within a fraction of a second after Ctrl-C, see `run`.
//! * Results come in the vertex order of the input, as NumPy arrays; reports come as the JSON of the command line.
//! * Errors become the exceptions of `canonform.errors`, see `error`.

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
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::compare::{align, compare};
    #[pymodule_export]
    use crate::datasets::{families, generate};
    #[pymodule_export]
    use crate::field::DistanceField;
    #[pymodule_export]
    use crate::form::Form;
    #[pymodule_export]
    use crate::index::{
        Index, agreement, content_hashes, evaluate_matrix, list_folder, merge_answers, merge_indexes,
        query_components, query_of_surface, shortlist,
    };
    #[pymodule_export]
    use crate::matching::{map_basis, map_points, match_surfaces};
    #[pymodule_export]
    use crate::nystrom::{Extension, nystrom};
    #[pymodule_export]
    use crate::operators::{closest_points, eigenbasis, laplacian, log_map};
    #[pymodule_export]
    use crate::picture::{draw, figure, scene_page, scene_scripts};
    #[pymodule_export]
    use crate::run::{begin_call, check_call, end_call, set_threads, threads};
    #[pymodule_export]
    use crate::settings::{
        check_options, distance_methods, embedding_methods, mesh_formats, signature_kinds,
    };
    #[pymodule_export]
    use crate::surface::{Surface, write};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
