//! Distances between shapes of an index.

use base::Observer;
use descriptors::{ShapeMetric, ShapePair};
use linalg::Matrix;
use rayon::prelude::*;
use serde::Deserialize;

use super::search::ShapeSearch;
use crate::error::Error;

/// Which distance of two shapes is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PairwiseDistance {
    /// By signatures and aligned forms.
    #[default]
    Combined,
    /// By signatures alone, much faster.
    Fused,
}

impl ShapeSearch {
    /// Distances between some shapes and others, a row for each of the first; without others between all pairs of them, as a
    /// symmetric matrix. `observer` counts every pair as a step.
    ///
    /// # Errors
    /// [`Error::Index`] if a shape does not exist, [`Error::Exceeded`].
    pub fn distances(
        &self,
        ids: &[String],
        others: Option<&[String]>,
        kind: PairwiseDistance,
        observer: &dyn Observer,
    ) -> Result<Matrix, Error> {
        let prepared =
            |ids: &[String]| ids.iter().map(|id| self.prepared(id)).collect::<Result<Vec<_>, Error>>();
        let rows = prepared(ids)?;
        let others = others.map(prepared).transpose()?;
        let columns = others.as_ref().unwrap_or(&rows);
        let pairs: Vec<(usize, usize)> = (0..rows.len())
            // Distances of forms are symmetric up to the local minimum that an alignment ends in.
            .flat_map(|i| (if others.is_some() { 0 } else { i }..columns.len()).map(move |j| (i, j)))
            .collect();
        observer.begin("distances", pairs.len());
        let budget = observer.budget();
        let distance = |&(i, j): &(usize, usize)| {
            observer.step();
            budget.check()?;
            let (a, b) = (&rows[i], &columns[j]);
            Ok(match kind {
                PairwiseDistance::Combined => ShapePair::new([a, b]).distance().combined,
                PairwiseDistance::Fused => ShapeMetric::fused(&a.fused, &b.fused),
            })
        };
        let found = pairs.par_iter().map(distance).collect::<Result<Vec<f64>, Error>>()?;
        let mut matrix = Matrix::zeros(rows.len(), columns.len());
        for (&(i, j), distance) in pairs.iter().zip(found) {
            matrix[(i, j)] = distance;
            if others.is_none() {
                matrix[(j, i)] = distance;
            }
        }
        Ok(matrix)
    }
}
