//! The program as its users see it: arguments in; files, output and exit codes out.
//!
//! `cluster` (the scripts in `examples/cluster`), `collections` (folders and indexes as people keep them), `commands` (what
//! each prints), `dropped` (lost surfaces), `field` (all pairs in little memory), `forms` (files), `generate`, `geodesic`
//! (sources, paths, all pairs), `guide` (the commands of the user guide), `hostile` (names that others obey), `index`
//! (building, changing, searching), `killed` (interruptions), `matching` (maps between meshes), `refusals`, `render`
//! (pictures), `serve`, `storage` (archives, lists, conversion, exports), `streams` (standard input and output, several
//! meshes, limits), `zoo` (broken meshes).

#![allow(clippy::unwrap_used, reason = "these are tests")]

#[cfg(unix)]
mod cluster;
mod collections;
mod commands;
mod dropped;
mod field;
mod forms;
mod generate;
mod geodesic;
mod guide;
mod hostile;
mod index;
mod killed;
mod matching;
mod refusals;
mod render;
#[cfg(unix)]
mod serve;
mod storage;
mod streams;
mod support;
mod zoo;
