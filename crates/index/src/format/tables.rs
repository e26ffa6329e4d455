//! The tables of the database, and how to read and write them.

use std::collections::BTreeMap;
use std::path::Path;

use redb::{
    Database, ReadTransaction, ReadableDatabase, ReadableTable, ReadableTableMetadata, TableDefinition,
    TableError, WriteTransaction,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::IndexError;
use super::codec::{Floats, decode, encode};
use super::guard::{Guarded, guarded};
use crate::{Shape, ShapeEntry, ShapeVectors};

/// A table with names as keys.
type Named = TableDefinition<'static, &'static str, &'static [u8]>;

/// Shape -> its entry.
pub(crate) const ENTRIES: Named = TableDefinition::new("entries");
/// Shape -> its fused vector.
pub(crate) const FUSED: Named = TableDefinition::new("fused");
/// Shape -> its signatures and form.
pub(crate) const BODIES: Named = TableDefinition::new("bodies");
/// Class -> number of its shapes.
pub(super) const CLASSES: Named = TableDefinition::new("classes");
/// Shapes that a writer has put, removed or changed while cells [follow](CellState::Follow).
pub(crate) const CHANGED: Named = TableDefinition::new("changed");
/// Properties of the whole index, by name.
const ABOUT: Named = TableDefinition::new("about");

/// Memory for cached pages of an open index.
pub(crate) const CACHE: usize = 64 << 20;

/// A database with the path and the action that errors name.
#[derive(Debug)]
pub(crate) struct Store<'a> {
    pub(crate) database: &'a Guarded<Database>,
    pub(crate) path: &'a Path,
    /// `read` or `write`, for errors.
    pub(crate) action: &'static str,
    /// Size of the database in bytes, which limits what it can hold.
    pub(crate) n_bytes: u64,
}

/// Calls redb. The only function that does: its panics become [`IndexError::Damaged`].
pub(crate) fn call<T, E: Into<redb::Error>>(
    path: &Path,
    action: &'static str,
    operation: impl FnOnce() -> Result<T, E>,
) -> Result<T, IndexError> {
    match guarded(operation) {
        Ok(result) => result.map_err(|error| database_error(path, action, error)),
        Err(panic) => Err(IndexError::damaged(path, format!("its database contradicts itself ({panic})"))),
    }
}

