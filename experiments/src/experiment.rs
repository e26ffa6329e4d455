//! What every experiment does.

use anyhow::Result;

use crate::context::Context;

/// An experiment: the options of its own in its configuration, and what is done with them.
pub(crate) trait Experiment {
    /// Measures, and [publishes](Context::publish) the results.
    fn run(&self, context: &Context<'_>) -> Result<()>;
}
