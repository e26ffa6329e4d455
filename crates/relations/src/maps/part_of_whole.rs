//! What a map of a part says of the whole.

use serde::Serialize;

use crate::relation::Side;

/// Which of two mapped surfaces is a part of the other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartOfWhole {
    /// The surface that is a part.
    pub part: Side,
    /// The share of the area of the whole that has partners.
    pub covered: f64,
    /// Whether each vertex of the first surface has a partner. If that is the part, all have.
    #[serde(skip)]
    pub matched: Vec<bool>,
}
