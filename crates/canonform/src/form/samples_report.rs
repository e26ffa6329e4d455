//! How the number of samples was found.

use nmds::{SampleSearch, SampleStop, SampleTrial};
use serde::Serialize;

use super::stress::StressReport;

/// How the number of samples was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SamplesReport {
    /// The most normalised stress that was wanted, if any.
    pub target_stress: Option<f64>,
    /// Why no more samples were taken.
    pub stop: SampleStop,
    /// Whether the stress of the result is within the target; `None` without a target.
    pub verdict: Option<TargetVerdict>,
    /// The least number of samples tried whose stress is within 1 % of that of the result.
    pub sufficient: usize,
    /// Rows of distances that the choice was made on. They are not those that the stress of the result is estimated from.
    pub rows: usize,
    /// What was tried.
    pub tried: Vec<SampleTrial>,
}

/// Whether the stress of an embedding is within a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TargetVerdict {
    /// The whole confidence interval is, or the exact value.
    Within,
    /// The confidence interval contains the target.
    Uncertain,
    /// The whole confidence interval is above the target.
    Exceeded,
}

impl SamplesReport {
    pub(super) fn new(search: &SampleSearch, target_stress: Option<f64>, stop: SampleStop) -> Self {
        Self {
            target_stress,
            stop,
            verdict: None,
            sufficient: search.sufficient(),
            rows: search.n_rows(),
            tried: search.trials().to_vec(),
        }
    }

    /// The same with a verdict on the stress of the result. Without one, the rows of the choice decide, which cannot be certain
    /// that a target was reached.
    #[must_use]
    pub(super) fn judged(mut self, stress: Option<&StressReport>) -> Self {
        self.verdict = self.target_stress.map(|target| match stress.map(|s| s.normalized_interval) {
            Some([_, high]) if high <= target => TargetVerdict::Within,
            Some([low, _]) if low > target => TargetVerdict::Exceeded,
            None if self.stop != SampleStop::Target => TargetVerdict::Exceeded,
            _ => TargetVerdict::Uncertain,
        });
        self
    }

    /// Whether a target was missed: the stress is above it for certain, or the search ended above it.
    #[must_use]
    pub fn is_missed(&self) -> bool {
        match self.verdict {
            None | Some(TargetVerdict::Within) => false,
            Some(TargetVerdict::Uncertain) => self.stop != SampleStop::Target,
            Some(TargetVerdict::Exceeded) => true,
        }
    }
}
