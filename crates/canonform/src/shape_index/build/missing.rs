//! What becomes of shapes whose files are gone, and whether an index is current.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use collection::{SkipKind, Skipped};
use index::{Entry, Index, IndexError};

use super::report::BuildReport;
use crate::shape_index::place::Root;
use crate::shape_index::record::same_source;
use crate::shape_index::source::Hashed;

/// Decides what becomes of shapes of an index whose files were not found.
pub(super) struct Missing<'a> {
    root: &'a Root<'a>,
    prune: bool,
    /// Paths, as the index states them, at and below which nothing can be read now.
    unreadable: Vec<String>,
    /// Names of files that were found and cannot be read.
    pub(super) unread: HashSet<String>,
}

impl<'a> Missing<'a> {
    pub(super) fn new(root: &'a Root<'a>, prune: bool, skipped: &[Skipped]) -> Self {
        let is_unreadable =
            |skipped: &&Skipped| matches!(skipped.kind, SkipKind::Unreadable | SkipKind::BrokenLink);
        let unreadable = skipped.iter().filter(is_unreadable).map(|skipped| root.text(&skipped.path));
        Self { root, prune, unreadable: unreadable.collect(), unread: HashSet::new() }
    }

    /// Whether a shape stays; counts what becomes of it. A file that cannot be read is not gone.
    pub(super) fn stays(&self, entry: &Entry, report: &mut BuildReport) -> bool {
        let is_below = |place: &String| Path::new(&entry.path).starts_with(place);
        if self.unread.contains(&entry.id) || self.unreadable.iter().any(is_below) {
            report.unreadable.push(entry.id.clone());
            return true;
        }
        let (count, stays) = match (self.root.contains_source(&entry.id, &entry.path), self.prune) {
            (true, _) => (&mut report.removed, false),
            (false, true) => (&mut report.pruned, false),
            (false, false) => (&mut report.elsewhere, true),
        };
        *count += 1;
        stays
    }
}

impl BuildReport {
    /// Completes the report if an index holds just these files, and nothing that has to be removed. Returns whether it does.
    pub(super) fn is_current(
        &mut self,
        index: &Index,
        files: &[Hashed],
        missing: &Missing<'_>,
    ) -> Result<bool, IndexError> {
        let entries = index.entries()?.into_iter().map(|entry| (entry.id.clone(), entry));
        let mut others: HashMap<String, Entry> = entries.collect();
        let mut found = Self::default();
        for (listed, hash) in files {
            match (others.remove(&listed.file.name), hash) {
                (Some(entry), Ok(hash)) if entry.content == *hash && same_source(&entry, listed) => {
                    found.note_dropped(&index.path, &entry);
                }
                _ => return Ok(false),
            }
        }
        for entry in others.into_values() {
            if !missing.stays(&entry, &mut found) {
                return Ok(false);
            }
        }
        let BuildReport { mut dropped, mut unreadable, elsewhere, .. } = found;
        dropped.sort_by(|a, b| a.id.cmp(&b.id));
        unreadable.sort();
        (self.n_shapes, self.unchanged) = (index.len(), files.len());
        (self.dropped, self.unreadable, self.elsewhere) = (dropped, unreadable, elsewhere);
        Ok(true)
    }
}
