//! The page as people meet it: in a browser, with meshes dropped and chosen, shapes clicked and turned.
//!
//! Pictures of it are left in `target/browser`.

#[cfg(test)]
#[path = "../support/running.rs"]
mod running;
#[cfg(test)]
mod search;
#[cfg(test)]
mod support;
