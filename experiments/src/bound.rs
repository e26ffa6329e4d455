//! Bounds that an experiment's numbers should keep.

use serde::Deserialize;

use crate::collection::Setting;

/// Bounds on one of an experiment's numbers.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bound {
    /// Name of the number; the module of the experiment lists them.
    pub(crate) value: String,
    pub(crate) at_least: Option<f64>,
    pub(crate) at_most: Option<f64>,
    /// Whether the bounds themselves are excluded.
    #[serde(default)]
    pub(crate) strictly: bool,
    /// Whether this is a goal that is known to be missed.
    #[serde(default)]
    pub(crate) goal: bool,
    /// The collections to which it applies; all known ones if empty.
    #[serde(default)]
    pub(crate) on: Vec<Setting>,
}
