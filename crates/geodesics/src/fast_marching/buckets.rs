//! Vertices in buckets, by tentative distance.

/// A vertex in no bucket.
pub(super) const NOWHERE: u32 = u32::MAX;
/// A vertex beyond all buckets of the ring.
const BEYOND: u32 = u32::MAX - 1;
/// The last number that a bucket can have.
const LAST: u32 = u32::MAX - 2;

/// The most buckets in the ring.
const MOST_BUCKETS: usize = 1 << 12;
/// Above this number, a bucket is too narrow for the distance it is at.
const TOO_HIGH: u32 = 1 << 31;

/// Buckets become this much narrower or wider at a time. It affects time only, which `make bench` measures.
const FACTOR: f64 = 4.0;
/// They become narrower after this many vertices, plus a share of those in the queue, entered one late.
const LATE: usize = 64;
/// Whether they should become wider is decided after this many buckets, plus a share of the vertices in the queue.
const PERIOD: usize = 256;
/// Divisor for that share: sorting again must cost no more than the work since the last time.
const SHARE: usize = 8;
/// Buckets with less than one vertex in this many should be wider.
const SPARSE: usize = 8;

/// What a queue knows of its vertices: their tentative distances and their buckets.
pub(super) trait Queued {
    fn distance(&self, vertex: u32) -> f64;
    fn bucket(&mut self, vertex: u32) -> &mut u32;
}

/// A bucket queue (Dial 1969, `dial1969`) for distances that are not integers: a bucket may have to be emptied
/// several times (delta-stepping; Meyer and Sanders 2003, `meyer2003`).
///
/// A heap would return vertices in strict order, but the processor can predict hardly any of its comparisons. A
/// vertex that moves to an earlier bucket leaves an entry behind, which is skipped later.
///
/// The width adapts to the mesh: it decreases if a bucket fills repeatedly while it is emptied, and increases if most
/// buckets are empty.
#[derive(Debug, Default)]
pub(super) struct Buckets {
    width: f64,
    per_length: f64,
    /// How far vertices may be ahead of the front, or most of them.
    reach: f64,
    /// The bucket that the front is in.
    current: u32,
    /// Whether nothing has been taken from it yet.
    is_fresh: bool,
    /// Vertices at smaller distances are finalized.
    finalized: f64,
    /// The buckets from the current one on; their number is a power of two.
    ring: Vec<Vec<u32>>,
    /// Number of entries in the ring.
    n_entries: usize,
    /// Vertices in later buckets than those of the ring.
    beyond: Vec<u32>,
    /// The first of these buckets.
    beyond_from: u32,
    /// Vertices while they are sorted into buckets again.
    moving: Vec<u32>,
    /// Vertices that came into the current bucket after it was emptied.
    n_late: usize,
    /// Buckets, and vertices taken from them, since the width was last reconsidered.
    n_buckets: usize,
    n_taken: usize,
}

impl Buckets {
    /// Empties the queue. Buckets are `width` wide at first, and vertices seldom more than
    /// `reach` ahead of the front. Allocates only to grow.
    pub(super) fn reset(&mut self, width: f64, reach: f64) {
        self.ring.iter_mut().for_each(Vec::clear);
        self.beyond.clear();
        (self.n_entries, self.beyond_from) = (0, NOWHERE);
        (self.n_late, self.n_buckets, self.n_taken) = (0, 0, 0);
        (self.current, self.is_fresh, self.finalized) = (0, true, 0.0);
        self.reach = reach;
        self.set_width(width);
    }

    fn set_width(&mut self, width: f64) {
        (self.width, self.per_length) = (width, width.recip());
        let n_buckets =
            ((self.reach / width) as usize).saturating_add(2).min(MOST_BUCKETS).next_power_of_two();
        if n_buckets > self.ring.len() {
            self.ring.resize_with(n_buckets, Vec::new);
        }
    }

    fn start(&self) -> f64 {
        f64::from(self.current) * self.width
    }

    fn end(&self) -> f64 {
        f64::from(self.current + 1) * self.width
    }

    #[inline]
    fn place(&self, bucket: u32) -> usize {
        bucket as usize & (self.ring.len() - 1)
    }

    #[inline]
    fn bucket(&self, distance: f64) -> u32 {
        ((distance * self.per_length) as u32).min(LAST)
    }

    /// Puts a vertex, which is `at` a bucket, into the bucket of this distance, or into the current one if that is later.
    #[inline]
    pub(super) fn put(&mut self, vertex: u32, at: &mut u32, distance: f64) {
        let bucket = self.bucket(distance).max(self.current);
        if *at == bucket {
            return;
        }
        if (bucket - self.current) as usize >= self.ring.len() {
            self.put_beyond(vertex, at, bucket);
            return;
        }
        let place = self.place(bucket);
        *at = bucket;
        self.ring[place].push(vertex);
        self.n_entries += 1;
    }

