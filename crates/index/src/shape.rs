//! The record of one shape.

use std::collections::BTreeMap;

use base::ContentHash;
use serde::{Deserialize, Serialize};

/// A shape: what an index stores of it, what a query is, and what is sent between machines.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Shape {
    /// What it is called and where it came from.
    #[serde(flatten)]
    pub entry: Entry,
    /// The vector that is searched: similar shapes are near in the Euclidean norm. All vectors of an index have the same
    /// length.
    pub fused: Vec<f32>,
    /// Signatures by name.
    pub signatures: BTreeMap<String, Vec<f32>>,
    /// Points of its canonical form: `x y z` and weight.
    pub form: Vec<[f32; 4]>,
    /// Areas of geodesic discs around its landmarks, one landmark after the other; empty if they are not known.
    pub disc_areas: Vec<f32>,
    /// The fused vectors of its components but the largest, which are searched on their own.
    pub components: Vec<Vec<f32>>,
}

/// A shape without its vectors, which take most of its bytes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Entry {
    /// Its name, unique within an index.
    pub id: String,
    /// Its class; empty if it has none.
    pub label: String,
    /// The file it was read from.
    pub path: String,
    /// Hash of what it was made from.
    pub content: ContentHash,
    /// What was counted and measured.
    pub facts: Facts,
}

/// What was counted and measured of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Facts {
    /// Vertices of the file.
    pub vertices: u64,
    /// Faces of the file.
    pub faces: u64,
    /// Area of the surface, in squared mesh units.
    pub area: f64,
    /// The largest distance on the surface from one of the samples, in mesh units.
    pub diameter: f64,
    /// The share of the surface that the repair dropped.
    pub dropped_area_share: f64,
    /// Connected components before the repair.
    pub components: u64,
    /// Shortcuts that were cut.
    pub shortcuts: u64,
    /// Length of the longest boundary before holes were closed, in mesh units; 0 for a closed surface.
    pub longest_boundary: f64,
}

impl Facts {
    /// The facts by name, as exports call them.
    pub(crate) fn named(&self) -> [(&'static str, f64); 8] {
        [
            ("vertices", self.vertices as f64),
            ("faces", self.faces as f64),
            ("area", self.area),
            ("diameter", self.diameter),
            ("dropped_area_share", self.dropped_area_share),
            ("components", self.components as f64),
            ("shortcuts", self.shortcuts as f64),
            ("longest_boundary", self.longest_boundary),
        ]
    }
}
