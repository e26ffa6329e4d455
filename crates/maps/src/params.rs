//! What the search for maps costs, and which maps it tells apart. Lengths are shares of the square root of the area.
//!
//! `experiments run matching` measures the maps that follow from these numbers.

/// Most eigenfunctions of each surface, unless the options say otherwise.
pub const EIGENFUNCTIONS: usize = 150;

/// Samples of each surface by which sketches are refined and compared; half as many tell which starts are the same.
pub(crate) const SAMPLES: usize = 400;

/// Eigenfunctions of the last step of a sketch, and half as many of a start.
pub(crate) const FUNCTIONS: usize = 60;

/// Different maps of each orientation that are sketched.
pub(crate) const SKETCHES: usize = 4;

/// Maps whose images are less than this apart on average are one, and 95 % of the landmarks are taken within this of their
/// partners. Points within twice as much are on one limb. Between the distances of people from themselves turned back to front,
/// .06 to .07, and what refinement moves.
pub(crate) const SAME: f64 = 0.06;

/// A map that agrees less with an orientation is a mixture of two, at least in parts. Right maps of built-in shapes have .85 and
/// more, those of cats of 5,000 vertices .79 and more, and most mixtures less.
pub(crate) const PURE: f64 = 0.7;

/// So is one that agrees so much less than another one, or than before its refinement. Refinement changes the agreement by less
/// than .05 otherwise, and right maps of one pair have the same but for .03.
pub(crate) const LOST: f64 = 0.1;

/// A map whose score is this multiple of another one's is clearly worse.
pub(crate) const CLEARLY: f64 = 1.5;

/// The odds that a map is right, and not the next best, are the ratio of their scores to this power. Chosen on built-in people,
/// where the rival of a wrong map scores less than 1.28 times as much, and that of nearly all right ones more: a ratio of 1.28 is
/// where maps become [certain](crate::SurfaceMap::CERTAIN).
pub(crate) const STEEPNESS: f64 = 3.4;
