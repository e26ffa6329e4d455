//! Tables: keys and values with types.

use std::marker::PhantomData;
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::codec::{decode, encode};
use super::file::StoredFile;
use super::log::Log;
use super::records::{Changes, Record, Rows, Run, run_of};
use crate::IndexError;

/// Keys of one kind. The order of keys is that of their bytes.
pub(crate) trait Key {
    type Owned: std::fmt::Debug;

    fn write(&self, out: &mut Vec<u8>);

    fn read(bytes: &[u8]) -> Option<Self::Owned>;
}

impl Key for str {
    type Owned = String;

    fn write(&self, out: &mut Vec<u8>) {
        out.extend(self.as_bytes());
    }

    fn read(bytes: &[u8]) -> Option<String> {
        String::from_utf8(bytes.to_vec()).ok()
    }
}

/// A part of the map: keys that begin with the same byte, and values of one type.
pub(crate) struct Table<K: ?Sized, V> {
    tag: u8,
    /// What a value is, for errors.
    what: &'static str,
    types: PhantomData<fn(&K) -> V>,
}

impl<K: Key + ?Sized, V: Serialize + DeserializeOwned> Table<K, V> {
    pub(crate) const fn new(tag: u8, what: &'static str) -> Self {
        Self { tag, what, types: PhantomData }
    }

    pub(crate) fn key(&self, key: &K) -> Vec<u8> {
        let mut bytes = vec![self.tag];
        key.write(&mut bytes);
        bytes
    }

    /// A key with its value; no value removes it.
    ///
    /// # Errors
    /// [`IndexError::Codec`].
    pub(crate) fn record(&self, key: &K, value: Option<&V>) -> Result<Record, IndexError> {
        let key = self.key(key);
        let bytes = value.map(encode).transpose().map_err(|reason| {
            let id = String::from_utf8_lossy(&key[1..]).into_owned();
            IndexError::Codec { id, reason }
        })?;
        Ok((key, bytes))
    }

    /// Puts a value, or removes it.
    ///
    /// # Errors
    /// As of [`record`](Self::record).
    pub(crate) fn put(&self, changes: &mut Changes, key: &K, value: Option<&V>) -> Result<(), IndexError> {
        changes.extend([self.record(key, value)?]);
        Ok(())
    }

    pub(crate) fn get(&self, view: View<'_>, key: &K) -> Result<Option<V>, IndexError> {
        let bytes = view.get(&self.key(key))?;
        bytes.map(|bytes| self.decoded(view, &bytes)).transpose()
    }

    /// The rows whose keys begin with `prefix`, in ascending order.
    pub(crate) fn rows<'a>(
        &'a self,
        view: View<'a>,
        prefix: &[u8],
    ) -> impl Iterator<Item = Result<(K::Owned, V), IndexError>> + use<'a, K, V> {
        let prefix = [&[self.tag], prefix].concat();
        let records = view.records(&prefix);
        let is_inside = move |record: &Result<Record, _>| {
            record.as_ref().map_or(true, |(key, _)| key.starts_with(&prefix))
        };
        records.take_while(is_inside).filter_map(move |record| self.row(view, record).transpose())
    }

    /// A record as a row; `None` if its key is removed.
    fn row(
        &self,
        view: View<'_>,
        record: Result<Record, IndexError>,
    ) -> Result<Option<(K::Owned, V)>, IndexError> {
        let (key, Some(value)) = record? else { return Ok(None) };
        let key = K::read(&key[1..]).ok_or_else(|| view.damaged(format!("{} has no key", self.what)))?;
        Ok(Some((key, self.decoded(view, &value)?)))
    }

    fn decoded(&self, view: View<'_>, bytes: &[u8]) -> Result<V, IndexError> {
        decode(bytes).map_err(|error| view.damaged(format!("{}: {error}", self.what)))
    }

    /// The keys that the log has changed, and whether they have a value.
    pub(crate) fn changed(&self, view: View<'_>) -> Vec<(K::Owned, bool)> {
        let prefix = [self.tag];
        let keys = view.log.into_iter().flat_map(|log| log.keys(&prefix));
        keys.filter_map(|(key, is_there)| Some((K::read(&key[1..])?, is_there))).collect()
    }
}

/// A file, a log, or a log over a file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View<'a> {
    path: &'a Path,
    log: Option<&'a Log>,
    file: Option<&'a StoredFile>,
}

impl<'a> View<'a> {
    pub(crate) fn of_file(file: &'a StoredFile) -> Self {
        Self { path: file.path(), log: None, file: Some(file) }
    }

    pub(crate) fn of_log(log: &'a Log, file: Option<&'a StoredFile>) -> Self {
        Self { path: log.path(), log: Some(log), file }
    }

    /// Bytes of what it reads, which limits what it can hold.
    pub(crate) fn n_bytes(&self) -> u64 {
        self.file.map_or(0, StoredFile::n_bytes) + self.log.map_or(0, Log::n_bytes)
    }

    pub(crate) fn damaged(&self, what: impl Into<String>) -> IndexError {
        IndexError::damaged(self.path, what)
    }

    fn get(&self, key: &[u8]) -> Result<Option<Vec<u8>>, IndexError> {
        match self.log.map_or(Ok(None), |log| log.get(key))? {
            Some(changed) => Ok(changed),
            None => self.file.map_or(Ok(None), |file| file.get(key)),
        }
    }

    /// The runs of everything from a key on, what counts more first.
    fn runs(self, from: &[u8]) -> Vec<Run<'a>> {
        let of_file = self.file.into_iter().flat_map(|file| file.runs(from).collect::<Vec<_>>());
        self.log.map(|log| log.run(from)).into_iter().chain(of_file).collect()
    }

    /// Everything from a key on.
    pub(crate) fn records(self, from: &[u8]) -> Rows<'a> {
        Rows::of(self.runs(from))
    }

    /// Everything, with further changes.
    pub(crate) fn records_with(self, changes: &'a Changes) -> Rows<'a> {
        Rows::of(std::iter::once(run_of(changes, &[])).chain(self.runs(&[])).collect())
    }

    /// Appends the log and further changes to the file. Returns whether it did; see [`StoredFile::append`].
    pub(crate) fn append(self, changes: &'a Changes) -> Result<bool, IndexError> {
        let Some(file) = self.file else { return Ok(false) };
        let n_changes: usize =
            changes.iter().map(|(key, value)| key.len() + value.iter().map(Vec::len).sum::<usize>()).sum();
        let n_bytes = n_changes as u64 + self.log.map_or(0, Log::n_bytes);
        let runs = std::iter::once(run_of(changes, &[])).chain(self.log.map(|log| log.run(&[]))).collect();
        file.append(runs, n_bytes)
    }
}