impl Store<'_> {
    pub(super) fn call<T, E: Into<redb::Error>>(
        &self,
        operation: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, IndexError> {
        call(self.path, self.action, operation)
    }

    pub(super) fn damaged(&self, what: impl Into<String>) -> IndexError {
        IndexError::damaged(self.path, what)
    }

    pub(crate) fn read(&self) -> Result<Snapshot<'_>, IndexError> {
        let transaction = self.call(|| self.database.begin_read())?;
        Ok(Snapshot { store: self, transaction: Guarded::new(transaction) })
    }

    /// Runs `work` in one transaction, which has an effect only if `work` succeeds.
    pub(crate) fn write<T>(
        &self,
        work: impl FnOnce(&WriteTransaction) -> Result<T, IndexError>,
    ) -> Result<T, IndexError> {
        let transaction = Guarded::new(self.call(|| self.database.begin_write())?);
        let result = work(&transaction)?;
        if let Some(transaction) = transaction.into_inner() {
            self.call(|| transaction.commit())?;
        }
        Ok(result)
    }

    pub(super) fn decoded<T: DeserializeOwned>(&self, bytes: &[u8], what: &str) -> Result<T, IndexError> {
        decode(bytes).map_err(|error| self.damaged(format!("{what}: {error}")))
    }

    /// Writes a value under a name. Returns the bytes of the one that it replaces.
    fn insert<T: Serialize>(
        &self,
        transaction: &WriteTransaction,
        table: Named,
        name: &str,
        value: &T,
    ) -> Result<Option<Vec<u8>>, IndexError> {
        let bytes = encode(value).map_err(|source| IndexError::Codec { id: name.to_owned(), source })?;
        self.call(|| {
            let mut table = Guarded::new(transaction.open_table(table)?);
            let before = table.insert(name, bytes.as_slice())?;
            Ok::<_, redb::Error>(before.map(|bytes| bytes.value().to_vec()))
        })
    }

    /// Writes a property of the whole index.
    pub(crate) fn set<T: Serialize>(
        &self,
        transaction: &WriteTransaction,
        name: &str,
        value: &T,
    ) -> Result<(), IndexError> {
        self.insert(transaction, ABOUT, name, value).map(drop)
    }

    #[cfg(test)]
    pub(crate) fn remove_property(
        &self,
        transaction: &WriteTransaction,
        name: &str,
    ) -> Result<(), IndexError> {
        self.call(|| {
            let mut table = Guarded::new(transaction.open_table(ABOUT)?);
            table.remove(name)?;
            Ok::<_, redb::Error>(())
        })
    }

    /// Writes a shape over the one of the same name.
    pub(crate) fn put(
        &self,
        transaction: &WriteTransaction,
        shape: &Shape,
        changes: &mut Changes,
    ) -> Result<(), IndexError> {
        self.put_entry(transaction, &shape.id, &shape.entry, changes)?;
        self.insert(transaction, FUSED, &shape.id, &Floats(shape.vectors.fused.clone()))?;
        self.insert(transaction, BODIES, &shape.id, &StoredBody::new(&shape.vectors)).map(drop)
    }

    pub(crate) fn put_entry(
        &self,
        transaction: &WriteTransaction,
        id: &str,
        entry: &ShapeEntry,
        changes: &mut Changes,
    ) -> Result<(), IndexError> {
        let before = self.insert(transaction, ENTRIES, id, entry)?;
        let before: Option<ShapeEntry> = before.map(|bytes| self.decoded(&bytes, id)).transpose()?;
        changes.count(before.as_ref(), Some(entry));
        self.list(transaction, id, changes)
    }

    /// Removes a shape. Returns whether it existed.
    pub(crate) fn remove(
        &self,
        transaction: &WriteTransaction,
        id: &str,
        changes: &mut Changes,
    ) -> Result<bool, IndexError> {
        let take = |table: Named| {
            self.call(|| {
                let mut table = Guarded::new(transaction.open_table(table)?);
                let before = table.remove(id)?;
                Ok::<_, redb::Error>(before.map(|bytes| bytes.value().to_vec()))
            })
        };
        let before = take(ENTRIES)?;
        let existed = take(FUSED)?.is_some() | take(BODIES)?.is_some() | before.is_some();
        let before: Option<ShapeEntry> = before.map(|bytes| self.decoded(&bytes, id)).transpose()?;
        changes.count(before.as_ref(), None);
        self.list(transaction, id, changes)?;
        Ok(existed)
    }

    fn list(&self, transaction: &WriteTransaction, id: &str, changes: &Changes) -> Result<(), IndexError> {
        match changes.cells {
            CellState::Follow => self.insert(transaction, CHANGED, id, &()).map(drop),
            CellState::Current | CellState::Stale => Ok(()),
        }
    }

    /// Ends a transaction that changes shapes: updates the numbers of shapes in classes and the state of the cells.
    pub(crate) fn end_changes(
        &self,
        transaction: &WriteTransaction,
        changes: &Changes,
    ) -> Result<(), IndexError> {
        if changes.cells == CellState::Current {
            self.set(transaction, "cells", &CellState::Stale)?;
        }
        for (class, change) in changes.classes.iter().filter(|(_, change)| **change != 0) {
            let before = self.call(|| {
                let table = Guarded::new(transaction.open_table(CLASSES)?);
                let bytes = table.get(class.as_str())?;
                Ok::<_, redb::Error>(bytes.map(|bytes| bytes.value().to_vec()))
            })?;
            let before: u64 = before.map_or(Ok(0), |bytes| self.decoded(&bytes, class))?;
            match before.saturating_add_signed(*change) {
                0 => self.call(|| {
                    let mut table = Guarded::new(transaction.open_table(CLASSES)?);
                    table.remove(class.as_str())?;
                    Ok::<_, redb::Error>(())
                })?,
                n => self.insert(transaction, CLASSES, class, &n).map(drop)?,
            }
        }
        Ok(())
    }

    /// Makes sure that the table of classes exists, which format 1 does not have.
    pub(crate) fn make_classes(&self, transaction: &WriteTransaction) -> Result<(), IndexError> {
        let snapshot = self.read()?;
        if snapshot.has(CLASSES)? {
            return Ok(());
        }
        self.call(|| transaction.open_table(CLASSES).map(|table| drop(Guarded::new(table))))?;
        let mut changes = Changes::new(CellState::Stale);
        snapshot.each(ENTRIES, |_, entry| {
            changes.count(None, Some(&entry));
            Ok::<(), IndexError>(())
        })?;
        self.end_changes(transaction, &changes)
    }
}

/// How the cells of a database relate to its shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum CellState {
    /// They hold all shapes.
    Current,
    /// They hold the shapes of the base; [`CHANGED`] lists what has changed since.
    Follow,
    /// There are none, or nobody knows what they hold.
    Stale,
}

/// What a transaction changes beside the shapes themselves.
#[derive(Debug)]
pub(crate) struct Changes {
    /// How many shapes classes gain or lose.
    classes: BTreeMap<String, i64>,
    /// The state of the cells before.
    cells: CellState,
}

