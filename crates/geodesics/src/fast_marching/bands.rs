//! The front: vertices with tentative distances, in bands.

/// A vertex in no band.
const NOWHERE: u32 = u32::MAX;
/// A vertex farther away than all bands of the ring.
const BEYOND: u32 = u32::MAX - 1;
/// The last number that a band can have.
const LAST: u32 = u32::MAX - 2;

/// The most bands in the ring.
const MOST_BANDS: usize = 1 << 12;
/// A band of a higher number has become too narrow for the distance it is at.
const TOO_HIGH: u32 = 1 << 31;

/// Bands become this much narrower or wider at a time.
const FACTOR: f64 = 4.0;
/// Bands become narrower after so many vertices, and a share of those in the ring, have come late into one.
const LATE: usize = 64;
/// Whether they should become wider is looked at after so many bands, and a share of the vertices.
const PERIOD: usize = 256;
/// This share of all vertices: sorting them again must cost no more than what made it necessary.
const SHARE: usize = 8;
/// Bands that hold fewer vertices than one in this many should be wider.
const SPARSE: usize = 8;

/// Vertices in bands of equal width by their tentative distances: a bucket queue (Dial 1969) over distances
/// that are no integers, so that a band may have to be emptied several times (Meyer and Sanders 2003).
///
/// A heap would give them in strict order, but hardly one of its comparisons can be foreseen by the
/// processor. A vertex that comes into a nearer band leaves an entry behind that is passed over later.
///
/// The width follows the mesh: where a band is filled again and again while it is emptied its vertices
/// should have been told apart, and where bands are empty they need not have been.
#[derive(Debug, Default)]
pub(super) struct Bands {
    width: f64,
    per_length: f64,
    /// How far vertices may be ahead of the front, or most of them.
    reach: f64,
    /// The band that the front is in.
    current: u32,
    /// Whether the front has taken nothing from it yet.
    is_fresh: bool,
    /// The front has passed what is nearer than this.
    passed: f64,
    /// The bands from the current one on. Their number is a power of two.
    ring: Vec<Vec<u32>>,
    /// Number of entries in the ring.
    n_entries: usize,
    /// Vertices in bands after those of the ring.
    beyond: Vec<u32>,
    /// The nearest of these bands.
    beyond_from: u32,
    /// Vertices while they are put into bands again.
    moving: Vec<u32>,
    /// The band that every vertex is in.
    bands: Vec<u32>,
    /// Vertices that came into the current band after it was emptied.
    n_late: usize,
    /// Bands, and vertices in them, since the width was last looked at.
    n_bands: usize,
    n_taken: usize,
}

impl Bands {
    /// Forgets everything: `n` vertices in no band. Bands are `width` wide at first, and vertices seldom more
    /// than `reach` ahead of the front. Allocates only to grow.
    pub(super) fn reset(&mut self, n: usize, width: f64, reach: f64) {
        self.ring.iter_mut().for_each(Vec::clear);
        self.beyond.clear();
        self.bands.clear();
        self.bands.resize(n, NOWHERE);
        (self.n_entries, self.beyond_from) = (0, NOWHERE);
        (self.n_late, self.n_bands, self.n_taken) = (0, 0, 0);
        (self.current, self.is_fresh, self.passed) = (0, true, 0.0);
        self.reach = reach;
        self.set_width(width);
    }

    fn set_width(&mut self, width: f64) {
        (self.width, self.per_length) = (width, width.recip());
        let n_bands = ((self.reach / width) as usize).saturating_add(2).min(MOST_BANDS).next_power_of_two();
        if n_bands > self.ring.len() {
            self.ring.resize_with(n_bands, Vec::new);
        }
    }

    /// Where the current band begins.
    fn start(&self) -> f64 {
        f64::from(self.current) * self.width
    }

    /// Where it ends.
    fn end(&self) -> f64 {
        f64::from(self.current + 1) * self.width
    }

    #[inline]
    fn place(&self, band: u32) -> usize {
        band as usize & (self.ring.len() - 1)
    }

    #[inline]
    fn band(&self, distance: f64) -> u32 {
        ((distance * self.per_length) as u32).min(LAST)
    }

