//! Random numbers: one independent stream for every shape.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::trig::rotation;
use nalgebra::Matrix3;

/// The purpose of a stream of random numbers. Each purpose has its own stream, so that for example the number
/// of vertices does not affect poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Purpose {
    /// Angles of joints.
    Pose = 0,
    /// Placement of the lattice from which the surface is extracted.
    Lattice = 1,
    /// Order of vertices and faces.
    Numbering = 2,
    /// Proportions of a body.
    Build = 3,
    /// Damage of a finished mesh.
    Damage = 12,
    /// Points on a surface.
    Scan = 13,
    /// Parameters of mechanical parts.
    Part = 14,
}

/// Families whose streams are numbered together, before those of [`Purpose::Damage`].
const FAMILIES: u64 = 3;

/// A stream of random numbers that depends only on seed, family, pose and purpose.
#[derive(Debug, Clone)]
pub(crate) struct Stream(ChaCha8Rng);

impl Stream {
    pub(crate) fn new(seed: u64, family: usize, pose: usize, purpose: Purpose) -> Self {
        let (group, family) = (family as u64 / FAMILIES, family as u64 % FAMILIES);
        Self::numbered(seed, (group << 62) | ((pose as u64) * 16 + family * 4 + purpose as u64))
    }

    /// The stream of a creature, none of those of [`new`](Self::new).
    pub(crate) fn of_creature(seed: u64, family: usize, pose: usize, purpose: Purpose) -> Self {
        Self::numbered(seed, (1 << 63) | ((family as u64) << 40) | ((pose as u64) * 16 + purpose as u64))
    }

    fn numbered(seed: u64, number: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number);
        Self(rng)
    }

    /// Uniform in `[lo, hi)`.
    pub(crate) fn uniform(&mut self, lo: f64, hi: f64) -> f64 {
        // 53 random bits give a double in [0, 1) exactly.
        let unit = (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        lo + (hi - lo) * unit
    }

    /// Close to normal, with mean 0 and variance 1: the sum of twelve uniform numbers. Logarithms depend on the platform.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform(0.0, 1.0)).sum::<f64>() - 6.0
    }

    /// Uniform in `0..bound`, with a negligible bias of at most `bound / 2^64`.
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        ((u128::from(self.0.next_u64()) * bound as u128) >> 64) as usize
    }

    /// A random permutation of `0..n`.
    pub(crate) fn permutation(&mut self, n: usize) -> Vec<u32> {
        let mut order: Vec<u32> = (0..n as u32).collect();
        for i in (1..n).rev() {
            order.swap(i, self.below(i + 1));
        }
        order
    }

    /// A random rotation, not exactly uniform.
    pub(crate) fn rotation(&mut self) -> Matrix3<f64> {
        let [x, y, z] = [(); 3].map(|()| self.uniform(-180.0, 180.0));
        rotation(x, y, z)
    }
}
