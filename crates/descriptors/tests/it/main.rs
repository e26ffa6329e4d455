//! Laws of forms, signatures and the metric.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod boundary;
mod canonical_form;
mod features;
mod metric;
mod partial;
mod quantiles;
mod rigid;
mod sampled_form;
mod shape_pair;
mod spectrum;
