//! The numbers of the [metric](crate::ShapeMetric). `cargo run --release -p experiments -- units` measures all of them again.

use crate::boundary::Boundary;
use crate::signature::SignatureKind;

/// Unit and weight of every signature in a fused vector.
///
/// The unit is the root mean square distance between two poses of one body, each triangulated on its own.
///
/// The weight is the separation of the signature times its number of components, divided by the sum of these products
/// over all signatures. The separation is the mean squared distance between two families over that between two poses
/// of one family, as in Fisher's discriminant. The number of components is `tr(C)² / tr(C²)` with `C` the covariance of
/// the values within families: poses move the signature in that many independent ways, so that squared distances
/// would grow with it if the values were whitened.
///
/// Measured on the built-in articulated families, in meshes of 1,500 to 8,000 vertices, and on nothing else. On 2026-11-26 the
/// command printed .245 for the unit of the geodesic spectrum and .256 for that of the wave kernel, and weights within .006.
pub(crate) const FUSED: [(SignatureKind, f64, f64); 4] = [
    (SignatureKind::GeodesicSpectrum, 0.237, 0.07),
    (SignatureKind::ShapeDna, 0.084, 0.248),
    (SignatureKind::HeatKernel, 0.191, 0.204),
    (SignatureKind::WaveKernel, 0.254, 0.478),
];

/// Unit of the spectrum of forms. It has no weight: two bodies of one family differ in it hardly more than two poses of one.
/// Measured as [`FUSED`].
pub(crate) const FORM_SPECTRUM: f64 = 0.144;

/// Unit and weight of aligned forms, measured as [`FUSED`]. The unit is a root mean square distance at unit area; a distance
/// has one component.
pub(crate) const FORM: [f64; 2] = [0.027, 0.0095];

/// Unit and weight of the rigid signature.
///
/// The unit is the root mean square distance between copies of a mechanical part. With the weight, parts of one family are by
/// this signature as far apart, root mean square, as [`SAME_SHAPE`]. Measured on 110 generated parts with four copies each,
/// on which copies are .0011 apart and parts of one family .0281.
pub(crate) const RIGID: [f64; 2] = [0.0011, 0.0018];

/// See [`ShapeMetric::SAME_SHAPE`](crate::ShapeMetric::SAME_SHAPE). Printed by the command on 2026-11-26, for 1,008 creatures of
/// seed 2, nine families of each of 28 plans.
pub(crate) const SAME_SHAPE: Boundary = Boundary { at: 1.118, steepness: 8.92, range: [0.222, 0.874] };

/// See [`ShapeMetric::SAME_CLASS`](crate::ShapeMetric::SAME_CLASS). Printed as [`SAME_SHAPE`].
pub(crate) const SAME_CLASS: Boundary = Boundary { at: 3.73, steepness: 11.33, range: [0.0, 0.993] };
