//! Reading a finished index.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use redb::Database;

use crate::format::{CACHE, ENTRIES, Graph, Guarded, Heads, Overlay, Sealed, Snapshot, Store, call};
use crate::{IndexError, Shape, ShapeEntry, ShapeVectors};

/// A finished index, open for reading.
///
/// It keeps the state it had when it was opened, whatever writers do. Every byte is checked before it is used: all
/// methods that read may return [`IndexError::Io`] and [`IndexError::Damaged`].
#[derive(Debug)]
pub struct Index {
    path: PathBuf,
    database: Guarded<Database>,
    options: String,
    n_shapes: usize,
    pub(crate) sealed: Arc<Sealed>,
    /// Read with the first search.
    heads: OnceLock<Heads>,
}

impl Index {
    /// Opens an index. Shapes are read on demand.
    ///
    /// # Errors
    /// [`IndexError::Foreign`], [`IndexError::FutureVersion`], [`IndexError::Damaged`], [`IndexError::Io`].
    pub fn open(path: &Path) -> Result<Self, IndexError> {
        Self::of(path, Sealed::open(path)?)
    }

    pub(crate) fn of(path: &Path, sealed: Sealed) -> Result<Self, IndexError> {
        let sealed = Arc::new(sealed);
        let database = Guarded::new(call(path, "read", || {
            Database::builder().set_cache_size(CACHE).create_with_backend(Overlay::new(sealed.clone()))
        })?);
        let store = Store { database: &database, path, action: "read", n_bytes: sealed.n_bytes() };
        let about = store.read()?;
        let missing = || IndexError::damaged(path, "its options are missing");
        let options = about.about("options")?.ok_or_else(missing)?;
        let n_shapes = about.len()?;
        drop(about);
        Ok(Self { path: path.to_owned(), database, options, n_shapes, sealed, heads: OnceLock::new() })
    }

    pub(crate) fn store(&self) -> Store<'_> {
        Store { database: &self.database, path: &self.path, action: "read", n_bytes: self.sealed.n_bytes() }
    }

    /// What a search needs before it reads cells.
    pub(crate) fn heads(&self) -> Result<&Heads, IndexError> {
        if let Some(heads) = self.heads.get() {
            return Ok(heads);
        }
        let heads = Heads::read(&self.store())?;
        Ok(self.heads.get_or_init(|| heads))
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The options its shapes were described with.
    #[must_use]
    pub fn options(&self) -> &str {
        &self.options
    }

    /// Checks that its shapes were described with the options `requested`.
    ///
    /// # Errors
    /// [`IndexError::OtherOptions`].
    pub fn expect_options(&self, requested: &str) -> Result<(), IndexError> {
        match self.options == requested {
            true => Ok(()),
            false => Err(IndexError::OtherOptions {
                path: self.path.clone(),
                found: self.options.clone(),
                requested: requested.to_owned(),
            }),
        }
    }

    /// Number of shapes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.n_shapes
    }

    /// Whether the index holds no shapes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.n_shapes == 0
    }

    /// Whether it has a graph of nearest neighbours. Indexes of earlier formats have none until they are built again.
    pub fn has_graph(&self) -> Result<bool, IndexError> {
        Ok(Graph::open(&self.store().read()?)?.is_some())
    }

    /// A number that changes with the content of the file.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        self.sealed.fingerprint()
    }

    /// Version of the format of the file.
    #[must_use]
    pub fn format(&self) -> u32 {
        self.sealed.state.version
    }

    /// Size in bytes.
    #[must_use]
    pub fn n_bytes(&self) -> u64 {
        self.sealed.n_bytes()
    }

    /// The classes and the number of shapes in each. Shapes without a class do not count.
    pub fn classes(&self) -> Result<BTreeMap<String, u64>, IndexError> {
        self.store().read()?.classes()
    }

    fn with<T>(
        &self,
        read: impl FnOnce(&Snapshot<'_>) -> Result<Option<T>, IndexError>,
        id: &str,
    ) -> Result<T, IndexError> {
        let store = self.store();
        read(&store.read()?)?
            .ok_or_else(|| IndexError::NoSuchShape { path: self.path.clone(), id: id.to_owned() })
    }

    /// Whether there is a shape of this name.
    pub fn contains(&self, id: &str) -> Result<bool, IndexError> {
        Ok(self.store().read()?.entry(id)?.is_some())
    }

    /// The entry of a shape, or [`IndexError::NoSuchShape`].
    pub fn entry(&self, id: &str) -> Result<ShapeEntry, IndexError> {
        self.with(|snapshot| snapshot.entry(id), id)
    }

    /// The vectors of a shape, or [`IndexError::NoSuchShape`].
    pub fn vectors(&self, id: &str) -> Result<ShapeVectors, IndexError> {
        self.with(|snapshot| snapshot.vectors(id), id)
    }

    /// Calls `visit` with each shape in ascending order of names, up to its first error. Holds one shape in memory at a
    /// time.
    pub fn each<E: From<IndexError>>(&self, mut visit: impl FnMut(Shape) -> Result<(), E>) -> Result<(), E> {
        let store = self.store();
        let snapshot = store.read()?;
        snapshot.each(ENTRIES, |id, entry| {
            let missing = || IndexError::damaged(&self.path, format!("`{id}` has no vectors"));
            let vectors = snapshot.vectors(id)?.ok_or_else(missing)?;
            visit(Shape { id: id.to_owned(), entry, vectors })
        })
    }

    /// All names and entries, in ascending order of names.
    pub fn entries(&self) -> Result<Vec<(String, ShapeEntry)>, IndexError> {
        self.store().read()?.all(ENTRIES)
    }
}
