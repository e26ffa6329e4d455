//! A form prepared to be aligned with many others.

use nalgebra::Point3;

use crate::alignment::Alignment;
use crate::canonical_form::CanonicalForm;
use crate::error::DescriptorError;
use crate::metric::ShapeMetric;
use crate::nearest::NearestPoints;
use crate::spread::spread;

/// A canonical form in its principal axes, with evenly spread samples and search trees.
#[derive(Debug)]
pub struct PreparedForm {
    points: NearestPoints,
    samples: NearestPoints,
    extent: Extent,
    /// Standard deviation along each principal axis, descending.
    pub(crate) axis_spread: [f64; 3],
    /// The motion from the form's own coordinates to its principal axes.
    pub(crate) to_principal: Alignment,
}

/// The points of a form that are searched for the nearest one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Detail {
    /// Its samples.
    Samples,
    /// All points.
    Points,
}

impl PreparedForm {
    /// Turns a form into its area-weighted principal axes, which do not depend on the triangulation, and spreads
    /// [`ShapeMetric::ALIGNED_POINTS`] of its points evenly by farthest point sampling; fewer if it has no more.
    ///
    /// # Errors
    /// [`DescriptorError::NoExtent`].
    pub fn new(form: &CanonicalForm) -> Result<Self, DescriptorError> {
        let (axes, axis_spread) = form.principal_axes();
        let to_principal = Alignment::about_origin(axes);
        let points: Vec<_> = form.points().iter().map(|p| to_principal.apply(p)).collect();
        let spread = spread(&points, ShapeMetric::ALIGNED_POINTS);
        let samples: Vec<_> = spread.samples.iter().map(|&i| points[i]).collect();
        Ok(Self {
            extent: Extent::new(&samples, spread.covering),
            points: NearestPoints::new(points)?,
            samples: NearestPoints::new(samples)?,
            axis_spread,
            to_principal,
        })
    }

    /// All points, in the principal axes.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        self.points.points()
    }

    /// Evenly spread points, farthest first: any leading part of them is evenly spread too.
    pub(crate) fn samples(&self) -> &[Point3<f64>] {
        self.samples.points()
    }

    /// A lower bound of the root mean square distance to another form, over all alignments.
    pub fn least_distance(&self, other: &Self) -> f64 {
        self.extent.least_distance(&other.extent)
    }

    /// The point nearest to `query` and the squared distance to it.
    #[inline]
    pub(crate) fn nearest(&self, query: &Point3<f64>, among: Detail) -> (Point3<f64>, f64) {
        let among = match among {
            Detail::Samples => &self.samples,
            Detail::Points => &self.points,
        };
        let (i, sq) = among.nearest(query);
        (among.points()[i], sq)
    }
}

/// The extent of a form, which bounds its distance to other forms.
#[derive(Debug, Clone, PartialEq)]
struct Extent {
    /// No two points of the form are farther apart.
    diameter: f64,
    /// Distances between disjoint pairs of samples far from each other, descending.
    spans: Vec<f64>,
    n_samples: usize,
}

impl Extent {
    /// The extent from samples; no point of the form is farther than `covering` from the nearest one.
    fn new(samples: &[Point3<f64>], covering: f64) -> Self {
        let n_samples = samples.len();
        let mut sq_diameter = 0.0f64;
        let mut spans = Vec::with_capacity(n_samples / 2);
        let mut free = vec![true; n_samples];
        for i in 0..n_samples {
            let mut farthest = (0.0, i);
            // Those before are paired already.
            for j in i + 1..n_samples {
                let sq_length = (samples[i] - samples[j]).norm_squared();
                sq_diameter = sq_diameter.max(sq_length);
                if sq_length > farthest.0 && free[j] {
                    farthest = (sq_length, j);
                }
            }
            if free[i] && farthest.1 != i {
                free[farthest.1] = false;
                spans.push(farthest.0.sqrt());
            }
        }
        spans.sort_by(|a, b| b.total_cmp(a));
        Self { diameter: sq_diameter.sqrt() + 2.0 * covering, spans, n_samples }
    }

    /// A lower bound of the root mean square distance between nearest points of two forms, over all motions.
    ///
    /// Let samples `x, x'` of one form have the nearest points `y, y'` of the other, at distances `e, e'`. Then
    /// `e + e' >= |x - x'| - |y - y'| >= |x - x'| - diameter`, so `e² + e'² >= (|x - x'| - diameter)² / 2` if the
    /// difference is positive. Summing over disjoint pairs of samples bounds the sum of all squares.
    fn least_distance(&self, other: &Self) -> f64 {
        (0.5 * (self.beyond(other.diameter) + other.beyond(self.diameter))).sqrt()
    }

    fn beyond(&self, diameter: f64) -> f64 {
        let sq = self.spans.iter().take_while(|span| **span > diameter).map(|span| (span - diameter).powi(2));
        0.5 * sq.sum::<f64>() / self.n_samples.max(1) as f64
    }
}
