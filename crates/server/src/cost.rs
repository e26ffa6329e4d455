//! What jobs will take, in seconds on two cores.
//!
//! Measured with generated cats of 3,400 and 30,000 vertices and an index of 144 shapes.

use canonform::search::{SearchOptions, SearchRank, n_candidates};

/// To measure and describe an upload: 22 s for a text file of 14 MB with 193,600 vertices, one core.
pub(crate) const UPLOADED_BYTE: f64 = 1.6e-6;

/// To read and measure a shape of the index: 1.1 s for 30,000 vertices.
pub(crate) const MEASURED_VERTEX: f64 = 4e-5;

/// To align two forms of 1,000 points: 0.7 s for 144 of them.
const ALIGNED_FORM: f64 = 5e-3;

/// To see how well a part fits into a shape: 0.45 s for 144 shapes.
const FITTED_SHAPE: f64 = 3e-3;

/// To compare the spectrum of a form with that of a shape: 6 ms for 144 shapes.
const COMPARED_SPECTRUM: f64 = 4e-5;

/// To read a result and align it in space: 0.05 s for 3,400 vertices.
const EXPLAINED_VERTEX: f64 = 1.5e-5;

/// To overlay two measured meshes: 0.05 s for 6,800 vertices.
pub(crate) const COMPARED_VERTEX: f64 = 8e-6;

/// To match two measured meshes: 2.8 s for 6,800 vertices, 19 s for 60,000.
pub(crate) const MATCHED_VERTEX: f64 = 4e-4;

/// To read and draw a mesh: 0.17 s for 30,000 vertices.
pub(crate) const DRAWN_VERTEX: f64 = 5e-6;

/// A search with a described query of so many vertices, among shapes of a mean size. A result is assumed to be as large as
/// the larger of both.
pub(crate) fn of_search(options: &SearchOptions, n_shapes: usize, mean: u64, vertices: u64) -> f64 {
    let measured = vertices as f64 * MEASURED_VERTEX;
    let ranked = match options.rank_by {
        SearchRank::Plain | SearchRank::Graph => 0.0,
        SearchRank::Part => measured + n_shapes as f64 * FITTED_SHAPE,
        SearchRank::Forms => n_shapes as f64 * COMPARED_SPECTRUM,
    };
    let aligned = n_shapes.min(n_candidates(options.k)) as f64 * ALIGNED_FORM;
    let result = ALIGNED_FORM + vertices.max(mean) as f64 * EXPLAINED_VERTEX;
    // The components of the query are measured, too.
    let explained = if options.explain { measured + n_shapes.min(options.k) as f64 * result } else { 0.0 };
    ranked + aligned + explained
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::work::is_long;

    #[test]
    fn long_rankings_and_matches_are_long_jobs() {
        use SearchRank::{Forms, Part, Plain};
        for (rank_by, explain, k, n_shapes, vertices, expected) in [
            (Plain, false, 10, 100_000, 3000, false),
            (Plain, false, 100, 100_000, 3000, true),
            (Part, false, 10, 100, 3000, false),
            (Part, false, 10, 1000, 3000, true),
            (Part, false, 10, 10, 60_000, true),
            (Forms, false, 10, 100_000, 3000, true),
            (Plain, true, 24, 100_000, 30_000, true),
        ] {
            let options = SearchOptions { rank_by, explain, k, ..SearchOptions::default() };
            let cost = of_search(&options, n_shapes, 3000, vertices);
            assert_eq!(is_long(cost), expected, "{options:?}, {n_shapes} shapes, {vertices} vertices");
        }
        for (n, each, expected) in [
            (300, MATCHED_VERTEX, false),
            (6800, MATCHED_VERTEX, true),
            (600_000, DRAWN_VERTEX, true),
            (2_000_000, UPLOADED_BYTE, true),
        ] {
            assert_eq!(is_long(f64::from(n) * each), expected, "{n} of {each} s");
        }
    }
}
