//! The figures of the paper: functions from the context to a record.

pub(crate) mod figure1;
pub(crate) mod figure3;
pub(crate) mod figure4;
pub(crate) mod figure5;
pub(crate) mod figure6;
pub(crate) mod figure7;
pub(crate) mod figure8;
pub(crate) mod figure9;
