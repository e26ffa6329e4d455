//! The record of one shape.

use base::ContentHash;
use serde::{Deserialize, Serialize};

/// Properties of a shape, without its vectors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapeEntry {
    /// Its class; empty if it has none.
    pub label: String,
    /// The file it was read from.
    pub path: String,
    /// Hash of what it was made from.
    pub content: ContentHash,
    /// Named numbers about it, in the order given.
    pub facts: Vec<(String, f64)>,
}

impl ShapeEntry {
    /// The fact of this name, if any.
    #[must_use]
    pub fn fact(&self, name: &str) -> Option<f64> {
        self.facts.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
    }
}

/// The vectors of a shape.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShapeVectors {
    /// The vector that is searched: similar shapes are near in the Euclidean norm. All vectors of an index have the
    /// same length.
    pub fused: Vec<f32>,
    /// Points of its canonical form: `x y z` and weight.
    pub form: Vec<[f32; 4]>,
    /// Areas of geodesic discs around its landmarks, one landmark after the other; empty if they are not known.
    pub disc_areas: Vec<f32>,
    /// The fused vectors of its components but the largest, which are searched on their own.
    pub components: Vec<Vec<f32>>,
    /// Named signatures.
    pub signatures: Vec<(String, Vec<f32>)>,
}

/// A shape in an index.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Its name, unique within an index.
    pub id: String,
    /// Its properties.
    pub entry: ShapeEntry,
    /// Its vectors.
    pub vectors: ShapeVectors,
}

/// Orders shapes at random: the first 64 bits of the hash of a name.
pub(crate) type ShapeKey = u64;

pub(crate) fn shape_key(id: &str) -> ShapeKey {
    ContentHash::of(&[id]).start()
}
