//! A form made ready to be matched with many others.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::Point3;

use crate::bound::Extent;
use crate::spread::spread;
use crate::{Alignment, CanonicalForm, DescriptorError};

/// Below this many points a sample is of no use.
const MIN_SAMPLES: usize = 4;

/// A canonical form in its principal axes with evenly spread samples and a search tree.
pub struct PreparedForm {
    points: Vec<Point3<f64>>,
    samples: Vec<Point3<f64>>,
    extent: Extent,
    axis_spread: [f64; 3],
    to_principal: Alignment,
    tree: ImmutableKdTree<f64, 3>,
    sample_tree: ImmutableKdTree<f64, 3>,
}

/// Which points of a form are searched for a nearest one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Detail {
    /// Its samples.
    Samples,
    /// All of them.
    Points,
}

impl std::fmt::Debug for PreparedForm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PreparedForm")
            .field("n_points", &self.points.len())
            .field("n_samples", &self.samples.len())
            .field("axis_spread", &self.axis_spread)
            .finish_non_exhaustive()
    }
}

impl PreparedForm {
    /// Turns a form into its area-weighted principal axes, so that the triangulation does not
    /// count, and spreads up to `n_samples` of its points evenly by farthest point sampling.
    ///
    /// Cost `O(p n_samples)`.
    ///
    /// # Errors
    /// [`DescriptorError::BadOption`] for fewer than 4 samples.
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
            tree: tree(&points)?,
            sample_tree: tree(&samples)?,
            extent: Extent::new(&samples, spread.covering),
            samples,
            axis_spread,
            points,
            to_principal,
        })
    }

    /// All points, in the principal axes.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Evenly spread points, farthest first: any leading part of them is evenly spread too.
    #[must_use]
    pub fn samples(&self) -> &[Point3<f64>] {
        &self.samples
    }

    /// Standard deviation along each principal axis, descending.
    #[must_use]
    pub fn axis_spread(&self) -> [f64; 3] {
        self.axis_spread
    }

    /// The motion from the form's own coordinates to its principal axes.
    #[must_use]
    pub fn to_principal(&self) -> &Alignment {
        &self.to_principal
    }

    /// Which point of the form is nearest to `query`, in the form's own coordinates, and how far it is.
    #[must_use]
    pub fn nearest_to(&self, query: &Point3<f64>) -> (usize, f64) {
        let query: [f64; 3] = self.to_principal.apply(query).coords.into();
        let hit = self.tree.query(&query).nearest_one::<SquaredEuclidean<f64>>().execute();
        (hit.item as usize, hit.distance.sqrt())
    }

    /// What their root mean square distance is at least, however the forms are aligned.
    #[must_use]
    pub fn least_distance(&self, other: &Self) -> f64 {
        self.extent.least_distance(&other.extent)
    }

    /// The point nearest to `query` and the squared distance to it.
    #[inline]
    pub(crate) fn nearest(&self, query: &Point3<f64>, among: Detail) -> (Point3<f64>, f64) {
        let query: [f64; 3] = query.coords.into();
        let (tree, points) = match among {
            Detail::Samples => (&self.sample_tree, &self.samples),
            Detail::Points => (&self.tree, &self.points),
        };
        let hit = tree.query(&query).nearest_one::<SquaredEuclidean<f64>>().execute();
        (points[hit.item as usize], hit.distance)
    }
}

fn tree(points: &[Point3<f64>]) -> Result<ImmutableKdTree<f64, 3>, DescriptorError> {
    let coordinates: Vec<[f64; 3]> = points.iter().map(|p| p.coords.into()).collect();
    ImmutableKdTree::new_from_slice(&coordinates)
        .map_err(|_| DescriptorError::NoExtent { n_points: points.len() })
}