impl Changes {
    pub(crate) fn new(cells: CellState) -> Self {
        Self { classes: BTreeMap::new(), cells }
    }

    fn count(&mut self, before: Option<&ShapeEntry>, now: Option<&ShapeEntry>) {
        for (entry, change) in [(before, -1), (now, 1)] {
            if let Some(entry) = entry.filter(|entry| !entry.label.is_empty()) {
                *self.classes.entry(entry.label.clone()).or_default() += change;
            }
        }
    }
}

/// A consistent view of the database, unaffected by later writes.
pub(crate) struct Snapshot<'a> {
    pub(super) store: &'a Store<'a>,
    transaction: Guarded<ReadTransaction>,
}

impl Snapshot<'_> {
    /// Whether a table was ever written to.
    pub(super) fn has<K: redb::Key + 'static>(
        &self,
        table: TableDefinition<'static, K, &'static [u8]>,
    ) -> Result<bool, IndexError> {
        Ok(self.table(table)?.is_some())
    }

    /// The number of shapes in each class.
    pub(crate) fn classes(&self) -> Result<BTreeMap<String, u64>, IndexError> {
        if self.has(CLASSES)? {
            return Ok(self.all(CLASSES)?.into_iter().collect());
        }
        let mut classes = BTreeMap::new();
        self.each(ENTRIES, |_, entry: ShapeEntry| {
            if !entry.label.is_empty() {
                *classes.entry(entry.label).or_default() += 1;
            }
            Ok::<(), IndexError>(())
        })?;
        Ok(classes)
    }

    /// Opens a table; `None` if it was never written to.
    pub(super) fn table<K: redb::Key + 'static>(
        &self,
        table: TableDefinition<'static, K, &'static [u8]>,
    ) -> Result<Option<Guarded<Table<K>>>, IndexError> {
        self.store.call(|| match self.transaction.open_table(table) {
            Ok(table) => Ok(Some(Guarded::new(table))),
            Err(TableError::TableDoesNotExist(_)) => Ok(None),
            Err(error) => Err(error),
        })
    }

    /// The bytes of a value.
    pub(super) fn bytes<'k, K: redb::Key + 'static>(
        &self,
        table: TableDefinition<'static, K, &'static [u8]>,
        key: impl std::borrow::Borrow<K::SelfType<'k>>,
    ) -> Result<Option<Vec<u8>>, IndexError> {
        let Some(table) = self.table(table)? else { return Ok(None) };
        self.store.call(|| Ok::<_, redb::Error>(table.get(key)?.map(|bytes| bytes.value().to_vec())))
    }

    fn value<T: DeserializeOwned>(&self, table: Named, key: &str) -> Result<Option<T>, IndexError> {
        let found = self.bytes(table, key)?;
        found.map(|bytes| self.store.decoded(&bytes, key)).transpose()
    }

    /// A property of the whole index.
    pub(crate) fn about<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, IndexError> {
        self.value(ABOUT, name)
    }

    pub(crate) fn entry(&self, id: &str) -> Result<Option<ShapeEntry>, IndexError> {
        self.value(ENTRIES, id)
    }

    pub(crate) fn fused(&self, id: &str) -> Result<Option<Vec<f32>>, IndexError> {
        self.fused_vectors()?.get(id)
    }

    /// All fused vectors, for many reads: opening a table costs about as much as a read.
    pub(crate) fn fused_vectors(&self) -> Result<FusedVectors<'_>, IndexError> {
        Ok(FusedVectors { store: self.store, table: self.table(FUSED)? })
    }

    pub(crate) fn vectors(&self, id: &str) -> Result<Option<ShapeVectors>, IndexError> {
        let body: Option<StoredBody> = self.value(BODIES, id)?;
        Ok(body.zip(self.fused(id)?).map(|(body, fused)| body.with(fused)))
    }

    /// Number of shapes.
    pub(crate) fn len(&self) -> Result<usize, IndexError> {
        let Some(table) = self.table(ENTRIES)? else { return Ok(0) };
        let length = self.store.call(|| table.len())?;
        if length > self.most_rows() {
            let n_bytes = self.store.n_bytes;
            return Err(self.store.damaged(format!("{length} shapes do not fit into {n_bytes} bytes")));
        }
        Ok(length as usize)
    }

    /// No table holds more rows: each takes several bytes.
    fn most_rows(&self) -> u64 {
        self.store.n_bytes / 4
    }

    /// The keys of a table, ascending.
    pub(crate) fn keys(&self, table: Named) -> Result<Vec<String>, IndexError> {
        let mut keys = Vec::new();
        self.each_row(table, |key, _| {
            keys.push(key);
            Ok::<(), IndexError>(())
        })?;
        Ok(keys)
    }

    /// The keys and values of a table, in ascending order of the keys.
    pub(crate) fn all<T: DeserializeOwned>(&self, table: Named) -> Result<Vec<(String, T)>, IndexError> {
        let mut rows = Vec::new();
        self.each(table, |key, value| {
            rows.push((key.to_owned(), value));
            Ok::<(), IndexError>(())
        })?;
        Ok(rows)
    }

    /// Calls `visit` with each key and value of a table, in ascending order of the keys.
    pub(crate) fn each<T: DeserializeOwned, E: From<IndexError>>(
        &self,
        table: Named,
        mut visit: impl FnMut(&str, T) -> Result<(), E>,
    ) -> Result<(), E> {
        self.each_row(table, |key, bytes| visit(&key, self.store.decoded(&bytes, &key)?))
    }

    fn each_row<E: From<IndexError>>(
        &self,
        table: Named,
        mut visit: impl FnMut(String, Vec<u8>) -> Result<(), E>,
    ) -> Result<(), E> {
        let Some(table) = self.table(table)? else { return Ok(()) };
        let rows = self.store.call(|| table.range::<&str>(..))?;
        self.store.each_row(rows, str::to_owned, |key, bytes| visit(key.clone(), bytes))
    }
}

