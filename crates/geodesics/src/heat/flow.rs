//! Heat flow through triangles and links.

use surface::laplacian::Element;
use surface::{Link, Triangle};

/// A longer link, in units, transports heat as if it had this length: a safety limit, so that some heat arrives.
pub(super) const LONGEST_BAR: f64 = 400.0;

/// The same in heat lengths, for short times: `exp(-DEEPEST)` does not underflow.
const DEEPEST: f64 = 600.0;

/// Adds to `b` the integral over the triangle of `X . grad` of the hat function of each corner, `X = -grad u / |grad
/// u|`, lane by lane: its part of `-div X`.
///
/// Only the direction of the gradient is needed, relative to the largest difference: nothing overflows or underflows.
#[inline]
pub(super) fn add_divergence<const K: usize>(element: &Element, u: &[[f64; K]], b: &mut [[f64; K]]) {
    let Triangle { base, x, y } = element.triangle;
    let [i, j, k] = element.vertices.map(|v| v as usize);
    for lane in 0..K {
        let (to_j, to_k) = (u[j][lane] - u[i][lane], u[k][lane] - u[i][lane]);
        let largest = to_j.abs().max(to_k.abs());
        if largest == 0.0 {
            continue;
        }
        let (to_j, to_k) = (to_j / largest, to_k / largest);
        let (along, across) = (y * to_j, base * to_k - x * to_j);
        let length = (along * along + across * across).sqrt();
        if length == 0.0 {
            continue;
        }
        let scale = -0.5 * element.share / length;
        let at_k = scale * base * across;
        let at_j = scale * (y * along - x * across);
        b[k][lane] += at_k;
        b[j][lane] += at_j;
        b[i][lane] -= at_j + at_k;
    }
}

/// A link as a bar between two vertices, one heat length wide.
///
/// Exact for the heat equation in one dimension: heat on it is a sum of `exp(x)` and `exp(-x)`, `x` in heat lengths,
/// and falls along the bar as it does along the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct HeatBar {
    pub(super) ends: [u32; 2],
    length: f64,
    /// `sqrt(t)`.
    heat_length: f64,
    /// The effective length, in heat lengths.
    depth: f64,
}

impl HeatBar {
    pub(super) fn new(link: &Link, heat_length: f64) -> Self {
        let depth = (link.length.min(LONGEST_BAR) / heat_length).min(DEEPEST);
        Self { ends: link.ends.map(|v| v.0), length: link.length, heat_length, depth }
    }

    /// Its entries in `M + t L`: on the diagonal at both ends, and between them.
    pub(super) fn heat(&self) -> [f64; 2] {
        let t = self.heat_length * self.heat_length;
        [t / self.depth.tanh(), -t / self.depth.sinh()]
    }

    /// Its weight in `L`.
    pub(super) fn weight(&self) -> f64 {
        self.heat_length / self.length
    }

    /// Adds to `b` the bar's part of `-div X`, lane by lane: its weight times the difference of the distances of its
    /// ends, the integral of `-sign u'`.
    pub(super) fn add_divergence<const K: usize>(&self, u: &[[f64; K]], b: &mut [[f64; K]]) {
        let [i, j] = self.ends.map(|v| v as usize);
        let lost = (-self.depth).exp();
        for lane in 0..K {
            // Heat is least where the parts that entered at either end are equal.
            let (at_i, at_j) = (u[i][lane], u[j][lane]);
            let (from_i, from_j) = ((at_i - lost * at_j).max(0.0), (at_j - lost * at_i).max(0.0));
            if from_i == from_j {
                continue;
            }
            let rise = (self.length / self.depth * (from_i / from_j).ln()).clamp(-self.length, self.length);
            b[i][lane] -= self.weight() * rise;
            b[j][lane] += self.weight() * rise;
        }
    }
}