    /// Puts a vertex where it belongs at this distance; into the current band if that is behind the front.
    #[inline]
    pub(super) fn put(&mut self, vertex: u32, distance: f64) {
        let band = self.band(distance).max(self.current);
        if self.bands[vertex as usize] == band {
            return;
        }
        if (band - self.current) as usize >= self.ring.len() {
            self.put_beyond(vertex, band);
            return;
        }
        let place = self.place(band);
        self.bands[vertex as usize] = band;
        self.ring[place].push(vertex);
        self.n_entries += 1;
    }

    #[cold]
    fn put_beyond(&mut self, vertex: u32, band: u32) {
        if std::mem::replace(&mut self.bands[vertex as usize], BEYOND) != BEYOND {
            self.beyond.push(vertex);
        }
        self.beyond_from = self.beyond_from.min(band);
    }

    /// Takes all vertices of the nearest band into `round`, and says up to which distance the front has
    /// passed everything; nothing when no vertex is left.
    ///
    /// A vertex may come into the current band after it was emptied, and is taken in another round. The front
    /// has passed what lies before the band in its first round, and the whole band in the others.
    #[inline(never)]
    pub(super) fn next_round(&mut self, round: &mut Vec<u32>, distance: impl Fn(u32) -> f64) -> Option<f64> {
        round.clear();
        while round.is_empty() {
            self.fit_width(&distance);
            if self.n_entries == 0 {
                if self.beyond.is_empty() {
                    return None;
                }
                self.go_to(self.beyond_from);
            }
            if self.beyond_from <= self.current {
                self.bring_near(&distance);
            }
            let place = self.place(self.current);
            if self.ring[place].is_empty() {
                self.go_to(self.current + 1);
                continue;
            }
            self.n_entries -= self.ring[place].len();
            for vertex in self.ring[place].drain(..) {
                let band = &mut self.bands[vertex as usize];
                if *band == self.current {
                    *band = NOWHERE;
                    round.push(vertex);
                }
            }
        }
        self.n_taken += round.len();
        let is_first = std::mem::take(&mut self.is_fresh);
        self.n_late += if is_first { 0 } else { round.len() };
        self.passed = self.passed.max(if is_first { self.start() } else { self.end() });
        Some(self.passed)
    }

    fn go_to(&mut self, band: u32) {
        self.n_bands += (band - self.current) as usize;
        (self.current, self.is_fresh, self.n_late) = (band, true, 0);
    }

    /// Sorts the vertices beyond the ring again.
    #[cold]
    fn bring_near(&mut self, distance: &impl Fn(u32) -> f64) {
        std::mem::swap(&mut self.beyond, &mut self.moving);
        self.beyond_from = NOWHERE;
        let bands = &self.bands;
        self.moving.retain(|vertex| bands[*vertex as usize] == BEYOND);
        self.put_moving(distance);
    }

    /// Puts all vertices that are being moved where they belong.
    fn put_moving(&mut self, distance: &impl Fn(u32) -> f64) {
        for i in 0..self.moving.len() {
            let vertex = self.moving[i];
            self.bands[vertex as usize] = NOWHERE;
            self.put(vertex, distance(vertex));
        }
        self.moving.clear();
    }

    /// Makes bands narrower or wider if that is due.
    #[inline]
    fn fit_width(&mut self, distance: &impl Fn(u32) -> f64) {
        let share = self.n_entries / SHARE;
        let is_too_high = self.current > TOO_HIGH;
        if self.n_late > LATE + share && self.current < TOO_HIGH / FACTOR as u32 {
            self.sort_again(self.width / FACTOR, distance);
        } else if self.n_bands > PERIOD + share || is_too_high {
            if self.n_taken < self.n_bands / SPARSE || is_too_high {
                self.sort_again(self.width * FACTOR, distance);
            }
            (self.n_bands, self.n_taken) = (0, 0);
        }
    }

