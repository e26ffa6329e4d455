//! Collections of meshes: folders, archives, Parquet files and lists of paths, with the classes of their shapes.
//!
//! ```
//! use canonform_collection::{Dataset, read_mesh};
//!
//! let folder = tempfile::tempdir()?;
//! for name in ["ball1.off", "ball2.off"] {
//!     mesh_io::write(&folder.path().join(name), &mesh::shapes::icosphere(2))?;
//! }
//! let found = Dataset::read(folder.path(), None)?;
//! assert_eq!((found.shapes[0].name.as_str(), found.shapes[0].label.as_str()), ("ball1", "ball"));
//! assert_eq!(read_mesh(&found.shapes[0].path)?.n_vertices(), 162);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod content;
mod dataset;
mod error;
mod storage;
mod table;

pub use content::{content_hash, content_of};
pub use dataset::*;
pub use error::CollectionError;
pub use storage::*;
pub use table::{Row, TextTable};
