//! The surface that a mesh becomes by its repair, and points in the numbers of the input.

mod for_description;
mod locate;
mod point;
mod surface;

pub use self::surface::{InputMap, Surface};
pub use point::{InputPoint, ParsePointError, PointError};
