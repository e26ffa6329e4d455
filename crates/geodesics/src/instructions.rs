//! The vector instructions of the machine, chosen when the program runs.

/// Runs work with the widest vector instructions that the machine has. Results do not depend on them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instructions(pulp::Arch);

impl Default for Instructions {
    fn default() -> Self {
        Self(pulp::Arch::new())
    }
}

impl Instructions {
    /// Runs `work`; what it calls has to be inlined.
    #[inline(always)]
    pub(crate) fn dispatch(self, work: impl FnOnce()) {
        self.0.dispatch(work);
    }
}
