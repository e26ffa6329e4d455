//! The program as its users see it: arguments in; files, output and exit codes out.
//!
//! `cluster` (the scripts in `examples/cluster`), `collections` (folders and indexes as people keep them), `commands` (what
//! each prints), `dropped` (lost surfaces), `forms` (files), `errors`, `field` (all pairs in little memory), `generate`, `geodesic` (sources, paths,
//! all pairs), `guide` (the commands of the user guide), `hostile` (names that others obey), `index` (building, changing, searching), `killed` (interruptions, full disks), `matching` (maps between meshes), `render` (pictures), `serve`, `storage` (archives, lists, conversion,
//! exports), `streams` (standard input and
//! output, several meshes, limits), `zoo` (broken meshes).

#[cfg(test)]
#[cfg(unix)]
mod cluster;
#[cfg(test)]
mod collections;
#[cfg(test)]
mod commands;
#[cfg(test)]
mod dropped;
#[cfg(test)]
mod duplicates;
#[cfg(test)]
mod errors;
#[cfg(test)]
mod field;
#[cfg(test)]
mod forms;
#[cfg(test)]
mod generate;
#[cfg(test)]
mod geodesic;
#[cfg(test)]
mod guide;
#[cfg(test)]
mod hostile;
#[cfg(test)]
mod index;
#[cfg(test)]
mod killed;
#[cfg(test)]
mod matching;
#[cfg(test)]
mod render;
#[cfg(test)]
mod serve;
#[cfg(test)]
mod storage;
#[cfg(test)]
mod streams;
#[cfg(test)]
mod support;
#[cfg(test)]
mod zoo;
