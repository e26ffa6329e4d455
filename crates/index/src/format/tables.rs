//! The tables of the database, and how to read and write them.

use std::path::Path;

use redb::{
    Database, ReadTransaction, ReadableDatabase, ReadableTable, ReadableTableMetadata, TableDefinition,
    TableError, WriteTransaction,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::IndexError;
use super::codec::{Floats, decode, encode};
use crate::{Shape, ShapeEntry, ShapeVectors};

/// A table with names as keys.
type Named = TableDefinition<'static, &'static str, &'static [u8]>;

/// Shape -> its entry.
pub(crate) const ENTRIES: Named = TableDefinition::new("entries");
/// Shape -> its fused vector.
pub(crate) const FUSED: Named = TableDefinition::new("fused");
/// Shape -> its signatures and form.
pub(crate) const BODIES: Named = TableDefinition::new("bodies");
/// Properties of the whole index, by name.
const ABOUT: Named = TableDefinition::new("about");

/// Memory for cached pages of an open index.
pub(crate) const CACHE: usize = 64 << 20;

/// A database with the path and the action that errors name.
#[derive(Debug)]
pub(crate) struct Store<'a> {
    pub(crate) database: &'a Database,
    pub(crate) path: &'a Path,
    /// `read` or `write`, for errors.
    pub(crate) action: &'static str,
}

impl Store<'_> {
    pub(super) fn error(&self, error: impl Into<redb::Error>) -> IndexError {
        database_error(self.path, self.action, error)
    }

    pub(crate) fn read(&self) -> Result<Snapshot<'_>, IndexError> {
        let transaction = self.database.begin_read().at(self)?;
        Ok(Snapshot { store: self, transaction })
    }

    /// Runs `work` in one transaction, which has an effect only if `work` succeeds.
    pub(crate) fn write<T>(
        &self,
        work: impl FnOnce(&WriteTransaction) -> Result<T, IndexError>,
    ) -> Result<T, IndexError> {
        let transaction = self.database.begin_write().at(self)?;
        let result = work(&transaction)?;
        transaction.commit().at(self)?;
        Ok(result)
    }

    pub(super) fn decoded<T: DeserializeOwned>(&self, bytes: &[u8], what: &str) -> Result<T, IndexError> {
        decode(bytes).map_err(|error| IndexError::damaged(self.path, format!("{what}: {error}")))
    }

    /// Writes a value under a name, replacing an earlier one.
    fn insert<T: Serialize>(
        &self,
        transaction: &WriteTransaction,
        table: Named,
        name: &str,
        value: &T,
    ) -> Result<(), IndexError> {
        let bytes = encode(value).map_err(|source| IndexError::Codec { id: name.to_owned(), source })?;
        transaction.open_table(table).at(self)?.insert(name, bytes.as_slice()).at(self)?;
        Ok(())
    }

    /// Writes a property of the whole index.
    pub(crate) fn set<T: Serialize>(
        &self,
        transaction: &WriteTransaction,
        name: &str,
        value: &T,
    ) -> Result<(), IndexError> {
        self.insert(transaction, ABOUT, name, value)
    }

    /// Writes a shape over the one of the same name.
    pub(crate) fn put(&self, transaction: &WriteTransaction, shape: &Shape) -> Result<(), IndexError> {
        self.put_entry(transaction, &shape.id, &shape.entry)?;
        self.insert(transaction, FUSED, &shape.id, &Floats(shape.vectors.fused.clone()))?;
        self.insert(transaction, BODIES, &shape.id, &StoredBody::new(&shape.vectors))
    }

    pub(crate) fn put_entry(
        &self,
        transaction: &WriteTransaction,
        id: &str,
        entry: &ShapeEntry,
    ) -> Result<(), IndexError> {
        self.insert(transaction, ENTRIES, id, entry)
    }

    /// Removes a shape. Returns whether it existed.
    pub(crate) fn remove(&self, transaction: &WriteTransaction, id: &str) -> Result<bool, IndexError> {
        let mut existed = false;
        for table in [ENTRIES, FUSED, BODIES] {
            existed |= transaction.open_table(table).at(self)?.remove(id).at(self)?.is_some();
        }
        Ok(existed)
    }
}

/// A consistent view of the database, unaffected by later writes.
pub(crate) struct Snapshot<'a> {
    pub(super) store: &'a Store<'a>,
    transaction: ReadTransaction,
}

impl Snapshot<'_> {
    /// Opens a table; `None` if it was never written to.
    pub(super) fn table<K: redb::Key + 'static>(
        &self,
        table: TableDefinition<'static, K, &'static [u8]>,
    ) -> Result<Option<redb::ReadOnlyTable<K, &'static [u8]>>, IndexError> {
        match self.transaction.open_table(table) {
            Ok(table) => Ok(Some(table)),
            Err(TableError::TableDoesNotExist(_)) => Ok(None),
            Err(error) => Err(self.store.error(error)),
        }
    }

    fn value<T: DeserializeOwned>(&self, table: Named, key: &str) -> Result<Option<T>, IndexError> {
        let Some(table) = self.table(table)? else { return Ok(None) };
        let found = table.get(key).at(self.store)?;
        found.map(|bytes| self.store.decoded(bytes.value(), key)).transpose()
    }

    /// A property of the whole index.
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
        Ok(body.zip(self.fused(id)?).map(|(body, fused)| body.with(fused)))
    }

    /// Number of shapes.
    pub(crate) fn len(&self) -> Result<usize, IndexError> {
        let Some(table) = self.table(ENTRIES)? else { return Ok(0) };
        Ok(table.len().at(self.store)? as usize)
    }

    /// The keys of a table, ascending.
    pub(crate) fn keys(&self, table: Named) -> Result<Vec<String>, IndexError> {
        let Some(table) = self.table(table)? else { return Ok(Vec::new()) };
        let rows = table.iter().at(self.store)?;
        rows.map(|row| Ok(row.at(self.store)?.0.value().to_owned())).collect()
    }

    /// Calls `visit` with each key and value of a table, in ascending order of the keys.
    pub(crate) fn each<T: DeserializeOwned, E: From<IndexError>>(
        &self,
        table: Named,
        mut visit: impl FnMut(&str, T) -> Result<(), E>,
    ) -> Result<(), E> {
        let Some(table) = self.table(table)? else { return Ok(()) };
        for row in table.iter().at(self.store)? {
            let (key, bytes) = row.at(self.store)?;
            visit(key.value(), self.store.decoded(bytes.value(), key.value())?)?;
        }
        Ok(())
    }
}

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

/// Turns results of the database into results whose errors name the file.
pub(super) trait At<T> {
    fn at(self, store: &Store<'_>) -> Result<T, IndexError>;
}

impl<T, E: Into<redb::Error>> At<T> for Result<T, E> {
    fn at(self, store: &Store<'_>) -> Result<T, IndexError> {
        self.map_err(|error| store.error(error))
    }
}

/// Turns an error of the database into one that names the file.
pub(crate) fn database_error(path: &Path, action: &'static str, error: impl Into<redb::Error>) -> IndexError {
    match error.into() {
        redb::Error::Io(source) if source.kind() == std::io::ErrorKind::InvalidData => {
            IndexError::damaged(path, source.to_string())
        }
        redb::Error::Io(source) => IndexError::Io { action, path: path.to_owned(), source },
        redb::Error::DatabaseAlreadyOpen => IndexError::Busy(path.to_owned()),
        other => IndexError::damaged(path, other.to_string()),
    }
}
