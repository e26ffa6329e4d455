//! What is where in the database, and how it is read and written.

use std::path::Path;

use redb::{
    Database, ReadTransaction, ReadableDatabase, ReadableTable, TableDefinition, TableError, WriteTransaction,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::codec::{Floats, decode, encode};
use super::shape::StoredBody;
use super::{IndexError, Shape, ShapeEntry, ShapeVectors};

/// Shape -> its facts.
pub(crate) const ENTRIES: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("entries");
/// Shape -> its searched vector.
pub(crate) const FUSED: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("fused");
/// Shape -> its signatures and form.
pub(crate) const BODIES: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("bodies");
/// One value each of what is true of the whole index.
pub(crate) const ABOUT: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("about");
/// Numbered parts of what is searched, made when the index is finished.
pub(crate) const SEARCH: TableDefinition<'_, (u8, u32, u32), &[u8]> = TableDefinition::new("search");

/// Memory for pages of an open index.
pub(crate) const CACHE: usize = 64 << 20;

/// A database with the path that errors name.
#[derive(Debug)]
pub(crate) struct Store<'a> {
    pub(crate) database: &'a Database,
    pub(crate) path: &'a Path,
    /// What is being done, for messages.
    pub(crate) action: &'static str,
}

impl Store<'_> {
    pub(crate) fn fault(&self, fault: impl Into<redb::Error>) -> IndexError {
        fault_at(self.path, self.action, fault)
    }

    pub(crate) fn read(&self) -> Result<Snapshot<'_>, IndexError> {
        let transaction = self.database.begin_read().map_err(|fault| self.fault(fault))?;
        Ok(Snapshot { store: self, transaction })
    }

    /// Runs `work` in one transaction: all of it happens, or nothing.
    pub(crate) fn write<T>(
        &self,
        work: impl FnOnce(&WriteTransaction) -> Result<T, IndexError>,
    ) -> Result<T, IndexError> {
        let transaction = self.database.begin_write().map_err(|fault| self.fault(fault))?;
        let result = work(&transaction)?;
        transaction.commit().map_err(|fault| self.fault(fault))?;
        Ok(result)
    }

    pub(crate) fn decoded<T: DeserializeOwned>(&self, bytes: &[u8], what: &str) -> Result<T, IndexError> {
        decode(bytes).map_err(|fault| IndexError::Damaged {
            path: self.path.to_owned(),
            what: format!("{what}: {fault}"),
        })
    }

    /// Writes one value of what is true of the whole index.
    pub(crate) fn set<T: Serialize>(
        &self,
        transaction: &WriteTransaction,
        name: &str,
        value: &T,
    ) -> Result<(), IndexError> {
        let bytes = encode(value).map_err(|source| IndexError::Codec { id: name.to_owned(), source })?;
        let mut table = transaction.open_table(ABOUT).map_err(|fault| self.fault(fault))?;
        table.insert(name, bytes.as_slice()).map_err(|fault| self.fault(fault))?;
        Ok(())
    }

    /// Writes a shape over what was there.
    pub(crate) fn put(&self, transaction: &WriteTransaction, shape: &Shape) -> Result<(), IndexError> {
        let id = shape.id.as_str();
        let refused = |source| IndexError::Codec { id: id.to_owned(), source };
        self.put_entry(transaction, id, &shape.entry)?;
        let fused = encode(&Floats(shape.vectors.fused.clone())).map_err(refused)?;
        let body = encode(&StoredBody::new(&shape.vectors)).map_err(refused)?;
        for (table, bytes) in [(FUSED, fused), (BODIES, body)] {
            let mut table = transaction.open_table(table).map_err(|fault| self.fault(fault))?;
            table.insert(id, bytes.as_slice()).map_err(|fault| self.fault(fault))?;
        }
        Ok(())
    }

    pub(crate) fn put_entry(
        &self,
        transaction: &WriteTransaction,
        id: &str,
        entry: &ShapeEntry,
    ) -> Result<(), IndexError> {
        let bytes = encode(entry).map_err(|source| IndexError::Codec { id: id.to_owned(), source })?;
        let mut table = transaction.open_table(ENTRIES).map_err(|fault| self.fault(fault))?;
        table.insert(id, bytes.as_slice()).map_err(|fault| self.fault(fault))?;
        Ok(())
    }

    /// Takes a shape away; whether it was there.
    pub(crate) fn remove(&self, transaction: &WriteTransaction, id: &str) -> Result<bool, IndexError> {
        let mut was_there = false;
        for table in [ENTRIES, FUSED, BODIES] {
            let mut table = transaction.open_table(table).map_err(|fault| self.fault(fault))?;
            was_there |= table.remove(id).map_err(|fault| self.fault(fault))?.is_some();
        }
        Ok(was_there)
    }
}

