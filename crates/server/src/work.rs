//! A bounded number of jobs, and of seconds that jobs wait.

use std::num::NonZero;
use std::sync::Arc;
use std::time::Duration;

use canonform::Budget;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::error::ApiError;
use crate::options::ServeOptions;

/// Seconds that every job takes, with nothing to measure or to compare.
const BASE: f64 = 0.1;

/// The share of the time limit that may be promised: [costs](crate::cost) are estimates.
const MARGIN: f64 = 2.0 / 3.0;

/// Jobs that take longer, in seconds, are long: one place is always left for the others.
const SHORT: f64 = 2.0;

pub(crate) fn is_long(cost: f64) -> bool {
    BASE + cost > SHORT
}

/// The queue of requests that take time.
pub(crate) struct Work {
    jobs: Arc<Semaphore>,
    /// Long jobs need a permit of these too, so that one place is left for short ones.
    long_jobs: Arc<Semaphore>,
    /// Of short and of long jobs: how many of them run at once, and the milliseconds that may be added to those of accepted
    /// jobs.
    accepted: [(usize, Arc<Semaphore>); 2],
    /// Milliseconds that may be promised for each place.
    promised: usize,
    time_limit: Duration,
}

/// Cancels a job when nobody waits for it any more.
pub(crate) struct CancelOnDrop(pub(crate) Budget);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

impl Work {
    pub(crate) fn new(options: &ServeOptions) -> Self {
        let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
        let jobs = if options.jobs == 0 { cores() + 1 } else { options.jobs };
        let long_jobs = (jobs - 1).max(1);
        let promised = (MARGIN * 1e3 * options.time_limit.as_secs_f64()).max(1.0) as usize;
        Self {
            jobs: Arc::new(Semaphore::new(jobs)),
            long_jobs: Arc::new(Semaphore::new(long_jobs)),
            accepted: [1, long_jobs].map(|places| (places, Arc::new(Semaphore::new(promised * places)))),
            promised,
            time_limit: options.time_limit,
        }
    }

    /// Accepts a job of this [cost](crate::cost) until the permit is dropped, unless those before it leave too little of the
    /// time limit; before it is received, to reject it at once. Without any before it, it is accepted: the estimate may be
    /// wrong.
    pub(crate) fn accept(&self, cost: f64) -> Result<OwnedSemaphorePermit, ApiError> {
        let (places, left) = &self.accepted[usize::from(is_long(cost))];
        let all = self.promised * places;
        let wanted = all.min((1e3 * (BASE + cost)) as u32 as usize);
        left.clone().try_acquire_many_owned(wanted as u32).map_err(|_| {
            let before = all - left.available_permits();
            ApiError::busy(before.div_ceil(1000 * places).clamp(1, 3600) as u32)
        })
    }

    /// Runs `job` of this [cost](crate::cost) on a thread of its own when its turn comes. After the time limit, and
    /// when the client has gone, the job is cancelled. It counts until it ends; `held` is dropped then.
    pub(crate) async fn run<T: Send + 'static>(
        &self,
        cost: f64,
        held: Option<OwnedSemaphorePermit>,
        job: impl FnOnce(&Budget) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let accepted = self.accept(cost)?;
        let budget = Budget::unlimited().with_time(self.time_limit);
        // Dropped at the time limit, and with the connection of a client that has gone.
        let _cancel = CancelOnDrop(budget.clone());
        let work = async {
            let long = match is_long(cost) {
                true => Some(self.long_jobs.clone().acquire_owned().await),
                false => None,
            };
            let turn = self.jobs.clone().acquire_owned().await;
            let outcome = tokio::task::spawn_blocking(move || {
                let _held = (accepted, turn, long, held);
                job(&budget)
            });
            // The only other outcome is a panic, whose message is already printed.
            outcome.await.unwrap_or_else(|_| Err(ApiError::internal()))
        };
        let late = |_| Err(ApiError::too_slow(self.time_limit));
        tokio::time::timeout(self.time_limit, work).await.unwrap_or_else(late)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    const LONG: f64 = 16.0;

    fn runtime() -> tokio::runtime::Runtime {
        tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_time().build().unwrap()
    }

    /// Waits for the end of its budget.
    fn obedient(budget: &Budget) -> Result<(), ApiError> {
        while budget.check().is_ok() {
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(())
    }

    async fn until_done(work: &Work, cost: f64) {
        let ends = async {
            while work.run(cost, None, |_| Ok(())).await.is_err() {
                tokio::time::sleep(Duration::from_millis(10)).await;
            }
        };
        tokio::time::timeout(Duration::from_secs(20), ends).await.unwrap();
    }

    #[test]
    fn jobs_that_cannot_be_done_in_time_are_refused_at_once() {
        let work = Work::new(&ServeOptions { jobs: 3, ..ServeOptions::default() });
        let accepted: Vec<_> = (0..20).filter_map(|_| work.accept(20.0).ok()).collect();
        assert_eq!(accepted.len(), 3, "two at once, 20 seconds each");
        assert_eq!(work.accept(20.0).unwrap_err().retry_after, Some(31));
        drop((work.accept(0.2).unwrap(), accepted));
        // Nothing is before it.
        let huge = work.accept(2000.0).unwrap();
        assert!(work.accept(20.0).is_err());
        drop(huge);
        drop(work.accept(20.0).unwrap());
    }

    #[test]
    fn a_late_job_is_cancelled_and_counts_until_it_ends() {
        let options =
            ServeOptions { jobs: 1, time_limit: Duration::from_millis(400), ..ServeOptions::default() };
        let work = Work::new(&options);
        let (finish, finished) = mpsc::channel::<()>();
        runtime().block_on(async {
            let late = work.run(0.0, None, move |budget| {
                obedient(budget)?;
                // It notices, and still takes its time.
                let _ = finished.recv();
                Ok(())
            });
            assert_eq!(late.await.unwrap_err().status, 503);
            // The thread is still busy: a request that waits gets no turn.
            assert_eq!(work.run(0.0, None, |_| Ok(())).await.unwrap_err().status, 503);
            finish.send(()).unwrap();
            until_done(&work, 0.0).await;
        });
    }

    #[test]
    fn long_jobs_leave_a_place_to_short_ones() {
        let work = Arc::new(Work::new(&ServeOptions { jobs: 2, ..ServeOptions::default() }));
        runtime().block_on(async {
            let long: Vec<_> = (0..2)
                .map(|_| {
                    let work = work.clone();
                    tokio::spawn(async move { work.run(LONG, None, obedient).await })
                })
                .collect();
            tokio::time::sleep(Duration::from_millis(50)).await;
            for _ in 0..10 {
                work.run(0.0, None, |_| Ok(())).await.unwrap();
            }
            long.iter().for_each(tokio::task::JoinHandle::abort);
            until_done(&work, LONG).await;
        });
    }

    #[test]
    fn a_panic_is_an_error_and_frees_its_place() {
        let work = Work::new(&ServeOptions { jobs: 1, ..ServeOptions::default() });
        runtime().block_on(async {
            for _ in 0..3 {
                let fault = work.run::<()>(0.0, None, |_| panic!("for the test")).await.unwrap_err();
                assert_eq!(fault.status, 500);
            }
            assert_eq!(work.run(0.0, None, |_| Ok(7)).await.unwrap(), 7);
        });
    }
}
