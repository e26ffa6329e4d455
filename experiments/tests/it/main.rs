//! The program: its page in a browser, and the chapters of the guide.

#![allow(clippy::unwrap_used, reason = "these are tests")]

mod guide;
mod page;
