//! Progress of long work.

/// Receives the progress of finding the neighbours of all shapes, from any thread.
pub trait Progress: Sync {
    /// This many shapes follow.
    fn begin(&self, total: usize);

    /// So many more are done.
    fn step(&self, done: usize);
}

/// Ignores progress.
impl Progress for () {
    fn begin(&self, _: usize) {}

    fn step(&self, _: usize) {}
}
