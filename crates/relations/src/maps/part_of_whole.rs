//! What a map of a part says of the whole.

use serde::Serialize;
use surface::VertexId;

use crate::relation::Side;

/// Which of two mapped surfaces is a part of the other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartOfWhole {
    /// The surface that is a part.
    pub part: Side,
    /// The share of the area of the whole that has partners.
    pub covered: f64,
    /// For each vertex of the first surface and of the second, its partner on the other, if it has one. All of the part have.
    #[serde(skip)]
    pub partners: [Vec<Option<VertexId>>; 2],
}
