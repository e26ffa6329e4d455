//! The program: its page in a browser, runs that go on, and the chapters of the guide.

#![allow(clippy::unwrap_used, reason = "these are tests")]

mod guide;
mod page;
mod resumed;
