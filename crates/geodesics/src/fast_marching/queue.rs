//! The queue: triangles in buckets, by tentative distance.

use surface::FaceId;

/// A triangle in no bucket.
pub(super) const NOWHERE: u32 = u32::MAX;
/// A triangle beyond all buckets of the ring.
const BEYOND: u32 = u32::MAX - 1;
/// The last number that a bucket can have.
const LAST: u32 = u32::MAX - 2;

/// The most buckets in the ring.
const MAX_BUCKETS: usize = 1 << 12;
/// Above this number, a bucket is too narrow for the distance it is at.
const TOO_HIGH: u32 = 1 << 31;

/// Buckets become this much narrower or wider at a time. It affects time only, which `make bench` measures.
const FACTOR: f64 = 4.0;
/// They become narrower after this many triangles, plus a share of those in the queue, entered one late.
const LATE: usize = 64;
/// Whether they should become wider is decided after this many buckets, plus a share of the triangles in the queue.
const PERIOD: usize = 256;

/// What is known of a triangle at a finite distance.
#[derive(Debug, Clone, Copy)]
#[repr(align(16))]
pub(super) struct Label {
    /// Distance of the virtual source of its window.
    pub(super) offset: f64,
    pub(super) bucket: u32,
    /// While it waits, four times the place of its window, plus the corner opposite the side where that enters.
    pub(super) window: u32,
}

impl Label {
    #[inline(always)]
    pub(super) fn entry(&self) -> usize {
        self.window as usize % 4
    }

    #[inline(always)]
    pub(super) fn place(&self) -> usize {
        self.window as usize / 4
    }
}

/// What is known of all triangles.
#[derive(Debug, Default)]
pub(super) struct Labels {
    /// The distances of the centroids.
    pub(super) distances: Vec<f64>,
    pub(super) labels: Vec<Label>,
}

impl Labels {
    /// Sets the distances of `n` triangles to infinity. Allocates only to grow.
    pub(super) fn reset(&mut self, n: usize) {
        self.distances.clear();
        self.distances.resize(n, f64::INFINITY);
        self.labels.resize(n, Label { offset: 0.0, bucket: NOWHERE, window: 0 });
    }

    #[inline(always)]
    pub(super) fn distance(&self, triangle: FaceId) -> f64 {
        self.distances[triangle.index()]
    }

    #[inline(always)]
    pub(super) fn bucket(&mut self, triangle: FaceId) -> &mut u32 {
        &mut self.labels[triangle.index()].bucket
    }
}
/// Divisor for that share: sorting again must cost no more than the work since the last time.
const SHARE: usize = 8;
/// Buckets with less than one triangle in this many should be wider.
const SPARSE: usize = 8;

/// A bucket queue (Dial 1969, `dial1969`) for distances that are not integers: a bucket may have to be emptied
/// several times (delta-stepping; Meyer and Sanders 2003, `meyer2003`).
///
/// A heap would return triangles in strict order, but the processor can predict hardly any of its comparisons. A
/// triangle that moves to an earlier bucket leaves an entry behind, which is skipped later.
///
/// The width adapts to the mesh: it decreases if a bucket fills repeatedly while it is emptied, and increases if most
/// buckets are empty.
#[derive(Debug, Default)]
pub(super) struct Buckets {
    width: f64,
    per_length: f64,
    /// How far triangles may be ahead of the front, or most of them.
    reach: f64,
    /// The bucket that the front is in.
    current: u32,
    /// Whether nothing has been taken from it yet.
    is_fresh: bool,
    /// The buckets from the current one on; their number is a power of two.
    ring: Vec<Vec<FaceId>>,
    /// Number of entries in the ring.
    n_entries: usize,
    /// Triangles in later buckets than those of the ring.
    beyond: Vec<FaceId>,
    /// The first of these buckets.
    beyond_from: u32,
    /// Triangles while they are sorted into buckets again.
    moving: Vec<FaceId>,
    /// Triangles that came into the current bucket after it was emptied.
    n_late: usize,
    /// Buckets, and triangles taken from them, since the width was last reconsidered.
    n_buckets: usize,
    n_taken: usize,
}

impl Buckets {
    /// Empties the queue. Buckets are `width` wide at first, and triangles seldom more than
    /// `reach` ahead of the front. Allocates only to grow.
    pub(super) fn reset(&mut self, width: f64, reach: f64) {
        self.ring.iter_mut().for_each(Vec::clear);
        self.beyond.clear();
        (self.n_entries, self.beyond_from) = (0, NOWHERE);
        (self.n_late, self.n_buckets, self.n_taken) = (0, 0, 0);
        (self.current, self.is_fresh) = (0, true);
        self.reach = reach;
        self.set_width(width);
    }

    fn set_width(&mut self, width: f64) {
        (self.width, self.per_length) = (width, width.recip());
        let n_buckets =
            ((self.reach / width) as usize).saturating_add(2).min(MAX_BUCKETS).next_power_of_two();
        if n_buckets > self.ring.len() {
            self.ring.resize_with(n_buckets, Vec::new);
        }
    }

    #[inline]
    fn place(&self, bucket: u32) -> usize {
        bucket as usize & (self.ring.len() - 1)
    }

    #[inline]
    fn bucket(&self, distance: f64) -> u32 {
        ((distance * self.per_length) as u32).min(LAST)
    }