    /// Puts all vertices into bands of another width.
    #[cold]
    fn sort_again(&mut self, width: f64, distance: &impl Fn(u32) -> f64) {
        self.moving.append(&mut self.beyond);
        self.ring.iter_mut().for_each(|band| self.moving.append(band));
        let bands = &mut self.bands;
        self.moving.retain(|vertex| std::mem::replace(&mut bands[*vertex as usize], NOWHERE) != NOWHERE);
        (self.n_entries, self.beyond_from, self.n_late) = (0, NOWHERE, 0);
        if !self.is_fresh {
            self.passed = self.passed.max(self.end());
        }
        self.set_width(width);
        let nearest = self.moving.iter().map(|vertex| distance(*vertex)).fold(f64::INFINITY, f64::min);
        (self.current, self.is_fresh) = (self.band(nearest), true);
        self.put_moving(distance);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Takes everything out, round by round, with what had been passed.
    fn rounds(bands: &mut Bands, distances: &[f64]) -> Vec<(f64, Vec<u32>)> {
        let mut round = Vec::new();
        std::iter::from_fn(|| {
            let passed = bands.next_round(&mut round, |v| distances[v as usize])?;
            Some((passed, round.clone()))
        })
        .collect()
    }

    #[test]
    fn vertices_come_band_by_band_and_each_once() {
        // Far more bands than the ring has, some of them empty for long.
        let distances: Vec<f64> = (0..500u32).map(|v| f64::from(v * 7919 % 1013).powi(3) * 0.01).collect();
        let mut bands = Bands::default();
        bands.reset(distances.len(), 0.5, 20.0);
        for (v, distance) in distances.iter().enumerate() {
            bands.put(v as u32, distance + 40.0);
            bands.put(v as u32, *distance);
        }
        let rounds = rounds(&mut bands, &distances);
        let mut nearest = 0.0;
        for (passed, round) in &rounds {
            let at = round.iter().map(|v| distances[*v as usize]);
            assert!(at.clone().all(|distance| distance >= nearest && distance >= *passed));
            nearest = at.fold(0.0, f64::max);
        }
        assert!(rounds.len() > 100, "{} rounds", rounds.len());
        let mut vertices: Vec<u32> = rounds.into_iter().flat_map(|(_, round)| round).collect();
        vertices.sort_unstable();
        assert!(vertices.into_iter().eq(0..500));
    }

    #[test]
    fn what_comes_late_is_in_another_round_of_the_current_band() {
        let mut distances = [0.0, 2.25, 2.75, 9.0];
        let mut bands = Bands::default();
        bands.reset(4, 1.0, 100.0);
        for v in [0, 1, 3] {
            bands.put(v, distances[v as usize]);
        }
        let mut round = Vec::new();
        assert_eq!(bands.next_round(&mut round, |_| 0.0), Some(0.0));
        assert_eq!(bands.next_round(&mut round, |_| 0.0), Some(2.0));
        assert_eq!(round, [1]);
        bands.put(2, 2.75);
        distances[0] = -1.0;
        bands.put(0, distances[0]);
        assert_eq!(rounds(&mut bands, &distances), [(3.0, vec![2, 0]), (9.0, vec![3])]);
    }

    #[test]
    fn a_band_that_fills_again_and_again_becomes_narrower() {
        let (n, step) = (3000u32, 1e-3);
        let mut bands = Bands::default();
        bands.reset(n as usize, 1.0, 1.0);
        bands.put(0, 0.0);
        let (mut round, mut next, mut before) = (Vec::new(), 0, 0.0);
        while let Some(passed) = bands.next_round(&mut round, |v| f64::from(v) * step) {
            assert!(passed >= before);
            before = passed;
            for v in &round {
                assert_eq!(*v, next);
                next += 1;
                if next < n {
                    bands.put(next, f64::from(next) * step);
                }
            }
        }
        assert_eq!(next, n);
        assert!(bands.width < 0.1, "{}", bands.width);
    }

    #[test]
    fn no_width_at_all_is_one_band() {
        let mut bands = Bands::default();
        for width in [0.0, f64::NAN, 1e-310] {
            bands.reset(3, width, 1.0);
            (0..3).for_each(|v| bands.put(v, f64::from(v)));
            let n: usize = rounds(&mut bands, &[0.0, 1.0, 2.0]).iter().map(|(_, round)| round.len()).sum();
            assert_eq!(n, 3);
        }
    }
}
