//! The figures of the paper: functions from the context to a record.

mod figure1;
mod figure3;
mod figure4;
mod figure5;
mod figure6;
mod figure7;
mod figure8;
mod figure9;

pub(crate) use figure1::figure1;
pub(crate) use figure3::figure3;
pub(crate) use figure4::figure4;
pub(crate) use figure5::{figure5a, figure5b};
pub(crate) use figure6::figure6;
pub(crate) use figure7::figure7;
pub(crate) use figure8::figure8;
pub(crate) use figure9::figure9;
