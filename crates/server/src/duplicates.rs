//! The search for the duplicates of the index. It outlasts a request, so clients ask until it is done.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use canonform::library::{DuplicateOptions, find_duplicates};
use canonform::{Budget, Error, Observer};
use rayon::ThreadPoolBuilder;
use serde::Serialize;

use crate::collection::Collection;
use crate::error::ApiError;
use crate::options::STACK;

/// The search in progress, or the last one: one for each version of the index.
pub(crate) struct Duplicates {
    run: Arc<Mutex<Option<Run>>>,
    /// A search that nobody has asked for during this time is cancelled.
    patience: Duration,
}

/// What is known so far.
pub(crate) enum Known {
    /// All of it, as JSON.
    Report(Bytes),
    /// How far the search is.
    Progress(Progress),
}

/// How far a search is.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct Progress {
    stage: String,
    done: usize,
    total: usize,
}

struct Run {
    version: String,
    watched: Watched,
    asked: Instant,
    outcome: Option<Result<Bytes, ApiError>>,
}

/// Keeps the progress of a search, and cancels it.
#[derive(Clone, Default)]
struct Watched {
    budget: Budget,
    progress: Arc<Mutex<Progress>>,
}

impl Observer for Watched {
    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn begin(&self, stage: &str, total: usize) {
        *lock(&self.progress) = Progress { stage: stage.to_owned(), done: 0, total };
    }

    fn step(&self) {
        lock(&self.progress).done += 1;
    }
}

impl Duplicates {
    pub(crate) fn new(patience: Duration) -> Self {
        Self { run: Arc::default(), patience }
    }

    /// The duplicates of the collection, if they are known; otherwise they are searched for, on a thread of their own.
    pub(crate) fn ask(&self, collection: &Arc<Collection>) -> Result<Known, ApiError> {
        let mut now = lock(&self.run);
        if now.as_ref().is_none_or(|run| run.version != collection.version) {
            end(now.take());
            *now = Some(self.start(collection.clone())?);
        }
        let Some(run) = now.as_mut() else { return Err(ApiError::internal()) };
        run.asked = Instant::now();
        match &run.outcome {
            None => Ok(Known::Progress(lock(&run.watched.progress).clone())),
            Some(Ok(report)) => Ok(Known::Report(report.clone())),
            // The next client starts another search.
            Some(Err(_)) => {
                Err(now.take().and_then(|run| run.outcome?.err()).unwrap_or_else(ApiError::internal))
            }
        }
    }

    /// Cancels a search that nobody waits for any more.
    pub(crate) fn cancel_unwanted(&self) {
        let mut now = lock(&self.run);
        if now.as_ref().is_some_and(|run| run.outcome.is_none() && run.asked.elapsed() > self.patience) {
            end(now.take());
        }
    }

    /// Cancels the search.
    pub(crate) fn cancel(&self) {
        end(lock(&self.run).take());
    }

    fn start(&self, collection: Arc<Collection>) -> Result<Run, ApiError> {
        let watched = Watched::default();
        let run = Run {
            version: collection.version.clone(),
            watched: watched.clone(),
            asked: Instant::now(),
            outcome: None,
        };
        // One thread leaves the others to requests.
        let pool = ThreadPoolBuilder::new().num_threads(1).stack_size(STACK).build();
        let shared = self.run.clone();
        pool.map_err(|_| ApiError::internal())?.spawn(move || {
            // The message of a panic is already printed.
            let found = catch_unwind(AssertUnwindSafe(|| search(&collection, &watched)));
            let outcome = found.unwrap_or_else(|_| Err(ApiError::internal()));
            if let Some(run) = lock(&shared).as_mut().filter(|run| run.is_watched_by(&watched)) {
                run.outcome = Some(outcome);
            }
        });
        Ok(run)
    }
}

impl Run {
    fn is_watched_by(&self, watched: &Watched) -> bool {
        Arc::ptr_eq(&self.watched.progress, &watched.progress)
    }
}

fn end(run: Option<Run>) {
    run.iter().for_each(|run| run.watched.budget.cancel());
}

/// The report as JSON, with paths as clients may see them.
fn search(collection: &Collection, watched: &Watched) -> Result<Bytes, ApiError> {
    let index = collection.search.index();
    let mut report = find_duplicates(&collection.search, &DuplicateOptions::default(), watched)?;
    for file in report.files_mut() {
        file.path = collection.public_path(&index.entry(&file.id).map_err(Error::from)?.path).into();
    }
    serde_json::to_vec(&report).map(Bytes::from).map_err(|_| ApiError::internal())
}

/// A poisoned lock is harmless: values change as a whole.
fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_that_nobody_asks_for_is_cancelled() {
        let patience = Duration::from_secs(60);
        for (elapsed, is_cancelled) in [(Duration::ZERO, false), (2 * patience, true)] {
            let watched = Watched::default();
            let asked = Instant::now().checked_sub(elapsed).unwrap_or_else(Instant::now);
            let run = Run { version: String::new(), watched: watched.clone(), asked, outcome: None };
            let duplicates = Duplicates { run: Arc::new(Mutex::new(Some(run))), patience };
            duplicates.cancel_unwanted();
            assert_eq!(watched.budget.check().is_err(), is_cancelled);
            assert_eq!(lock(&duplicates.run).is_none(), is_cancelled);
        }
    }
}
