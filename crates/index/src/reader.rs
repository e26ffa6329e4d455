//! Reading an index.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use base::ContentHash;

use crate::database::{Database, EntryRow, log_path, meta, vector_row};
use crate::{Entry, IndexError, Shape, VectorTable};

/// An index, open for reading.
///
/// It keeps the state it had when it was opened, whatever writers do. Every value is checked before it is used: all
/// methods that read may return [`IndexError::Io`] and [`IndexError::Damaged`].
#[derive(Debug)]
pub struct Index {
    database: Mutex<Database>,
    /// The file.
    pub path: PathBuf,
    /// The options its shapes were described with.
    pub options: String,
    n_shapes: usize,
    /// The number of transactions that led to this state.
    pub change: u64,
    /// Whether its writer finished it. One that was interrupted, or is at work, has put some of the shapes only.
    pub is_finished: bool,
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
        let database = Database::read(path)?;
        let missing = || database.damaged("it does not state how its shapes were described");
        Ok(Self {
            options: database.meta(meta::OPTIONS)?.ok_or_else(missing)?,
            n_shapes: usize::try_from(database.count(meta::SHAPES)?).unwrap_or(usize::MAX),
            change: database.count(meta::CHANGE)?,
            is_finished: database.meta(meta::UNFINISHED)?.is_none(),
            path: path.to_owned(),
            database: Mutex::new(database),
            vectors: OnceLock::new(),
        })
    }

    /// A failed read leaves nothing behind, so that a poisoned lock is harmless.
    pub(crate) fn database(&self) -> MutexGuard<'_, Database> {
        self.database.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The fused vectors of all shapes, which stay in memory: `4 d` bytes and the name of each shape.
    pub fn vector_table(&self) -> Result<&VectorTable, IndexError> {
        if let Some(vectors) = self.vectors.get() {
            return Ok(vectors);
        }
        let vectors = vectors(&self.database())?;
        self.expect_all(vectors.len())?;
        Ok(self.vectors.get_or_init(|| vectors))
    }

    /// A [note](crate::IndexWriter::set_note), if there is one of this name.
    pub fn note(&self, name: &'static str) -> Result<Option<String>, IndexError> {
        self.database().meta(name)
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
    pub fn len(&self) -> usize {
        self.n_shapes
    }

    /// Whether the index holds no shapes.
    pub fn is_empty(&self) -> bool {
        self.n_shapes == 0
    }

    /// Size in bytes, with what a writer has not copied into the file yet.
    pub fn n_bytes(&self) -> u64 {
        let files = [self.path.clone(), log_path(&self.path)];
        files.iter().filter_map(|file| Some(std::fs::metadata(file).ok()?.len())).sum()
    }

    /// The classes and the number of shapes in each. Shapes without a class do not count.
    pub fn classes(&self) -> Result<BTreeMap<String, u64>, IndexError> {
        let sql = "SELECT label, count(*) FROM shapes WHERE label <> '' GROUP BY label";
        let classes = self.database().all(sql, [], |row| Ok((row.get(0)?, row.get(1)?)))?;
        Ok(classes.into_iter().collect())
    }

    /// Whether there is a shape of this name.
    pub fn contains(&self, id: &str) -> Result<bool, IndexError> {
        Ok(find(&self.database(), id)?.is_some())
    }

    /// What is known of a shape but its vectors, or [`IndexError::NoSuchShape`].
    pub fn entry(&self, id: &str) -> Result<Entry, IndexError> {
        Ok(find(&self.database(), id)?.ok_or_else(|| self.missing(id))?.entry)
    }

    /// The first shape, in ascending order of names, whose file has these bytes.
    pub fn entry_with(&self, content: &ContentHash) -> Result<Option<Entry>, IndexError> {
        let these = "WHERE content = ? ORDER BY id LIMIT 1";
        Ok(rows(&self.database(), these, [content.to_string()])?.pop().map(|row| row.entry))
    }

    /// A shape, or [`IndexError::NoSuchShape`].
    pub fn shape(&self, id: &str) -> Result<Shape, IndexError> {
        let database = self.database();
        let row = find(&database, id)?.ok_or_else(|| self.missing(id))?;
        shape_of(&database, row)
    }

    /// Calls `visit` with each shape in ascending order of names, up to its first error. Holds the entries of all shapes and the
    /// vectors of one in memory.
    pub fn each<E: From<IndexError>>(&self, mut visit: impl FnMut(Shape) -> Result<(), E>) -> Result<(), E> {
        let rows = rows(&self.database(), "ORDER BY id", [])?;
        self.expect_all(rows.len())?;
        for row in rows {
            let shape = shape_of(&self.database(), row)?;
            visit(shape)?;
        }
        Ok(())
    }

    /// All entries, in ascending order of names.
    pub fn entries(&self) -> Result<Vec<Entry>, IndexError> {
        let entries = entries(&self.database())?;
        self.expect_all(entries.len())?;
        Ok(entries)
    }

    /// The vector of one name of a shape, such as a signature; `None` if the shape has none.
    pub fn vector(&self, id: &str, name: &str) -> Result<Option<Vec<f32>>, IndexError> {
        let sql = "SELECT id, name, vector, checksum FROM vectors WHERE id = ? AND name = ?";
        Ok(some_vectors(&self.database(), sql, (id, name))?.pop().map(|(.., vector)| vector))
    }

    /// The names of shapes of several components, each with the fused vectors of its components but the largest.
    pub fn components(&self) -> Result<Vec<(String, Vec<f32>)>, IndexError> {
        let sql = "SELECT id, CAST(place AS TEXT), vector, checksum FROM components ORDER BY id, place";
        let all = some_vectors(&self.database(), sql, [])?;
        Ok(all.into_iter().map(|(id, _, vector)| (id, vector)).collect())
    }

    /// Checks that as many shapes were found as there are.
    pub(crate) fn expect_all(&self, n: usize) -> Result<(), IndexError> {
        match n == self.n_shapes {
            true => Ok(()),
            false => Err(self.damaged(format!("{n} of its {} shapes are there", self.n_shapes))),
        }
    }

    fn missing(&self, id: &str) -> IndexError {
        IndexError::NoSuchShape { path: self.path.clone(), id: id.to_owned() }
    }

    pub(crate) fn damaged(&self, what: impl Into<String>) -> IndexError {
        IndexError::damaged(&self.path, what)
    }
}

