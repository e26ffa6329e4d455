//! Shape search over HTTP: a JSON interface, and a page on top of it.
//!
//! ```text
//! request -> layers (headers, panics, host, origin) -> api / page -> work (a bounded number of jobs) -> canonform::search
//! ```
//!
//! **Invariants.** The index is only read, and opened again when its file changes; no response tells where it lies. No text
//! of a request becomes a path: shapes are looked up by name in the index, which knows the paths of their meshes. Uploads
//! stay in memory. Memory and time are limited for any number of requests, see [`ServeOptions`]: a client that keeps the
//! server waiting is disconnected, and a job that is late or that nobody waits for is cancelled. All numerical work is done
//! by `canonform`.

mod api;
mod app;
mod collection;
mod cost;
mod duplicates;
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
