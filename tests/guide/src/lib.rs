//! Runs the commands of the user guide, and compares what they print with what the guide shows.
//!
//! A [`Chapter`] is a page of the guide. Its blocks of code say by their language what happens to them:
//!
//! | block | what is done |
//! |---|---|
//! | ```` ```console ```` | every line that begins with `$ ` is run; what it prints must be what the block shows ([`matches()`]) |
//! | ```` ```sh ```` | run as one script; its output is not shown |
//! | ```` ```sh,norun ```` | not run, because it installs something or needs what a test does not have; checked by words |
//! | ```` ```rust ```` | compiled and run by rustdoc, as part of this crate |
//! | ```` ```python ```` | run by `make test-python` |
//!
//! All blocks of a chapter run in one folder, which is empty at first. A command must succeed, unless it ends with the
//! comment `# exit code N`.

mod block;
mod output;
mod run;

pub use block::{Chapter, CodeBlock, Language};
pub use output::matches;
pub use run::{Ran, Run, run};

/// The snippets of the chapter about the library.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/guide/library.md")]
pub struct Library;
