//! Options of maps between surfaces.

use maps::{KnownMap, MapParams};

use crate::form::FormOptions;

/// Everything that decides the maps between two surfaces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CorrespondOptions {
    /// How the canonical forms are made, whose alignments the search starts from.
    pub form: FormOptions,
    /// How maps are searched for.
    pub maps: MapParams,
    /// What is known of the map of two surfaces, in the numbers of their inputs. Default: nothing.
    pub known: KnownMap,
}