    #[cold]
    fn put_beyond(&mut self, vertex: u32, at: &mut u32, bucket: u32) {
        if std::mem::replace(at, BEYOND) != BEYOND {
            self.beyond.push(vertex);
        }
        self.beyond_from = self.beyond_from.min(bucket);
    }

    /// Moves all vertices of the first bucket that has any into `round`. Returns the distance below which all
    /// vertices are finalized, or `None` if no vertex is left.
    ///
    /// A vertex that comes into the current bucket after it was emptied is taken in another round. What lies before
    /// the bucket is finalized in its first round, the whole bucket in the others.
    #[inline(never)]
    pub(super) fn next_round(&mut self, round: &mut Vec<u32>, vertices: &mut impl Queued) -> Option<f64> {
        round.clear();
        while round.is_empty() {
            self.fit_width(vertices);
            if self.n_entries == 0 {
                if self.beyond.is_empty() {
                    return None;
                }
                self.go_to(self.beyond_from);
            }
            if self.beyond_from <= self.current {
                self.bring_near(vertices);
            }
            let place = self.place(self.current);
            if self.ring[place].is_empty() {
                self.go_to(self.current + 1);
                continue;
            }
            self.n_entries -= self.ring[place].len();
            for vertex in self.ring[place].drain(..) {
                let bucket = vertices.bucket(vertex);
                if *bucket == self.current {
                    *bucket = NOWHERE;
                    round.push(vertex);
                }
            }
        }
        self.n_taken += round.len();
        let is_first = std::mem::take(&mut self.is_fresh);
        self.n_late += if is_first { 0 } else { round.len() };
        self.finalized = self.finalized.max(if is_first { self.start() } else { self.end() });
        Some(self.finalized)
    }

    fn go_to(&mut self, bucket: u32) {
        self.n_buckets += (bucket - self.current) as usize;
        (self.current, self.is_fresh, self.n_late) = (bucket, true, 0);
    }

    /// Sorts the vertices beyond the ring again.
    #[cold]
    fn bring_near(&mut self, vertices: &mut impl Queued) {
        std::mem::swap(&mut self.beyond, &mut self.moving);
        self.beyond_from = NOWHERE;
        self.moving.retain(|vertex| *vertices.bucket(*vertex) == BEYOND);
        self.put_moving(vertices);
    }

    /// Puts all vertices that are being moved into their buckets.
    fn put_moving(&mut self, vertices: &mut impl Queued) {
        for i in 0..self.moving.len() {
            let vertex = self.moving[i];
            let distance = vertices.distance(vertex);
            let bucket = vertices.bucket(vertex);
            *bucket = NOWHERE;
            self.put(vertex, bucket, distance);
        }
        self.moving.clear();
    }

    /// Makes buckets narrower or wider if that is due.
    #[inline]
    fn fit_width(&mut self, vertices: &mut impl Queued) {
        let share = (self.n_entries + self.beyond.len()) / SHARE;
        let is_too_high = self.current > TOO_HIGH;
        if self.n_late > LATE + share && self.current < TOO_HIGH / FACTOR as u32 {
            self.sort_again(self.width / FACTOR, vertices);
        } else if self.n_buckets > PERIOD + share || is_too_high {
            if self.n_taken < self.n_buckets / SPARSE || is_too_high {
                self.sort_again(self.width * FACTOR, vertices);
            }
            (self.n_buckets, self.n_taken) = (0, 0);
        }
    }

