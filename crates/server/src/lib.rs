//! Shape search over HTTP: a page for people, a JSON interface beneath it.
//!
//! index file -> `canonform::ShapeSearch` -> **server** -> JSON, `view::interactive::Geometry`, pictures, one page
//!
//! ```text
//! request -> guard (host, origin, headers) -> api / page -> work (a bounded number of jobs) -> pipeline
//! ```
//!
//! **Invariants.** The index is only read. No text of a request becomes a path: shapes are looked up by name in the
//! index, and their meshes are read from where the index says. Uploads stay in memory. Whatever is asked, by as many
//! as like, memory and time have limits, see [`ServeOptions`].
//!
//! Knows no numerical code: what is measured, `canonform` measures.

mod api;
mod app;
mod cache;
mod error;
mod formats;
mod guard;
mod measured;
mod options;
mod page;
mod serve;
mod upload;
mod work;

pub use error::ServerError;
pub use options::ServeOptions;
pub use serve::{Server, Stop};
