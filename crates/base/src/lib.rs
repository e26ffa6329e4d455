//! What every crate may use: limits and progress of long work, and files that are complete or absent. The feature `terminal`
//! adds what programs share: messages, progress bars, threads, interruption, exit codes.

mod budget;
mod cache;
mod content;
pub mod files;
mod observer;
mod random;
#[cfg(feature = "terminal")]
pub mod terminal;
mod text;

pub use budget::{Budget, Exceeded, Meter};
pub use cache::Cache;
pub use content::{ContentHash, ContentHasher};
pub use observer::Observer;
pub use random::SplitMix;
pub use text::{one_line, printable, printable_json, write_line};

/// A value with named fields that is only written, such as an object of JSON. Fields may have attributes of serde.
///
/// ```
/// let n_shapes = 2;
/// let written = canonform_base::object! { n_shapes, path: "all.canonform" };
/// assert_eq!((written.n_shapes, written.path), (2, "all.canonform"));
/// ```
#[macro_export]
macro_rules! object {
    ($($(#[$attribute:meta])* $name:ident $(: $value:expr)?),+ $(,)?) => {{
        #[allow(non_camel_case_types, reason = "the type of a field has its name")]
        mod object {
            #[derive(serde::Serialize)]
            pub(super) struct Object<$($name),+> { $($(#[$attribute])* pub(super) $name: $name),+ }
        }
        object::Object { $($name $(: $value)?),+ }
    }};
}
