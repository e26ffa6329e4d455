//! Options of maps between surfaces.

use maps::{KnownMap, MapParams};

use crate::form::FormOptions;

/// Everything that decides the maps between two surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrespondOptions {
    /// How the canonical forms are made, whose alignments the search starts from.
    pub form: FormOptions,
    /// Vertices of each surface on which maps are refined before all others follow. Default: 1000.
    pub spread: usize,
    /// How maps are searched for.
    pub maps: MapParams,
    /// What is known of the map of two surfaces, in the numbers of their inputs. Default: nothing.
    pub known: KnownMap,
}

impl Default for CorrespondOptions {
    fn default() -> Self {
        let (form, maps, known) = Default::default();
        Self { form, spread: 1000, maps, known }
    }
}
