//! How long a client keeps the server waiting.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The account of one connection. While the server waits for the client, to send or to receive, the delay grows with
/// the clock; every byte that moves reduces it, so a client that keeps the minimum rate has none.
#[derive(Debug)]
pub(crate) struct Pace {
    /// Seconds that a byte is worth.
    per_byte: f64,
    account: Mutex<Account>,
}

#[derive(Debug, Clone, Copy)]
struct Account {
    phase: Phase,
    /// Seconds, at `since`.
    delay: f64,
    since: Instant,
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
    /// A new connection, of which nothing has arrived. `rate` is in bytes per second.
    pub(crate) fn new(rate: usize) -> Self {
        let account = Account { phase: Phase::Waiting, delay: 0.0, since: Instant::now() };
        Self { per_byte: 1.0 / rate.max(1) as f64, account: Mutex::new(account) }
    }

    /// This many bytes were received or sent.
    pub(crate) fn moved(&self, bytes: usize) {
        let mut account = self.settle();
        account.delay = (account.delay - bytes as f64 * self.per_byte).max(0.0);
    }

    /// Begins a phase. A response begins without delay.
    pub(crate) fn begin(&self, phase: Phase) {
        let mut account = self.settle();
        account.phase = phase;
        if phase == Phase::Waiting {
            account.delay = 0.0;
        }
    }

    pub(crate) fn phase(&self) -> Phase {
        self.settle().phase
    }

    /// How long the server has been waiting beyond what the bytes moved account for.
    pub(crate) fn delay(&self) -> Duration {
        Duration::from_secs_f64(self.settle().delay)
    }

    /// Waits until the delay in one of these phases reaches `limit`.
    pub(crate) async fn exceeds(&self, limit: Duration, phases: &[Phase]) {
        // Often enough for a phase that begins in the meantime.
        const SHORTEST: Duration = Duration::from_millis(20);
        loop {
            let left = limit.saturating_sub(self.delay());
            if left.is_zero() && phases.contains(&self.phase()) {
                return;
            }
            tokio::time::sleep(left.max(SHORTEST)).await;
        }
    }

    /// The account at this moment. A poisoned lock is harmless: nothing panics while it is held.
    fn settle(&self) -> MutexGuard<'_, Account> {
        let mut account = self.account.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        if account.phase != Phase::Working {
            account.delay += now.saturating_duration_since(account.since).as_secs_f64();
        }
        account.since = now;
        account
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_waiting_for_the_client_counts_and_bytes_pay_for_it() {
        let pace = Pace::new(1000);
        let pause = || std::thread::sleep(Duration::from_millis(30));
        pause();
        let waited = pace.delay();
        assert!(waited >= Duration::from_millis(30));
        pace.begin(Phase::Working);
        let before = pace.delay();
        pause();
        assert_eq!(pace.delay(), before);
        pace.begin(Phase::Receiving);
        pause();
        assert!(pace.delay() >= before + Duration::from_millis(30));
        pace.moved(1 << 20);
        assert!(pace.delay() < Duration::from_millis(20));
        pause();
        pace.begin(Phase::Waiting);
        assert!(pace.delay() < Duration::from_millis(20), "a response begins without delay");
    }
}
