//! How long the jobs in progress and in the queue will take, estimated from those that are done.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Seconds that every job takes, with nothing to measure or to compare.
const BASE: f64 = 0.1;

/// Measured times may differ from [costs](crate::cost) by these factors; beyond them a mesh is unusual, not the machine.
const FACTORS: [f64; 2] = [0.1, 4.0];

/// The number of jobs that the estimate is a median of.
const REMEMBERED: usize = 15;

/// The share of the time limit that may be promised: estimates are not exact.
const MARGIN: f64 = 0.75;

/// Jobs of a smaller cost say little about the machine.
const TELLING: f64 = 0.3;

/// Jobs that take longer, in seconds, are long: one place is always left for the others.
const SHORT: f64 = 2.0;

/// The jobs that have been accepted and are not done.
#[derive(Debug)]
pub(crate) struct Load {
    /// Jobs of each length that can run at once: short ones, beside as many long ones as are allowed, and long ones.
    places: [usize; 2],
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    /// Seconds of all accepted jobs, by length.
    seconds: [f64; 2],
    /// Measured seconds per second of cost, newest last.
    measured: VecDeque<f64>,
}

/// How long a job takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Length {
    Short,
    Long,
}

/// An accepted job; it counts until this is dropped.
#[derive(Debug)]
pub(crate) struct Accepted {
    load: Arc<Load>,
    pub(crate) length: Length,
    seconds: f64,
    cost: f64,
}

impl Load {
    pub(crate) fn new(jobs: usize, long_jobs: usize) -> Arc<Self> {
        let places = [jobs.saturating_sub(long_jobs).max(1), long_jobs.max(1)];
        Arc::new(Self { places, state: Mutex::default() })
    }

    /// Accepts a job of this cost, unless the jobs before it leave too little of the time limit. Without any
    /// before it, it is accepted: the estimate may be wrong.
    ///
    /// # Errors
    /// The seconds after which the jobs before it are done.
    pub(crate) fn accept(self: &Arc<Self>, cost: f64, limit: Duration) -> Result<Accepted, u32> {
        let mut state = self.lock();
        let (length, seconds) = self.check(&state, cost, limit)?;
        state.seconds[length as usize] += seconds;
        drop(state);
        Ok(Accepted { load: self.clone(), length, seconds, cost })
    }

    /// Whether a job would be accepted now.
    ///
    /// # Errors
    /// As [`accept`](Self::accept).
    pub(crate) fn would_accept(&self, cost: f64, limit: Duration) -> Result<(), u32> {
        self.check(&self.lock(), cost, limit).map(drop)
    }

    fn check(&self, state: &State, cost: f64, limit: Duration) -> Result<(Length, f64), u32> {
        let seconds = BASE + cost * state.factor();
        let length = if seconds <= SHORT { Length::Short } else { Length::Long };
        let before = state.seconds[length as usize] / self.places[length as usize] as f64;
        match before > 0.0 && before + seconds > MARGIN * limit.as_secs_f64() {
            true => Err(before.ceil().clamp(1.0, 3600.0) as u32),
            false => Ok((length, seconds)),
        }
    }

    /// A poisoned lock is harmless: no method panics between two changes.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// How much longer than their costs jobs take here. The median of the last jobs: a few unusual meshes do not change it.
    fn factor(&self) -> f64 {
        let mut sorted: Vec<f64> = self.measured.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(1.0)
    }
}

impl Accepted {
    /// Learns from a job that was begun then and has ended, finished or not.
    pub(crate) fn ended(&self, begun: Instant) {
        if self.cost < TELLING {
            return;
        }
        let factor = (begun.elapsed().as_secs_f64() - BASE) / self.cost;
        let measured = &mut self.load.lock().measured;
        measured.push_back(factor.clamp(FACTORS[0], FACTORS[1]));
        if measured.len() > REMEMBERED {
            measured.pop_front();
        }
    }
}

impl Drop for Accepted {
    fn drop(&mut self) {
        let seconds = &mut self.load.lock().seconds[self.length as usize];
        // Rounding must not leave a trace.
        *seconds = if *seconds < self.seconds + 1e-6 { 0.0 } else { *seconds - self.seconds };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: Duration = Duration::from_secs(60);

    const LARGE: f64 = 22.0;

    #[test]
    fn jobs_that_cannot_be_done_in_time_are_refused_at_once() {
        let load = Load::new(3, 2);
        let accepted: Vec<_> = (0..20).filter_map(|_| load.accept(LARGE, LIMIT).ok()).collect();
        assert_eq!(accepted.len(), 3, "two at once, 22 seconds each");
        let wait = load.accept(LARGE, LIMIT).unwrap_err();
        assert!((30..=60).contains(&wait), "{wait}");
        assert_eq!(load.would_accept(LARGE, LIMIT), Err(wait));
        let short = load.accept(0.2, LIMIT).unwrap();
        assert_eq!((accepted[0].length, short.length), (Length::Long, Length::Short));
        drop((accepted, short));
        assert_eq!(load.lock().seconds, [0.0, 0.0]);
    }

    #[test]
    fn a_job_is_never_refused_on_an_idle_server() {
        let load = Load::new(2, 1);
        let huge = load.accept(2000.0, LIMIT).unwrap();
        assert!(load.accept(LARGE, LIMIT).is_err());
        drop(huge);
        load.accept(LARGE, LIMIT).unwrap();
    }

    #[test]
    fn estimates_follow_the_machine_and_not_a_few_unusual_meshes() {
        let load = Load::new(2, 1);
        let factor = |load: &Load| load.lock().factor();
        let ended = |seconds: f64| {
            let job = load.accept(1.6, LIMIT).unwrap();
            job.ended(Instant::now().checked_sub(Duration::from_secs_f64(seconds)).unwrap());
        };
        let is_half = || (factor(&load) - 0.5).abs() < 0.05;
        (0..8).for_each(|_| ended(BASE + 0.8));
        assert!(is_half(), "{}", factor(&load));
        (0..7).for_each(|_| ended(60.0));
        assert!(is_half(), "{}", factor(&load));
        (0..15).for_each(|_| ended(60.0));
        assert_eq!(factor(&load), FACTORS[1]);
    }
}
