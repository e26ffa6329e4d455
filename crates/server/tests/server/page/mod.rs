//! The page in a browser: dropping and choosing meshes, clicking and rotating shapes.

mod duplicates;
mod search;
mod states;
mod support;