/// The row of a shape, if it is there.
pub(crate) fn find(database: &Database, id: &str) -> Result<Option<EntryRow>, IndexError> {
    Ok(rows(database, "WHERE id = ?", [id])?.pop())
}

/// All entries, in ascending order of names.
pub(crate) fn entries(database: &Database) -> Result<Vec<Entry>, IndexError> {
    Ok(rows(database, "ORDER BY id", [])?.into_iter().map(|row| row.entry).collect())
}

fn rows(
    database: &Database,
    which: &str,
    values: impl rusqlite::Params,
) -> Result<Vec<EntryRow>, IndexError> {
    let sql = format!("SELECT {} FROM shapes {which}", EntryRow::COLUMNS);
    let changed = || database.damaged("the entry of a shape has changed");
    let rows = database.all(&sql, values, EntryRow::read)?.into_iter();
    rows.map(|row| row.ok_or_else(changed)).collect()
}

/// The fused vectors of all shapes.
fn vectors(database: &Database) -> Result<VectorTable, IndexError> {
    let mut table = VectorTable::default();
    let sql = "SELECT id, 'fused', vector, checksum FROM fused ORDER BY id";
    each_vector(database, sql, [], |id, _, fused| {
        if fused.is_empty() || !table.is_empty() && fused.len() != table.dim() {
            let what = format!("the vector of `{id}` has {} numbers, not {}", fused.len(), table.dim());
            return Err(database.damaged(what));
        }
        table.push(&id, &fused);
        Ok(())
    })?;
    Ok(table)
}

/// Visits vectors with the names of their shapes and their own.
fn each_vector(
    database: &Database,
    sql: &str,
    values: impl rusqlite::Params,
    mut visit: impl FnMut(String, String, Vec<f32>) -> Result<(), IndexError>,
) -> Result<(), IndexError> {
    database.each(sql, values, vector_row, |(id, name, vector)| match vector {
        Some(vector) => visit(id, name, vector),
        None => Err(database.damaged(format!("the vector `{name}` of `{id}` has changed"))),
    })
}

/// Vectors with the names of their shapes and their own.
fn some_vectors(
    database: &Database,
    sql: &str,
    values: impl rusqlite::Params,
) -> Result<Vec<(String, String, Vec<f32>)>, IndexError> {
    let mut all = Vec::new();
    each_vector(database, sql, values, |id, name, vector| {
        all.push((id, name, vector));
        Ok(())
    })?;
    Ok(all)
}

/// The name of a signature among the vectors of a shape begins with this.
pub(crate) const SIGNATURE: &str = "signature_";
pub(crate) const FORM: &str = "form";
pub(crate) const DISC_AREAS: &str = "disc_areas";

/// A shape with its vectors.
pub(crate) fn shape_of(database: &Database, row: EntryRow) -> Result<Shape, IndexError> {
    let EntryRow { entry, vectors } = row;
    let id = entry.id.clone();
    // The fused vector comes first, and every shape has one.
    let fused = "SELECT id, 'fused', vector, checksum FROM fused WHERE id = ?";
    let fused = some_vectors(database, fused, [&id])?.pop().filter(|(.., vector)| !vector.is_empty());
    let (.., fused) = fused.ok_or_else(|| database.damaged(format!("`{id}` has no vector")))?;
    let mut shape = Shape { entry, fused, ..Shape::default() };
    let others =
        some_vectors(database, "SELECT id, name, vector, checksum FROM vectors WHERE id = ?", [&id])?;
    let components =
        "SELECT id, CAST(place AS TEXT), vector, checksum FROM components WHERE id = ? ORDER BY place";
    let components = some_vectors(database, components, [&id])?;
    let found = (others.len() + components.len()) as u64;
    for (_, name, vector) in others {
        match (name.as_str(), name.strip_prefix(SIGNATURE)) {
            (_, Some(signature)) => drop(shape.signatures.insert(signature.to_owned(), vector)),
            (FORM, _) => shape.form = vector.as_chunks::<4>().0.to_vec(),
            (DISC_AREAS, _) => shape.disc_areas = vector,
            _ => return Err(database.damaged(format!("`{id}` has an unknown vector `{name}`"))),
        }
    }
    shape.components = components.into_iter().map(|(.., vector)| vector).collect();
    match found == vectors {
        true => Ok(shape),
        false => Err(database.damaged(format!("`{id}` has {found} vectors, not {vectors}"))),
    }
}
