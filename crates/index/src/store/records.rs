//! Keys with their values, one after the other, and sorted runs of them.
//!
//! A record is the length of the key: u32; the length of the value, or `u32::MAX` if the key is removed: u32; the key;
//! the value. All numbers are little-endian.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::iter::Peekable;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::IndexError;

/// A key and its value; no value means that the key is removed.
pub(crate) type Record = (Vec<u8>, Option<Vec<u8>>);

/// Changed values by their keys.
pub(crate) type Changes = BTreeMap<Vec<u8>, Option<Vec<u8>>>;

const REMOVED: u32 = u32::MAX;

/// Bytes of a record without its key and its value.
const LENGTHS: usize = 8;

/// Bytes that a record takes.
pub(super) fn n_bytes(key: &[u8], n_value: usize) -> usize {
    LENGTHS + key.len() + n_value
}

/// Appends a record.
pub(super) fn push(out: &mut Vec<u8>, key: &[u8], value: Option<&[u8]>) {
    out.extend((key.len() as u32).to_le_bytes());
    out.extend(value.map_or(REMOVED, |value| value.len() as u32).to_le_bytes());
    out.extend(key);
    out.extend(value.unwrap_or_default());
}

/// A record among bytes.
pub(super) struct StoredRecord<'a> {
    pub(super) key: &'a [u8],
    pub(super) value: Option<&'a [u8]>,
    /// Where it ends.
    pub(super) end: usize,
}

/// The record that starts at `at`; `None` if there is no whole one.
pub(super) fn record_at(bytes: &[u8], at: usize) -> Option<StoredRecord<'_>> {
    let (lengths, rest) = bytes.get(at..)?.split_at_checked(LENGTHS)?;
    let (key, value) = (u32_at(lengths, 0) as usize, u32_at(lengths, 4));
    let (key, rest) = rest.split_at_checked(key)?;
    let n_value = if value == REMOVED { 0 } else { value as usize };
    let (bytes, end) = (rest.get(..n_value)?, at + n_bytes(key, n_value));
    Some(StoredRecord { key, value: (value != REMOVED).then_some(bytes), end })
}

pub(super) fn u32_at(bytes: &[u8], at: usize) -> u32 {
    bytes[at..].first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes))
}

pub(super) fn u64_at(bytes: &[u8], at: usize) -> u64 {
    bytes[at..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes))
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(super) fn read_at(file: &Mutex<File>, at: u64, out: &mut [u8]) -> io::Result<()> {
    let mut file = lock(file);
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(out)
}

/// Records in ascending order of their keys.
pub(super) type Run<'a> = Box<dyn Iterator<Item = Result<Record, IndexError>> + 'a>;

/// Several runs as one. Of records with the same key, that of the first run counts.
pub(crate) struct Rows<'a>(Vec<Peekable<Run<'a>>>);

impl<'a> Rows<'a> {
    pub(super) fn of(runs: Vec<Run<'a>>) -> Self {
        Self(runs.into_iter().map(Iterator::peekable).collect())
    }
}

impl Iterator for Rows<'_> {
    type Item = Result<Record, IndexError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(error) = self.0.iter_mut().find_map(|run| run.next_if(Result::is_err)) {
            self.0.clear();
            return Some(error);
        }
        let keys = self.0.iter_mut().filter_map(|run| run.peek()?.as_ref().ok());
        let least = keys.map(|(key, _)| key).min()?.clone();
        let is_least = |record: &Self::Item| record.as_ref().is_ok_and(|(key, _)| *key == least);
        let mut found = None;
        for run in &mut self.0 {
            let record = run.next_if(is_least);
            found = found.or(record);
        }
        found
    }
}

/// The records of changes, from a key on.
pub(super) fn run_of<'a>(changes: &'a Changes, from: &[u8]) -> Run<'a> {
    Box::new(changes.range(from.to_vec()..).map(|(key, value)| Ok((key.clone(), value.clone()))))
}
