//! MATLAB 5 files with a surface in the layout of TOSCA: a struct with the fields `X Y Z TRIV`.

mod container;
mod surface;
#[cfg(test)]
pub(super) mod tests;

pub(super) use surface::{check_start, parse};
