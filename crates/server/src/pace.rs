//! How long a client keeps the server waiting.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The rate in bytes per second at which a client does not keep the server waiting.
const RATE: f64 = 4000.0;

/// The account of one connection: when the server has waited long enough for the client, to send or to receive. Every byte that
/// moves puts that off, so a client that keeps the minimum rate has all the time that is allowed.
#[derive(Debug)]
pub(crate) struct Pace {
    allowed: Duration,
    state: Mutex<(Phase, Instant)>,
}

/// Who is waiting for whom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    /// The server works, and its client waits.
    Working,
    /// The server waits for the body of a request.
    Receiving,
    /// The server waits for a request, or for its client to take a response.
    Waiting,
}

impl Pace {
    /// A new connection, of which nothing has arrived.
    pub(crate) fn new(allowed: Duration) -> Self {
        Self { allowed, state: Mutex::new((Phase::Waiting, Instant::now() + allowed)) }
    }

    /// This many bytes were received or sent.
    pub(crate) fn moved(&self, bytes: usize) {
        let (_, end) = &mut *self.lock();
        *end = (*end + Duration::from_secs_f64(bytes as f64 / RATE)).min(Instant::now() + self.allowed);
    }

    /// Begins a phase, without delay.
    pub(crate) fn begin(&self, phase: Phase) {
        *self.lock() = (phase, Instant::now() + self.allowed);
    }

    /// How long the server has been waiting beyond what the bytes moved account for; not at all while it works.
    pub(crate) fn delay(&self) -> Duration {
        match *self.lock() {
            (Phase::Working, _) => Duration::ZERO,
            (_, end) => self.allowed.saturating_sub(end.saturating_duration_since(Instant::now())),
        }
    }

    /// Waits until the client has no time left in this phase.
    pub(crate) async fn is_over(&self, phase: Phase) {
        // Often enough for a phase that begins in the meantime.
        const SHORTEST: Duration = Duration::from_millis(20);
        loop {
            let (now, end) = *self.lock();
            let left = end.saturating_duration_since(Instant::now());
            if now == phase && left.is_zero() {
                return;
            }
            tokio::time::sleep(left.max(SHORTEST)).await;
        }
    }

    /// A poisoned lock is harmless: nothing panics while it is held.
    fn lock(&self) -> MutexGuard<'_, (Phase, Instant)> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
