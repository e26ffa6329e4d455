//! Nearest shapes by combined distance: bounded by signatures, then by aligned forms.

use std::borrow::Borrow;

use descriptors::{PreparedShape, ShapeDistance, ShapeMetric, ShapePair};
use index::VectorTable;
use retrieval::{Neighbor, Refinement, refine_nearest};
use rigid::{Alignment, Reflections, align_points};

use crate::error::Error;

/// What the alignment of a candidate with the query has told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aligned {
    /// Fused distance from the query.
    pub fused: f64,
    /// How far the shapes are apart, regardless of size.
    pub shape_distance: ShapeDistance,
    /// Size of the shape over that of the query.
    pub scale: f64,
    /// Whether the shape is a part of machines, which does not bend.
    pub is_mechanical: bool,
    /// How the form of the query, at unit area, aligns with that of the shape.
    pub alignment: Alignment,
}

/// Lower bounds of the combined distances from a query to all of some fused vectors, in ascending order: the robust distances.
/// They are ordered as far as they are asked for.
pub fn bounds<'a>(query: &'a [f32], all: &'a VectorTable) -> impl Iterator<Item = Neighbor> + Send + 'a {
    let robust = move |vector: &[f32]| ShapeMetric::robust(query, vector);
    all.nearest_first(query, &ShapeMetric::limits(), robust)
}

/// The `k` candidates nearest to a query by [combined](ShapeMetric::combined) distance. Candidates come in ascending
/// order of their [bounds]. `shape` gives the shape of a candidate.
///
/// Forms are aligned only until the bound alone rules out the remaining candidates, so that the result is that of aligning all:
/// the `k` nearest are the first of any larger number of nearest. Alignments run in parallel; the result does not depend on
/// the number of threads.
///
/// # Errors
/// Those of `shape`.
pub fn rerank<S: Borrow<PreparedShape>>(
    query: &PreparedShape,
    candidates: impl IntoIterator<Item = Neighbor>,
    k: usize,
    shape: impl Fn(usize) -> Result<S, Error> + Sync,
) -> Result<Refinement<Aligned>, Error> {
    refine_nearest(candidates, k, |candidate, limit| {
        let shape = shape(candidate.index)?;
        let shape: &PreparedShape = shape.borrow();
        let robust = query.robust(shape);
        let left = ShapeMetric::form_limit(robust, limit);
        let alignment = align_points(&query.unit, &shape.unit, Reflections::Allow);
        if alignment.gap.rms > left {
            return Ok(None);
        }
        let pair = ShapePair::new([query, shape]).with_best(alignment);
        let fused = ShapeMetric::fused(&query.fused, &shape.fused);
        let is_mechanical = !shape.rigid.is_empty();
        let (shape_distance, scale) = (pair.distance(), pair.scale());
        let aligned = Aligned { fused, shape_distance, scale, is_mechanical, alignment };
        Ok(Some((ShapeMetric::combined(robust, alignment.gap.rms), aligned)))
    })
}

#[cfg(test)]
mod tests {
    use descriptors::CanonicalForm;
    use nalgebra::Point3;

    use super::*;

    /// A spiral with this fused vector.
    fn spiral(turns: f64, fused: f64) -> PreparedShape {
        let points: Vec<_> = (0..400)
            .map(|i| f64::from(i) / 400.0)
            .map(|s| Point3::new(3.0 * s, s * (turns * s).cos(), 0.7 * s * (turns * s).sin()))
            .collect();
        let form = CanonicalForm::from_points(points, vec![1.0; 400]).unwrap();
        PreparedShape::new(vec![fused as f32], Vec::new(), &form, None).unwrap()
    }

    #[test]
    fn reranking_finds_what_aligning_all_finds() {
        let turns = |i: usize| 1.0 + 0.2 * i as f64;
        for query in [0, 13] {
            // Informative signatures, and useless ones.
            for usefulness in [1.0, 0.0] {
                let fused = |i: usize| usefulness * 0.05 * (i.abs_diff(query) as f64 + 2.0 * (i % 3) as f64);
                let shapes: Vec<_> = (0..30).map(|i| spiral(turns(i), fused(i))).collect();
                let asked = spiral(turns(query), 0.0);
                let mut all = VectorTable::default();
                shapes.iter().for_each(|shape| all.push("", &shape.fused));
                let candidates: Vec<_> = bounds(&asked.fused, &all).collect();
                let pair = |index: usize| ShapePair::new([&asked, &shapes[index]]);
                let distance = |index: usize| pair(index).distance().combined;
                let mut all: Vec<_> =
                    (0..30).map(|index| Neighbor { index, distance: distance(index) }).collect();
                all.sort_by(Neighbor::by_distance);
                for k in [1, 5, 30] {
                    let found = rerank(&asked, candidates.clone(), k, |i| Ok(&shapes[i])).unwrap();
                    let (nearest, aligned): (Vec<_>, Vec<Aligned>) = found.nearest.into_iter().unzip();
                    assert_eq!(nearest, all[..k], "{query}, {k}");
                    for (Neighbor { index, .. }, found) in nearest.into_iter().zip(aligned) {
                        assert_eq!(
                            (found.shape_distance, found.alignment),
                            (pair(index).distance(), pair(index).best())
                        );
                    }
                    assert!(k < 30 || found.abandoned == 0, "all are wanted");
                    assert!(k == 30 || found.evaluated - found.abandoned < 30);
                }
            }
        }
    }
}
