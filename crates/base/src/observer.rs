//! Progress and limits of long work.

use crate::Budget;

/// Receives the progress of long work, from any thread, and limits it.
pub trait Observer: Sync {
    /// Limits of the work, which ends with an error when it exceeds them.
    fn budget(&self) -> Budget {
        Budget::unlimited()
    }

    /// A stage of `total` steps begins; the previous one has ended.
    fn begin(&self, _stage: &str, _total: usize) {}

    /// A step of the current stage is done. Some steps may have to be done again: what is shown ends at the total.
    fn step(&self) {}
}

/// Ignores progress.
impl Observer for () {}

/// Limits without progress.
impl Observer for Budget {
    fn budget(&self) -> Budget {
        self.clone()
    }
}
