//! Work that others look at while it is in progress.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde::Serialize;

use base::{Budget, Observer};

/// How far work is.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Progress {
    /// The stage.
    pub stage: String,
    /// Steps of it that are done; some may have to be done again.
    pub done: usize,
    /// Its steps.
    pub total: usize,
}

/// An observer that keeps the progress of work for those who wait for it. Copies share it.
#[derive(Debug, Clone, Default)]
pub struct Watched {
    /// Limits of the work.
    pub budget: Budget,
    progress: Arc<Mutex<Progress>>,
}

impl Watched {
    /// Work within these limits.
    pub fn new(budget: Budget) -> Self {
        Self { budget, ..Self::default() }
    }

    /// How far it is.
    pub fn progress(&self) -> Progress {
        self.lock().clone()
    }

    /// A poisoned lock is harmless: values change as a whole.
    fn lock(&self) -> MutexGuard<'_, Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for Watched {
    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn begin(&self, stage: &str, total: usize) {
        *self.lock() = Progress { stage: stage.to_owned(), done: 0, total };
    }

    fn step(&self) {
        self.lock().done += 1;
    }
}
