//! A bounded number of jobs, and a bounded queue.

use std::num::NonZero;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::error::ApiError;
use crate::options::ServeOptions;

/// Seconds after which a rejected client may try again.
const RETRY_AFTER: u32 = 2;

/// The queue of requests that take time.
pub(crate) struct Work {
    jobs: Arc<Semaphore>,
    waiting: Arc<Semaphore>,
    uploads: Arc<Semaphore>,
    time_limit: Duration,
}

/// The right to send a mesh; returned by dropping it once the mesh is measured.
pub(crate) type UploadPermit = OwnedSemaphorePermit;

impl Work {
    pub(crate) fn new(options: &ServeOptions) -> Self {
        let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
        let jobs = if options.jobs == 0 { cores() } else { options.jobs };
        Self {
            jobs: Arc::new(Semaphore::new(jobs)),
            waiting: Arc::new(Semaphore::new(jobs + options.queue)),
            uploads: Arc::new(Semaphore::new(options.max_uploads)),
            time_limit: options.time_limit,
        }
    }

    /// Rejects an upload before its first byte if there are too many.
    pub(crate) fn upload(&self) -> Result<UploadPermit, ApiError> {
        self.uploads.clone().try_acquire_owned().map_err(|_| ApiError::busy(RETRY_AFTER))
    }

    /// Runs `job` on a thread of its own when its turn comes. After the time limit this returns an error, but the job
    /// counts until it ends; `held` is dropped then.
    pub(crate) async fn run<T: Send + 'static>(
        &self,
        held: Option<UploadPermit>,
        job: impl FnOnce() -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let place = self.waiting.clone().try_acquire_owned().map_err(|_| ApiError::busy(RETRY_AFTER))?;
        let work = async {
            let turn = self.jobs.clone().acquire_owned().await.map_err(|_| ApiError::busy(RETRY_AFTER))?;
            let outcome = tokio::task::spawn_blocking(move || {
                let _held = (place, turn, held);
                job()
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

    fn runtime() -> tokio::runtime::Runtime {
        tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_time().build().unwrap()
    }

    #[test]
    fn a_late_job_still_counts_and_the_queue_is_bounded() {
        let options = ServeOptions {
            jobs: 1,
            queue: 1,
            time_limit: Duration::from_millis(200),
            ..ServeOptions::default()
        };
        let work = Work::new(&options);
        let (finish, finished) = mpsc::channel::<()>();
        runtime().block_on(async {
            let late = work.run(None, move || {
                let _ = finished.recv();
                Ok(())
            });
            assert_eq!(late.await.unwrap_err().status(), 503);
            // The thread is still busy: one request may wait, in vain, but not a second one.
            let (waiting, refused) = (work.run(None, || Ok(())), async {
                tokio::time::sleep(Duration::from_millis(50)).await;
                work.run(None, || Ok(())).await
            });
            let (waiting, refused) = futures_util::future::join(waiting, refused).await;
            assert_eq!((waiting.unwrap_err().status(), refused.unwrap_err().status()), (503, 503));
            finish.send(()).unwrap();
            let ends = async {
                while work.run(None, || Ok(())).await.is_err() {
                    tokio::time::sleep(Duration::from_millis(10)).await;
                }
            };
            tokio::time::timeout(Duration::from_secs(20), ends).await.unwrap();
        });
    }

    #[test]
    fn a_panic_is_an_error_and_frees_its_place() {
        let work = Work::new(&ServeOptions { jobs: 1, queue: 0, ..ServeOptions::default() });
        runtime().block_on(async {
            for _ in 0..3 {
                let fault = work.run::<()>(None, || panic!("for the test")).await.unwrap_err();
                assert_eq!(fault.status(), 500);
            }
            assert_eq!(work.run(None, || Ok(7)).await.unwrap(), 7);
        });
    }

    #[test]
    fn uploads_are_counted_until_they_are_measured() {
        let work = Work::new(&ServeOptions { max_uploads: 1, ..ServeOptions::default() });
        runtime().block_on(async {
            let permit = work.upload().unwrap();
            assert_eq!(work.upload().err().unwrap().status(), 503);
            work.run(Some(permit), || Ok(())).await.unwrap();
            drop(work.upload().unwrap());
        });
    }
}
