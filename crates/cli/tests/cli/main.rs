//! The program as its users see it: arguments in; files, output and exit codes out.
//!
//! `commands` (what each prints), `forms` (the files it writes), `errors` (what it refuses, and that
//! nothing is left behind), `folders` (many meshes at once),
//! `geodesic` (sources, paths, all pairs), `index` (making, changing and asking one), `killed` (interruptions,
//! full disks), `render` (pictures).

#[cfg(test)]
mod commands;
#[cfg(test)]
mod errors;
#[cfg(test)]
mod folders;
#[cfg(test)]
mod forms;
#[cfg(test)]
mod geodesic;
#[cfg(test)]
mod index;
#[cfg(test)]
mod killed;
#[cfg(test)]
mod render;
#[cfg(test)]
mod serve;
#[cfg(test)]
mod support;
