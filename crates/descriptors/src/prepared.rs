//! A form prepared to be matched with many others.

use nalgebra::Point3;

use crate::alignment::Alignment;
use crate::bound::Extent;
use crate::canonical_form::CanonicalForm;
use crate::error::DescriptorError;
use crate::nearest::NearestPoints;
use crate::spread::spread;

/// The fewest samples that determine an alignment.
const MIN_SAMPLES: usize = 4;

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
    /// Turns a form into its area-weighted principal axes, which do not depend on the triangulation, and spreads up to
    /// `n_samples` of its points evenly by farthest point sampling. Cost `O(p n_samples)`.
    ///
    /// # Errors
    /// [`DescriptorError::BadOption`] for fewer than 4 samples, [`DescriptorError::NoExtent`].
    pub fn new(form: &CanonicalForm, n_samples: usize) -> Result<Self, DescriptorError> {
        if n_samples < MIN_SAMPLES {
            return Err(DescriptorError::BadOption {
                option: "the number of matched points",
                value: n_samples as f64,
                range: "at least 4",
            });
        }
        let (axes, axis_spread) = form.principal_axes();
        let to_principal = Alignment::about_origin(axes);
        let points: Vec<_> = form.points().iter().map(|p| to_principal.apply(p)).collect();
        let spread = spread(&points, n_samples);
        let samples: Vec<_> = spread.samples.iter().map(|&i| points[i]).collect();
        Ok(Self {
            extent: Extent::new(&samples, spread.covering),
            points: NearestPoints::new(points)?,
            samples: NearestPoints::new(samples)?,
            axis_spread,
            to_principal,
        })
    }

    /// Evenly spread points, farthest first: any leading part of them is evenly spread too.
    pub(crate) fn samples(&self) -> &[Point3<f64>] {
        self.samples.points()
    }

    /// A lower bound of the root mean square distance to another form, over all alignments.
    #[must_use]
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
