//! What every crate may use: limits and progress of long work, and files that are complete or absent. The feature `terminal`
//! adds what programs share: messages, progress bars, threads, interruption, exit codes.

mod budget;
mod content;
pub mod files;
mod observer;
mod random;
#[cfg(feature = "terminal")]
pub mod terminal;
mod text;

pub use budget::{Budget, Exceeded, Meter};
pub use content::{ContentHash, ContentHasher};
pub use observer::Observer;
pub use random::SplitMix;
pub use text::{one_line, printable, printable_json};
