//! Studies beyond the paper: functions from the context to a record.

mod evidence;
mod forms;
mod invariance;
mod matching;
mod partial;
mod points;
mod published;
mod retrieval;
mod robustness;
mod scaling;

pub(crate) use evidence::evidence;
pub(crate) use forms::{MANY_DIMENSIONS, forms};
pub(crate) use invariance::invariance;
pub(crate) use matching::matching;
pub(crate) use partial::partial;
pub(crate) use points::points;
pub(crate) use published::{Published, published};
pub(crate) use retrieval::retrieval;
pub(crate) use robustness::robustness;
pub(crate) use scaling::scaling;