    /// Sorts all vertices into buckets of another width.
    #[cold]
    fn sort_again(&mut self, width: f64, vertices: &mut impl Queued) {
        self.moving.append(&mut self.beyond);
        self.ring.iter_mut().for_each(|bucket| self.moving.append(bucket));
        self.moving.retain(|vertex| std::mem::replace(vertices.bucket(*vertex), NOWHERE) != NOWHERE);
        (self.n_entries, self.beyond_from, self.n_late) = (0, NOWHERE, 0);
        if !self.is_fresh {
            self.finalized = self.finalized.max(self.end());
        }
        self.set_width(width);
        let nearest =
            self.moving.iter().map(|vertex| vertices.distance(*vertex)).fold(f64::INFINITY, f64::min);
        (self.current, self.is_fresh) = (self.bucket(nearest), true);
        self.put_moving(vertices);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertices at given distances.
    struct Vertices {
        distances: Vec<f64>,
        buckets: Vec<u32>,
    }

    impl Vertices {
        fn at(distances: Vec<f64>) -> Self {
            Self { buckets: vec![NOWHERE; distances.len()], distances }
        }

        fn put(&mut self, vertex: u32, distance: f64, queue: &mut Buckets) {
            queue.put(vertex, &mut self.buckets[vertex as usize], distance);
        }
    }

    impl Queued for Vertices {
        fn distance(&self, vertex: u32) -> f64 {
            self.distances[vertex as usize]
        }

        fn bucket(&mut self, vertex: u32) -> &mut u32 {
            &mut self.buckets[vertex as usize]
        }
    }

    /// Takes all vertices out, round by round, with the distance below which all are finalized.
    fn rounds(buckets: &mut Buckets, vertices: &mut Vertices) -> Vec<(f64, Vec<u32>)> {
        let mut round = Vec::new();
        std::iter::from_fn(|| {
            let finalized = buckets.next_round(&mut round, vertices)?;
            Some((finalized, round.clone()))
        })
        .collect()
    }

    #[test]
    fn vertices_come_once_each_bucket_by_bucket() {
        // Far more buckets than the ring has, with long gaps.
        let distances: Vec<f64> = (0..500u32).map(|v| f64::from(v * 7919 % 1013).powi(3) * 0.01).collect();
        let (mut buckets, mut vertices) = (Buckets::default(), Vertices::at(distances.clone()));
        buckets.reset(0.5, 20.0);
        for (v, distance) in (0..).zip(&distances) {
            vertices.put(v, distance + 40.0, &mut buckets);
            vertices.put(v, *distance, &mut buckets);
        }
        let rounds = rounds(&mut buckets, &mut vertices);
        let mut nearest = 0.0;
        for (finalized, round) in &rounds {
            let at = round.iter().map(|v| distances[*v as usize]);
            assert!(at.clone().all(|distance| distance >= nearest && distance >= *finalized));
            nearest = at.fold(0.0, f64::max);
        }
        assert!(rounds.len() > 100, "{} rounds", rounds.len());
        let mut vertices: Vec<u32> = rounds.into_iter().flat_map(|(_, round)| round).collect();
        vertices.sort_unstable();
        assert!(vertices.into_iter().eq(0..500));
    }

    #[test]
    fn late_vertices_come_in_another_round_of_the_same_bucket() {
        let (mut buckets, mut vertices) = (Buckets::default(), Vertices::at(vec![0.0, 2.25, 2.75, 9.0]));
        buckets.reset(1.0, 100.0);
        for v in [0, 1, 3] {
            vertices.put(v, vertices.distance(v), &mut buckets);
        }
        let mut round = Vec::new();
        assert_eq!(buckets.next_round(&mut round, &mut vertices), Some(0.0));
        assert_eq!(buckets.next_round(&mut round, &mut vertices), Some(2.0));
        assert_eq!(round, [1]);
        vertices.put(2, 2.75, &mut buckets);
        vertices.distances[0] = -1.0;
        vertices.put(0, -1.0, &mut buckets);
        assert_eq!(rounds(&mut buckets, &mut vertices), [(3.0, vec![2, 0]), (9.0, vec![3])]);
    }

    #[test]
    fn a_bucket_that_keeps_filling_becomes_narrower() {
        let n = 3000u32;
        let (mut buckets, mut vertices) =
            (Buckets::default(), Vertices::at((0..n).map(|v| f64::from(v) * 1e-3).collect()));
        buckets.reset(1.0, 1.0);
        vertices.put(0, 0.0, &mut buckets);
        let (mut round, mut next, mut before) = (Vec::new(), 0, 0.0);
        while let Some(finalized) = buckets.next_round(&mut round, &mut vertices) {
            assert!(finalized >= before);
            before = finalized;
            for v in &round {
                assert_eq!(*v, next);
                next += 1;
                if next < n {
                    vertices.put(next, vertices.distance(next), &mut buckets);
                }
            }
        }
        assert_eq!(next, n);
        assert!(buckets.width < 0.1, "{}", buckets.width);
    }

    #[test]
    fn a_width_of_zero_gives_a_single_bucket() {
        let mut buckets = Buckets::default();
        for width in [0.0, f64::NAN, 1e-310] {
            let mut vertices = Vertices::at(vec![0.0, 1.0, 2.0]);
            buckets.reset(width, 1.0);
            (0..3).for_each(|v| vertices.put(v, f64::from(v), &mut buckets));
            let n: usize = rounds(&mut buckets, &mut vertices).iter().map(|(_, round)| round.len()).sum();
            assert_eq!(n, 3);
        }
    }
}
