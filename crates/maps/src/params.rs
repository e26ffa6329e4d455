//! What the search for maps may cost, and which maps it tells apart.

/// Parameters of the search for maps. Lengths are shares of the square root of the area.
///
/// `experiments run matching` measures the maps that follow from them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapParams {
    /// Most eigenfunctions of each surface. Default: 150.
    pub eigenfunctions: usize,
    /// Samples of each surface by which sketches are refined and compared; half as many tell which starts are the same.
    /// Default: 400.
    pub samples: usize,
    /// Eigenfunctions of the last step of a sketch, and half as many of a start. Default: 60.
    pub functions: usize,
    /// Different maps of each orientation that are sketched. Default: 4.
    pub sketches: usize,
    /// Maps whose images are less than this apart on average are one, and 95 % of the landmarks are taken within this of their
    /// partners. Points within twice as much are on one limb. Default: 0.06, between the distances of people from themselves
    /// turned back to front, .06 to .07, and what refinement moves.
    pub same: f64,
    /// A map that agrees less with an orientation is a mixture of two, at least in parts. Default: 0.7. Right maps of built-in
    /// shapes have .85 and more, those of cats of 5,000 vertices .79 and more, and most mixtures less.
    pub pure: f64,
    /// So is one that agrees so much less than another one, or than before its refinement. Default: 0.1. Refinement changes the
    /// agreement by less than .05 otherwise, and right maps of one pair have the same but for .03.
    pub lost: f64,
    /// A map whose score is this multiple of another one's is clearly worse. Default: 1.5.
    pub clearly: f64,
    /// The odds that a map is right, and not the next best, are the ratio of their scores to this power. Default: 3.4. Chosen on
    /// built-in people, where the rival of a wrong map scores less than 1.28 times as much, and that of nearly all right ones
    /// more: a ratio of 1.28 is where maps become [certain](crate::SurfaceMap::CERTAIN).
    pub steepness: f64,
}

impl Default for MapParams {
    fn default() -> Self {
        Self {
            eigenfunctions: 150,
            samples: 400,
            functions: 60,
            sketches: 4,
            same: 0.06,
            pure: 0.7,
            lost: 0.1,
            clearly: 1.5,
            steepness: 3.4,
        }
    }
}
