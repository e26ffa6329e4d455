//! Paths through the windows at the base of a face to its apex.

use super::bearing::Bearing;
use super::frame::FaceFrame;
use super::window::PathWindow;

/// A ray that misses the apex by no more than this, in lengths of the base where it crosses it, bends there to meet
/// it. Rounding opens such gaps between windows that share a ray, and diverging rays widen them. The bent path is too
/// long by the square of the gap.
const NEAR_MISS: f64 = 1e-6;

/// The side of the apex on which the rays of a window pass: that of the base's start, that of its end, or both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Passes {
    Left,
    Both,
    Right,
}

/// The shortest of the paths to the apex so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Apex {
    at: [f64; 2],
    slack: f64,
    /// Index of its window.
    pub(super) nearest: Option<usize>,
    pub(super) distance: f64,
    /// Where it crosses the base.
    pub(super) entry: f64,
    /// Where its last straight stretch begins.
    from: [f64; 2],
}

impl Apex {
    #[inline]
    pub(super) fn new(frame: &FaceFrame) -> Self {
        Self {
            at: frame.apex,
            slack: NEAR_MISS * frame.base,
            nearest: None,
            distance: f64::INFINITY,
            entry: 0.0,
            from: [0.0; 2],
        }
    }

    /// Where the ray from the window's pseudo-source to the apex crosses the base, times the height of the apex over
    /// the pseudo-source, which saves a division.
    #[inline]
    fn scaled_crossing<D>(&self, window: &PathWindow<D>) -> [f64; 2] {
        let [x, y] = self.at;
        [window.x * y + x * window.depth, window.depth + y]
    }

    /// Where the ray from the window's pseudo-source to the apex crosses the base.
    #[inline]
    pub(super) fn crossing<D>(&self, window: &PathWindow<D>) -> f64 {
        let [scaled, height] = self.scaled_crossing(window);
        scaled / height
    }

    #[inline]
    pub(super) fn passes<D>(&self, window: &PathWindow<D>) -> Passes {
        let [scaled, height] = self.scaled_crossing(window);
        if scaled >= window.end * height {
            Passes::Left
        } else if scaled <= window.start * height {
            Passes::Right
        } else {
            Passes::Both
        }
    }

    /// Considers the path through a window, straight or with a bend at the end of the window.
    #[inline]
    pub(super) fn consider<D: Bearing>(&mut self, index: usize, window: &PathWindow<D>) {
        let [scaled, height] = self.scaled_crossing(window);
        if scaled < (window.start - self.slack) * height || scaled > (window.end + self.slack) * height {
            return;
        }
        let [x, y] = self.at;
        let crossing = scaled / height;
        let entry = crossing.max(window.start).min(window.end);
        let (distance, from) = if entry == crossing {
            let along = x - window.x;
            (window.offset + (along * along + height * height).sqrt(), [window.x, -window.depth])
        } else {
            let along = x - entry;
            (window.distance(entry) + (along * along + y * y).sqrt(), [entry, 0.0])
        };
        if distance < self.distance {
            *self = Self { nearest: Some(index), distance, entry, from, ..*self };
        }
    }

    /// Sine and cosine, up to a common factor, of the angle at the apex between the side to the base's start and the
    /// path.
    pub(super) fn direction(&self) -> [f64; 2] {
        let [x, y] = self.at;
        let [dx, dy] = [self.from[0] - x, self.from[1] - y];
        [y * dx - x * dy, -(x * dx + y * dy)]
    }

    /// The ray from the pseudo-source of its window, along which the path leaves that window.
    pub(super) fn ray<D>(&self, window: &PathWindow<D>) -> [f64; 2] {
        let [x, y] = if self.from[1] < 0.0 { self.at } else { [self.entry, 0.0] };
        [x - window.x, y + window.depth]
    }
}
