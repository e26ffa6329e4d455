//! What was measured on generated shapes: 110 mechanical parts of eight families with 660 copies, and 28 families of bodies in 300,
//! 1,000 and 3,400 vertices, each with two poses, three bodies, 11 copies and 6 pieces. `cargo run --release -p experiments --
//! relations` prints the boundary and the shares again.
//! 28 November 2026.

use std::num::NonZero;

use descriptors::Boundary;

/// One surface, by its distance in multiples of what is allowed: 619 copies, 1,081 others.
pub(super) const SAME_SURFACE: Boundary = Boundary { at: 0.93, steepness: 4.35, range: [0.0, 0.998] };

/// A score: the share of 689 pairs called variants that are of one family and not copies.
pub(super) const VARIANT: f64 = 0.999;

/// A score: the share of 168 pairs called a piece and a whole that are.
pub(super) const CUT: f64 = 0.994;

/// What is allowed in copies of one organic surface, root mean square, relative to the size, and how much of the height of the arcs
/// over flat triangles besides. In this proportion, distances of copies and of other bodies overlap least.
pub(super) const ALLOWED: f64 = 0.001;
pub(super) const CHORDS: f64 = 0.35;

/// What noise adds to the distance of other triangles: .5 % of the diagonal is .0054.
pub(super) const NOISE: f64 = 0.006;

/// How far vertices may be apart on which independent noise is the only change, which needs no small distance to be told.
pub(super) const MAX_NOISE: f64 = 0.02;

/// Faces of the coarser of two organic copies whose area may be lost, and how far the rest may be apart in multiples of rounding and arcs.
/// Copies and bodies of which a limb is 2 to 10 % longer, of 18 families in 250 to 5,000 vertices, were told apart by 1, 1.5, 2, 3 and 4
/// faces and multiples of 2.5, 3 and 3.5. With 3 faces, or with 2.5, copies fall below .9; with more, fewer limbs are told.
pub(super) const LOST_FACES: f64 = 4.0;
pub(super) const OUTSIDE: f64 = 3.0;

/// What is allowed everywhere in copies of a mechanical surface, relative to the size: rounding and other diagonals. Half and twice
/// as much change no answer.
pub(super) const EXACT: f64 = 5e-4;

/// Copies of parts that are well aligned differ by at most 1.06 times that and the error of flat triangles, others by at least 5.99
/// times: this is the geometric mean.
pub(super) const PARTS: f64 = 2.5;

/// How far noise takes the farthest of 10,000 vertices, in multiples of its root mean square along one axis, over [`PARTS`]: 4.5 for
/// normal noise, and as much again for what alignments follow.
pub(super) const FARTHEST: f64 = 2.0 * 4.5 / PARTS;

/// The error of flat triangles that counts, in multiples of the height of the arcs over them. The largest of 60 generated parts with
/// circles of 12 to 64 segments, refined and decimated, is .96 (`cargo test -p tests --test laws -- invariants --nocapture`).
/// Half and twice as much change no answer.
pub(super) const ARCS: f64 = 1.5;

/// The systematic offset of a region of a part that is none: rounding and what alignments leave, relative to the size. Copies of 40
/// parts with circles of 20 to 64 segments, refined and decimated, stay below half of it and their arcs.
pub(super) const FLUSH: f64 = 2e-4;

/// Standard errors by which independent noise may shift the mean of a region.
pub(super) const STANDARD_ERRORS: f64 = 4.0;

/// Vertices on which a motion is checked first. Of a piece of another mesh, also the faces that are looked for in it, the candidates for
/// each, and the least number of faces in common. Half and twice as many change no answer about pieces.
/// Of a rim, the vertices that may be one. Of components that differ, those that are aligned with a mesh.
pub(super) const FEW: NonZero<usize> = NonZero::new(24).unwrap();
