//! The page in a browser: dropping and choosing meshes, clicking and rotating shapes.
//!
//! Screenshots go to `target/browser`.

#[cfg(test)]
#[path = "../support/running.rs"]
mod running;
#[cfg(test)]
mod search;
#[cfg(test)]
mod states;
#[cfg(test)]
mod support;