impl Store<'_> {
    /// Calls `visit` with each key, made by `own`, and value of a range of a table, in ascending order of the keys.
    pub(super) fn each_row<K: redb::Key + 'static, O: Ord, E: From<IndexError>>(
        &self,
        rows: redb::Range<'static, K, &'static [u8]>,
        own: impl Fn(K::SelfType<'_>) -> O,
        mut visit: impl FnMut(&O, Vec<u8>) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut rows = Guarded::new(rows);
        let mut last = None;
        loop {
            let row = self.call(|| match rows.next() {
                None => Ok(None),
                Some(Ok((key, bytes))) => Ok(Some((own(key.value()), bytes.value().to_vec()))),
                Some(Err(error)) => Err(error),
            })?;
            let Some((key, bytes)) = row else { return Ok(()) };
            // A tree that was forged may visit its pages again and again.
            if last.is_some_and(|last| last >= key) {
                return Err(self.damaged("the rows of a table are out of order").into());
            }
            visit(&key, bytes)?;
            last = Some(key);
        }
    }
}

/// The fused vectors of an index.
pub(crate) struct FusedVectors<'a> {
    store: &'a Store<'a>,
    /// `None` if the index is empty.
    table: Option<Guarded<Table<&'static str>>>,
}

impl FusedVectors<'_> {
    /// `None` if there is no shape of this name.
    pub(crate) fn get(&self, id: &str) -> Result<Option<Vec<f32>>, IndexError> {
        let Some(table) = &self.table else { return Ok(None) };
        let bytes =
            self.store.call(|| Ok::<_, redb::Error>(table.get(id)?.map(|bytes| bytes.value().to_vec())))?;
        bytes.map(|bytes| Ok(self.store.decoded::<Floats>(&bytes, id)?.0)).transpose()
    }
}

/// A table as a reader sees it.
pub(super) type Table<K> = redb::ReadOnlyTable<K, &'static [u8]>;

/// Signatures and form as stored; the fused vector is stored separately.
#[derive(Serialize, Deserialize)]
struct StoredBody {
    signatures: Vec<(String, Floats)>,
    form: Floats,
}

impl StoredBody {
    fn new(vectors: &ShapeVectors) -> Self {
        let signatures = vectors.signatures.iter();
        Self {
            signatures: signatures.map(|(name, values)| (name.clone(), Floats(values.clone()))).collect(),
            form: Floats(vectors.form.as_flattened().to_vec()),
        }
    }

    fn with(self, fused: Vec<f32>) -> ShapeVectors {
        ShapeVectors {
            fused,
            signatures: self.signatures.into_iter().map(|(name, values)| (name, values.0)).collect(),
            form: self.form.0.as_chunks::<4>().0.to_vec(),
        }
    }
}

/// Turns an error of the database into one that names the file.
fn database_error(path: &Path, action: &'static str, error: impl Into<redb::Error>) -> IndexError {
    match error.into() {
        redb::Error::Io(source) if source.kind() == std::io::ErrorKind::InvalidData => {
            IndexError::damaged(path, source.to_string())
        }
        redb::Error::Io(source) => IndexError::Io { action, path: path.to_owned(), source },
        redb::Error::DatabaseAlreadyOpen => IndexError::Busy(path.to_owned()),
        other => IndexError::damaged(path, other.to_string()),
    }
}
