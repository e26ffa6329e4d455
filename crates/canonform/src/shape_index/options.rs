//! How an index is searched.

use serde::{Deserialize, Serialize};

use super::agreement::Agreement;

/// How an index is searched.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchOptions {
    /// Number of results. Default: 10.
    pub k: usize,
    /// Whether every result is compared with the query by files and meshes, too, and with a
    /// [`Comparison`](crate::compare::Comparison). Default: no.
    pub explain: bool,
    /// How results are ordered. Default: [`SearchRank::Plain`], by combined distance.
    pub rank_by: SearchRank,
    /// The classes [of all indexes](Agreement::of_indexes) that are searched as one. Default: those of the index.
    pub classes: Option<Agreement>,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self { k: 10, explain: false, rank_by: SearchRank::Plain, classes: None }
    }
}

/// How the results of a search are ordered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum SearchRank {
    /// By distance
    #[default]
    Plain,
    /// By distance of signatures and by the neighbors that query and shape have in common
    Graph,
    /// By how well the query fits as a part of the shape, for a mesh that was cut or scanned in part
    ///
    /// Compares the query with every shape of the index, which must store disc areas, and needs the mesh or the surface of
    /// the query.
    Part,
    /// By canonical forms alone
    ///
    /// Compares the query with every shape of the index by [`descriptors::SampledForm::spectrum`].
    Forms,
}
