//! Studies beyond the paper: functions from the context to a record.

pub(crate) mod evidence;
pub(crate) mod forms;
pub(crate) mod matching;
pub(crate) mod points;
pub(crate) mod retrieval;
pub(crate) mod robustness;
pub(crate) mod scaling;
