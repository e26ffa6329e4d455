//! The record of the retrieval of damaged shapes.

use serde::{Deserialize, Serialize};

/// How far damage moves the shapes of a collection, and whether they are found again.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct InvarianceResults {
    /// Number of shapes in the collection.
    pub n_shapes: usize,
    /// Number of shapes that were damaged.
    pub n_damaged: usize,
    /// Median number of vertices before the damage.
    pub n_vertices: usize,
    /// A shape is unknown if its nearest neighbour is at least this far.
    pub same_class: f64,
    /// The distance at which two shapes are one or not with equal probability.
    pub same_shape: f64,
    /// One entry per damage.
    pub rows: Vec<InvarianceRow>,
}

/// One damage, applied to some shapes of every class. Changes are medians over shapes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InvarianceRow {
    /// What was done.
    pub damage: String,
    /// Whether the surface stays the same up to a motion, a reflection and scale.
    pub keeps_surface: bool,
    /// Change of every signature.
    pub signatures: Vec<SignatureChange>,
    /// Distance of the aligned form from that of the undamaged shape, in its unit.
    pub form: f64,
    /// Combined distance from the undamaged shape.
    pub combined: f64,
    /// The largest combined distance of all shapes.
    pub largest: f64,
    /// The shape with the largest combined distance.
    pub farthest: String,
    /// Share of shapes whose nearest in the undamaged collection has their class.
    pub top1: f64,
    /// The same when the undamaged shape itself is left out.
    pub top1_others: f64,
    /// Share of shapes classified as unknown.
    pub unknown: f64,
    /// Share of shapes whose change is told when they are compared with the undamaged shape; none for damages that have no
    /// relation of their own, and in older records.
    #[serde(default)]
    pub told: Option<f64>,
}

/// Change of a signature by damage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SignatureChange {
    /// Name of the signature.
    pub name: String,
    /// Euclidean distance over the length of the undamaged signature.
    pub relative: f64,
    /// Euclidean distance in the unit of the signature, the distance between two poses of one body.
    pub units: f64,
}
