//! Options of maps between surfaces.

use maps::{EIGENFUNCTIONS, KnownMap};

use crate::form::FormOptions;

/// Everything that decides the maps between two surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrespondOptions {
    /// How the canonical forms are made, whose alignments the search starts from.
    pub form: FormOptions,
    /// Most eigenfunctions of each surface. Default: 150.
    pub eigenfunctions: usize,
    /// What is known of the map of two surfaces, in the numbers of their inputs. Default: nothing.
    pub known: KnownMap,
}

impl Default for CorrespondOptions {
    fn default() -> Self {
        let (form, known) = Default::default();
        Self { form, eigenfunctions: EIGENFUNCTIONS, known }
    }
}
