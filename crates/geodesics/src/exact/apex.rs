//! What the apex of a face sees through its base.

use super::frame::Frame;
use super::window::Window;

/// A ray that misses the apex by no more than this, in lengths of the base where it crosses it,
/// bends there to meet it. Rounding opens such gaps between windows that share a ray, and opening
/// angles make them wider; the bent path is a path as well, too long by the square of the gap.
const NEAR_MISS: f64 = 1e-6;

/// On which side of the apex the light of a window passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Passes {
    /// Onto the side at the base's start.
    Left,
    /// On both sides.
    Both,
    /// Onto the side at the base's end.
    Right,
}

/// The shortest of the paths to the apex seen so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Apex {
    at: [f64; 2],
    slack: f64,
    /// Index of its window.
    pub(super) nearest: Option<usize>,
    pub(super) distance: f64,
    /// Where it crosses the base.
    pub(super) entry: f64,
    /// Where its last straight stretch comes from.
    from: [f64; 2],
}

impl Apex {
    #[inline]
    pub(super) fn new(frame: &Frame) -> Self {
        Self {
            at: frame.apex,
            slack: NEAR_MISS * frame.base,
            nearest: None,
            distance: f64::INFINITY,
            entry: 0.0,
            from: [0.0; 2],
        }
    }

    /// Where the ray from the window's source to the apex crosses the base, times the height of the
    /// apex over the source, which spares a division.
    #[inline]
    fn scaled_crossing(&self, window: &Window) -> [f64; 2] {
        let [x, y] = self.at;
        [window.x * y + x * window.depth, window.depth + y]
    }

    /// Where the ray from the window's source to the apex crosses the base.
    #[inline]
    pub(super) fn crossing(&self, window: &Window) -> f64 {
        let [scaled, height] = self.scaled_crossing(window);
        scaled / height
    }

    #[inline]
    pub(super) fn passes(&self, window: &Window) -> Passes {
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
    pub(super) fn look_at(&mut self, index: usize, window: &Window) {
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

    /// Sine and cosine, times the same factor, of the angle at the apex between the side to the
    /// base's start and the path.
    pub(super) fn direction(&self) -> [f64; 2] {
        let [x, y] = self.at;
        let [dx, dy] = [self.from[0] - x, self.from[1] - y];
        [y * dx - x * dy, -(x * dx + y * dy)]
    }
}
