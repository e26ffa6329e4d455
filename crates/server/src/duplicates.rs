//! The search for the duplicates of the index. It outlasts a request, so clients ask until it is done.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use axum::Json;
use axum::body::Bytes;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use canonform::library::{DuplicateOptions, find_duplicates};
use canonform::{Error, Watched};
use rayon::ThreadPoolBuilder;

use crate::collection::Collection;
use crate::error::ApiError;
use crate::options::STACK;
use crate::work::CancelOnDrop;

/// Seconds after which a client may ask again.
const AGAIN: &str = "1";

/// The search in progress, or the last one: one for each version of the index.
pub(crate) struct Duplicates {
    run: Mutex<Option<Run>>,
    /// A search that nobody has asked for during this time is cancelled.
    patience: Duration,
}

struct Run {
    version: String,
    watched: Watched,
    outcome: Arc<OnceLock<Result<Bytes, ApiError>>>,
    asked: Instant,
    _cancel: CancelOnDrop,
}

impl Duplicates {
    pub(crate) fn new(patience: Duration) -> Self {
        Self { run: Mutex::default(), patience }
    }

    /// The duplicates of the collection, if they are known; otherwise they are searched for, on a thread of their own, and the
    /// answer says how far that is.
    pub(crate) fn ask(&self, collection: &Arc<Collection>) -> Result<Response, ApiError> {
        let mut now = lock(&self.run);
        let run = match now.take().filter(|run| run.version == collection.version) {
            Some(run) => now.insert(Run { asked: Instant::now(), ..run }),
            None => now.insert(Run::start(collection.clone())?),
        };
        match run.outcome.get().cloned() {
            None => {
                let progress = Json(run.watched.progress());
                Ok((StatusCode::ACCEPTED, [(header::RETRY_AFTER, AGAIN)], progress).into_response())
            }
            Some(Ok(report)) => Ok(([(header::CONTENT_TYPE, "application/json")], report).into_response()),
            // The next client starts another search.
            Some(Err(fault)) => {
                *now = None;
                Err(fault)
            }
        }
    }

    /// Cancels a search that nobody waits for any more.
    pub(crate) fn cancel_unwanted(&self) {
        let is_unwanted = |run: &mut Run| run.outcome.get().is_none() && run.asked.elapsed() > self.patience;
        lock(&self.run).take_if(is_unwanted);
    }

    /// Cancels the search.
    pub(crate) fn cancel(&self) {
        *lock(&self.run) = None;
    }
}

impl Run {
    fn start(collection: Arc<Collection>) -> Result<Self, ApiError> {
        let (watched, outcome) = (Watched::default(), Arc::new(OnceLock::new()));
        let (version, asked) = (collection.version.clone(), Instant::now());
        let _cancel = CancelOnDrop(watched.budget.clone());
        let run = Self { version, watched: watched.clone(), outcome: outcome.clone(), asked, _cancel };
        // One thread leaves the others to requests.
        let pool = ThreadPoolBuilder::new().num_threads(1).stack_size(STACK).build();
        pool.map_err(|_| ApiError::internal())?.spawn(move || {
            // The message of a panic is already printed.
            let found = catch_unwind(AssertUnwindSafe(|| search(&collection, &watched)));
            let _ = outcome.set(found.unwrap_or_else(|_| Err(ApiError::internal())));
        });
        Ok(run)
    }
}

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
            let _cancel = CancelOnDrop(watched.budget.clone());
            let (version, outcome) = (String::new(), Arc::default());
            let run = Run { version, watched: watched.clone(), outcome, asked, _cancel };
            let duplicates = Duplicates { run: Mutex::new(Some(run)), patience };
            duplicates.cancel_unwanted();
            assert_eq!(watched.budget.check().is_err(), is_cancelled);
            assert_eq!(lock(&duplicates.run).is_none(), is_cancelled);
        }
    }
}
