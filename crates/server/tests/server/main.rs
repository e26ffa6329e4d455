//! The server as clients meet it, over the wire and in a browser.

#![allow(clippy::unwrap_used, reason = "these are tests")]

mod answers;
mod attacks;
mod client;
mod duplicates;
mod hostile;
mod index;
mod limits;
mod page;
mod proxy;
mod schema;
mod support;