/// One state of the database, whatever is written meanwhile.
pub(crate) struct Snapshot<'a> {
    pub(crate) store: &'a Store<'a>,
    transaction: ReadTransaction,
}

type Bytes = redb::ReadOnlyTable<&'static str, &'static [u8]>;

impl Snapshot<'_> {
    /// A table, unless it was never written to.
    pub(crate) fn table<K: redb::Key + 'static>(
        &self,
        table: TableDefinition<'static, K, &'static [u8]>,
    ) -> Result<Option<redb::ReadOnlyTable<K, &'static [u8]>>, IndexError> {
        match self.transaction.open_table(table) {
            Ok(table) => Ok(Some(table)),
            Err(TableError::TableDoesNotExist(_)) => Ok(None),
            Err(fault) => Err(self.store.fault(fault)),
        }
    }

    fn value<T: DeserializeOwned>(
        &self,
        table: TableDefinition<'static, &'static str, &'static [u8]>,
        key: &str,
    ) -> Result<Option<T>, IndexError> {
        let Some(table): Option<Bytes> = self.table(table)? else { return Ok(None) };
        let found = table.get(key).map_err(|fault| self.store.fault(fault))?;
        found.map(|bytes| self.store.decoded(bytes.value(), key)).transpose()
    }

    pub(crate) fn about<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, IndexError> {
        self.value(ABOUT, name)
    }

    pub(crate) fn entry(&self, id: &str) -> Result<Option<ShapeEntry>, IndexError> {
        self.value(ENTRIES, id)
    }

    pub(crate) fn fused(&self, id: &str) -> Result<Option<Vec<f32>>, IndexError> {
        Ok(self.value::<Floats>(FUSED, id)?.map(|floats| floats.0))
    }

    pub(crate) fn vectors(&self, id: &str) -> Result<Option<ShapeVectors>, IndexError> {
        let body: Option<StoredBody> = self.value(BODIES, id)?;
        let fused: Option<Floats> = self.value(FUSED, id)?;
        Ok(body.zip(fused).map(|(body, fused)| body.with(fused)))
    }

    /// Number of shapes.
    pub(crate) fn len(&self) -> Result<usize, IndexError> {
        use redb::ReadableTableMetadata;
        let Some(table) = self.table(ENTRIES)? else { return Ok(0) };
        Ok(table.len().map_err(|fault| self.store.fault(fault))? as usize)
    }

    /// The keys of a table, ascending.
    pub(crate) fn keys(
        &self,
        table: TableDefinition<'static, &'static str, &'static [u8]>,
    ) -> Result<Vec<String>, IndexError> {
        let Some(table): Option<Bytes> = self.table(table)? else { return Ok(Vec::new()) };
        let rows = table.iter().map_err(|fault| self.store.fault(fault))?;
        rows.map(|row| Ok(row.map_err(|fault| self.store.fault(fault))?.0.value().to_owned())).collect()
    }

    /// Calls `visit` with every key of a table in ascending order, and its value.
    pub(crate) fn each<T: DeserializeOwned, E: From<IndexError>>(
        &self,
        table: TableDefinition<'static, &'static str, &'static [u8]>,
        mut visit: impl FnMut(&str, T) -> Result<(), E>,
    ) -> Result<(), E> {
        let Some(table): Option<Bytes> = self.table(table)? else { return Ok(()) };
        for row in table.iter().map_err(|fault| self.store.fault(fault))? {
            let (key, bytes) = row.map_err(|fault| self.store.fault(fault))?;
            visit(key.value(), self.store.decoded(bytes.value(), key.value())?)?;
        }
        Ok(())
    }
}

/// An error of the database in the terms of the file.
pub(crate) fn fault_at(path: &Path, action: &'static str, fault: impl Into<redb::Error>) -> IndexError {
    let path = path.to_owned();
    match fault.into() {
        redb::Error::Io(source) if source.kind() == std::io::ErrorKind::InvalidData => {
            IndexError::Damaged { path, what: source.to_string() }
        }
        redb::Error::Io(source) => IndexError::Io { action, path, source },
        redb::Error::DatabaseAlreadyOpen => IndexError::Busy { path },
        other => IndexError::Damaged { path, what: other.to_string() },
    }
}