    /// Puts a triangle, which is `at` a bucket, into the bucket of this distance, or into the current one if that is later.
    #[inline]
    pub(super) fn put(&mut self, triangle: FaceId, at: &mut u32, distance: f64) {
        let bucket = self.bucket(distance).max(self.current);
        if *at == bucket {
            return;
        }
        if (bucket - self.current) as usize >= self.ring.len() {
            self.put_beyond(triangle, at, bucket);
            return;
        }
        let place = self.place(bucket);
        *at = bucket;
        self.ring[place].push(triangle);
        self.n_entries += 1;
    }

    #[cold]
    fn put_beyond(&mut self, triangle: FaceId, at: &mut u32, bucket: u32) {
        if std::mem::replace(at, BEYOND) != BEYOND {
            self.beyond.push(triangle);
        }
        self.beyond_from = self.beyond_from.min(bucket);
    }

    /// Moves all triangles of the first bucket that has any into `round`. Returns whether any was left.
    ///
    /// A triangle that comes into the current bucket after it was emptied is taken in another round.
    #[inline(never)]
    pub(super) fn next_round(&mut self, round: &mut Vec<FaceId>, triangles: &mut Labels) -> bool {
        round.clear();
        while round.is_empty() {
            self.fit_width(triangles);
            if self.n_entries == 0 {
                if self.beyond.is_empty() {
                    return false;
                }
                self.go_to(self.beyond_from);
            }
            if self.beyond_from <= self.current {
                self.bring_near(triangles);
            }
            let place = self.place(self.current);
            if self.ring[place].is_empty() {
                self.go_to(self.current + 1);
                continue;
            }
            self.n_entries -= self.ring[place].len();
            for triangle in self.ring[place].drain(..) {
                let bucket = triangles.bucket(triangle);
                if *bucket == self.current {
                    *bucket = NOWHERE;
                    round.push(triangle);
                }
            }
        }
        self.n_taken += round.len();
        let is_first = std::mem::take(&mut self.is_fresh);
        self.n_late += if is_first { 0 } else { round.len() };
        true
    }

    fn go_to(&mut self, bucket: u32) {
        self.n_buckets += (bucket - self.current) as usize;
        (self.current, self.is_fresh, self.n_late) = (bucket, true, 0);
    }

    /// Sorts the triangles beyond the ring again.
    #[cold]
    fn bring_near(&mut self, triangles: &mut Labels) {
        std::mem::swap(&mut self.beyond, &mut self.moving);
        self.beyond_from = NOWHERE;
        self.moving.retain(|triangle| *triangles.bucket(*triangle) == BEYOND);
        self.put_moving(triangles);
    }

    /// Puts all triangles that are being moved into their buckets.
    fn put_moving(&mut self, triangles: &mut Labels) {
        for i in 0..self.moving.len() {
            let triangle = self.moving[i];
            let distance = triangles.distance(triangle);
            let bucket = triangles.bucket(triangle);
            *bucket = NOWHERE;
            self.put(triangle, bucket, distance);
        }
        self.moving.clear();
    }

    /// Makes buckets narrower or wider if that is due.
    #[inline]
    fn fit_width(&mut self, triangles: &mut Labels) {
        let share = (self.n_entries + self.beyond.len()) / SHARE;
        let is_too_high = self.current > TOO_HIGH;
        if self.n_late > LATE + share && self.current < TOO_HIGH / FACTOR as u32 {
            self.sort_again(self.width / FACTOR, triangles);
        } else if self.n_buckets > PERIOD + share || is_too_high {
            if self.n_taken < self.n_buckets / SPARSE || is_too_high {
                self.sort_again(self.width * FACTOR, triangles);
            }
            (self.n_buckets, self.n_taken) = (0, 0);
        }
    }

    /// Sorts all triangles into buckets of another width.
    #[cold]
    fn sort_again(&mut self, width: f64, triangles: &mut Labels) {
        self.moving.append(&mut self.beyond);
        self.ring.iter_mut().for_each(|bucket| self.moving.append(bucket));
        self.moving.retain(|triangle| std::mem::replace(triangles.bucket(*triangle), NOWHERE) != NOWHERE);
        (self.n_entries, self.beyond_from, self.n_late) = (0, NOWHERE, 0);
        self.set_width(width);
        let nearest =
            self.moving.iter().map(|triangle| triangles.distance(*triangle)).fold(f64::INFINITY, f64::min);
        (self.current, self.is_fresh) = (self.bucket(nearest), true);
        self.put_moving(triangles);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(triangle: u32, distance: f64, triangles: &mut Labels, queue: &mut Buckets) {
        triangles.distances[triangle as usize] = distance;
        queue.put(FaceId(triangle), triangles.bucket(FaceId(triangle)), distance);
    }

    #[test]
    fn a_bucket_that_keeps_filling_becomes_narrower() {
        let n = 3000u32;
        let (mut buckets, mut triangles) = (Buckets::default(), Labels::default());
        triangles.reset(n as usize);
        buckets.reset(1.0, 1.0);
        put(0, 0.0, &mut triangles, &mut buckets);
        let (mut round, mut next) = (Vec::new(), 0);
        while buckets.next_round(&mut round, &mut triangles) {
            for v in &round {
                assert_eq!(v.0, next);
                next += 1;
                if next < n {
                    put(next, f64::from(next) * 1e-3, &mut triangles, &mut buckets);
                }
            }
        }
        assert_eq!(next, n);
        assert!(buckets.width < 0.1, "{}", buckets.width);
    }
}
