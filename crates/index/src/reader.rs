//! Reading a finished index.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;

use retrieval::UnknownThreshold;

use crate::derived::{about, vectors};
use crate::floats::Floats;
use crate::store::{StoredFile, View};
use crate::tables::{About, BODIES, CLASSES, ENTRIES, FUSED};
use crate::{IndexError, Shape, ShapeEntry, ShapeVectors, VectorTable};

/// A finished index, open for reading.
///
/// It keeps the state it had when it was opened, whatever writers do. Every byte is checked before it is used: all
/// methods that read may return [`IndexError::Io`] and [`IndexError::Damaged`].
#[derive(Debug)]
pub struct Index {
    options: String,
    n_shapes: usize,
    threshold: Option<UnknownThreshold>,
    pub(crate) stored: StoredFile,
    /// Read with the first search.
    vectors: OnceLock<VectorTable>,
}

impl Index {
    /// Opens an index. Shapes are read on demand.
    ///
    /// # Errors
    /// [`IndexError::Foreign`], [`IndexError::FutureVersion`], [`IndexError::PastVersion`], [`IndexError::Damaged`],
    /// [`IndexError::Io`].
    pub fn open(path: &Path) -> Result<Self, IndexError> {
        let stored = StoredFile::open(path)?;
        let about = about(View::of_file(&stored))?;
        let About { options, n: n_shapes, threshold, .. } = about;
        Ok(Self { options, n_shapes, threshold, stored, vectors: OnceLock::new() })
    }

    pub(crate) fn view(&self) -> View<'_> {
        View::of_file(&self.stored)
    }

    /// The fused vectors of all shapes, which stay in memory: `4 d` bytes and the name of each shape.
    pub fn vector_table(&self) -> Result<&VectorTable, IndexError> {
        if let Some(vectors) = self.vectors.get() {
            return Ok(vectors);
        }
        let vectors = vectors(self.view())?;
        if vectors.len() != self.n_shapes {
            return Err(self.view().damaged("the number of its vectors is wrong"));
        }
        Ok(self.vectors.get_or_init(|| vectors))
    }

    /// A query whose nearest shape is farther belongs to no class of the index; `None` if the classes are too small to
    /// tell. From at most 512 of the shapes when the index was finished.
    #[must_use]
    pub fn threshold(&self) -> Option<UnknownThreshold> {
        self.threshold
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.stored.path()
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
                path: self.path().to_owned(),
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

    /// A number that changes with the content of the file.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        self.stored.fingerprint()
    }

    /// Size in bytes.
    #[must_use]
    pub fn n_bytes(&self) -> u64 {
        self.stored.n_bytes()
    }

    /// The classes and the number of shapes in each. Shapes without a class do not count.
    pub fn classes(&self) -> Result<BTreeMap<String, u64>, IndexError> {
        CLASSES.rows(self.view(), &[]).collect()
    }

    fn missing(&self, id: &str) -> IndexError {
        IndexError::NoSuchShape { path: self.path().to_owned(), id: id.to_owned() }
    }

    /// Whether there is a shape of this name.
    pub fn contains(&self, id: &str) -> Result<bool, IndexError> {
        Ok(ENTRIES.get(self.view(), id)?.is_some())
    }

    /// The entry of a shape, or [`IndexError::NoSuchShape`].
    pub fn entry(&self, id: &str) -> Result<ShapeEntry, IndexError> {
        ENTRIES.get(self.view(), id)?.ok_or_else(|| self.missing(id))
    }

    /// The vectors of a shape, or [`IndexError::NoSuchShape`].
    pub fn vectors(&self, id: &str) -> Result<ShapeVectors, IndexError> {
        let (body, fused) = (BODIES.get(self.view(), id)?, FUSED.get(self.view(), id)?);
        let (body, fused) = body.zip(fused).ok_or_else(|| self.missing(id))?;
        Ok(body.with(fused.0))
    }

    /// Calls `visit` with each shape in ascending order of names, up to its first error. Holds one shape in memory at a
    /// time.
    pub fn each<E: From<IndexError>>(&self, mut visit: impl FnMut(Shape) -> Result<(), E>) -> Result<(), E> {
        let view = self.view();
        let (mut fused, mut bodies) = (FUSED.rows(view, &[]), BODIES.rows(view, &[]));
        for row in ENTRIES.rows(view, &[]) {
            let (id, entry) = row?;
            let fused = fused.next().transpose()?.filter(|(known, _)| *known == id);
            let body = bodies.next().transpose()?.filter(|(known, _)| *known == id);
            let Some(((_, Floats(fused)), (_, body))) = fused.zip(body) else {
                return Err(view.damaged(format!("`{id}` has no vectors")).into());
            };
            visit(Shape { id, entry, vectors: body.with(fused) })?;
        }
        match fused.next().is_some() || bodies.next().is_some() {
            true => Err(view.damaged("there are vectors without an entry").into()),
            false => Ok(()),
        }
    }

    /// All names and entries, in ascending order of names.
    pub fn entries(&self) -> Result<Vec<(String, ShapeEntry)>, IndexError> {
        ENTRIES.rows(self.view(), &[]).collect()
    }
}
