//! The page in a browser: dropping and choosing meshes, clicking and rotating shapes.
//!
//! Screenshots go to `target/browser`.

mod duplicates;
mod search;
mod states;
mod support;
