//! Building and changing an index.

use std::path::{Path, PathBuf};

use rusqlite::params_from_iter;
use rusqlite::types::Value;

use crate::database::{Database, EntryRow, checksum, damaged_path, meta, to_bytes, with_suffix};
use crate::reader::{DISC_AREAS, FORM, SIGNATURE, entries, find, shape_of};
use crate::{Entry, Index, IndexError, Shape};

/// The only writer of an index.
///
/// Changes are made in a transaction: [`commit`](Self::commit) puts all since the last one on disk, or none. What was
/// committed stays, whatever happens afterwards; so a program that is interrupted goes on where it was. A writer that is dropped
/// drops what it has not committed. All methods may
/// return [`IndexError::Io`] and [`IndexError::Damaged`].
///
/// ```
/// use canonform_index::{IndexWriter, Shape};
///
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("index");
/// let mut shape = Shape { fused: vec![1.0, 2.0], ..Shape::default() };
/// shape.entry.id = "cat0".to_owned();
/// let mut writer = IndexWriter::build(&path, "options")?;
/// writer.put(&[shape])?;
/// writer.commit()?;
/// drop(writer); // interrupted
///
/// let writer = IndexWriter::build(&path, "options")?;
/// assert!(writer.is_resumed && writer.entry("cat0")?.is_some());
/// assert_eq!(writer.finish()?.len(), 1);
/// # Ok::<(), canonform_index::IndexError>(())
/// ```
#[derive(Debug)]
pub struct IndexWriter {
    database: Database,
    /// Shapes so far.
    n_shapes: u64,
    /// Length of the vectors, once there is one.
    length: Option<usize>,
    /// Whether the last writer was interrupted.
    pub is_resumed: bool,
    /// Whether the existing index could not be read and was set aside, so that the work started from nothing.
    pub replaced_damaged: bool,
    /// Whether there was no index.
    pub is_new: bool,
    /// Goes last, once the database is closed.
    unwritten: Unwritten,
}

/// A new index to which nothing was committed. It goes with its writer.
#[derive(Debug)]
struct Unwritten(Option<PathBuf>);

impl Drop for Unwritten {
    fn drop(&mut self) {
        self.0.iter().for_each(|path| drop(std::fs::remove_file(path)));
    }
}

impl IndexWriter {
    /// Begins to build an index or to go on with one, whose shapes are described with `options`. An index that is damaged
    /// or of a past version is kept as `NAME.damaged`, and the work starts from nothing.
    ///
    /// # Errors
    /// [`IndexError::Busy`], [`IndexError::OtherOptions`] and those of [`Index::open`].
    pub fn build(path: &Path, options: &str) -> Result<Self, IndexError> {
        let open = || {
            if !path.exists() {
                Database::create(path)?;
            }
            Self::begin(Database::write(path)?, Some(options))
        };
        match open() {
            Err(IndexError::Damaged { .. } | IndexError::PastVersion { .. }) => {
                let cannot_write = IndexError::io("write", path);
                std::fs::rename(path, damaged_path(path)).map_err(cannot_write)?;
                for suffix in ["-wal", "-shm"] {
                    let _ = std::fs::remove_file(with_suffix(path, suffix));
                }
                Ok(Self { replaced_damaged: true, ..open()? })
            }
            found => found,
        }
    }

    /// Begins to change an index.
    ///
    /// # Errors
    /// [`IndexError::Busy`] and those of [`Index::open`].
    pub fn open(path: &Path) -> Result<Self, IndexError> {
        Self::begin(Database::write(path)?, None)
    }

    fn begin(database: Database, options: Option<&str>) -> Result<Self, IndexError> {
        let known = database.meta(meta::OPTIONS)?;
        let path = database.path.clone();
        match (options, &known) {
            (Some(requested), Some(found)) if requested != found => {
                return Err(IndexError::OtherOptions {
                    path,
                    found: found.clone(),
                    requested: requested.to_owned(),
                });
            }
            (Some(_), None) => database.set_meta(meta::OPTIONS, options)?,
            (_, Some(_)) => {}
            (None, None) => return Err(database.damaged("it does not state how its shapes were described")),
        }
        let n_shapes = database.count(meta::SHAPES)?;
        let lengths = "SELECT length(vector) FROM fused LIMIT 1";
        let length = database.all(lengths, [], |row| row.get::<_, usize>(0))?.pop().map(|bytes| bytes / 4);
        if (n_shapes == 0) != length.is_none() {
            return Err(database.damaged("the number of its shapes is wrong"));
        }
        let (is_new, is_resumed) = (known.is_none(), database.meta(meta::UNFINISHED)?.is_some());
        let (replaced_damaged, unwritten) = (false, Unwritten(is_new.then_some(path)));
        Ok(Self { database, n_shapes, length, is_resumed, replaced_damaged, is_new, unwritten })
    }

    /// The index.
    pub fn path(&self) -> &Path {
        &self.database.path
    }

    /// Number of shapes so far.
    pub fn n_shapes(&self) -> usize {
        self.n_shapes as usize
    }

    /// The entry of a shape, if it is there.
    pub fn entry(&self, id: &str) -> Result<Option<Entry>, IndexError> {
        Ok(find(&self.database, id)?.map(|row| row.entry))
    }

    /// A shape.
    ///
    /// # Errors
    /// [`IndexError::NoSuchShape`].
    pub fn shape(&self, id: &str) -> Result<Shape, IndexError> {
        shape_of(&self.database, self.expect(id)?)
    }

    /// The entries of all shapes so far, in ascending order of names.
    pub fn entries(&self) -> Result<Vec<Entry>, IndexError> {
        entries(&self.database)
    }

    /// Stores shapes, replacing those of the same names. With an error, what was put since the last
    /// [`commit`](Self::commit) is lost.
    ///
    /// # Errors
    /// [`IndexError::BadVector`], [`IndexError::OtherLength`].
    pub fn put(&mut self, shapes: &[Shape]) -> Result<(), IndexError> {
        for shape in shapes {
            let (id, fused) = (&shape.entry.id, &shape.fused);
            if fused.is_empty() || !fused.iter().all(|x| x.is_finite()) {
                return Err(IndexError::BadVector(id.clone()));
            }
            let expected = *self.length.get_or_insert(fused.len());
            if fused.len() != expected {
                return Err(IndexError::OtherLength { id: id.clone(), found: fused.len(), expected });
            }
            self.delete(id)?;
            self.n_shapes += 1;
            let row = |name: &str, vector: &[f32]| {
                let bytes = to_bytes(vector);
                let sum = checksum(&[id, name], &bytes);
                (bytes, sum)
            };
            let (bytes, sum) = row("fused", fused);
            self.database.change("INSERT INTO fused VALUES (?, ?, ?)", (id, bytes, sum))?;
            let mut vectors = 0;
            let signatures = shape.signatures.iter();
            let signatures = signatures.map(|(name, values)| (format!("{SIGNATURE}{name}"), &values[..]));
            let others = [(FORM, shape.form.as_flattened()), (DISC_AREAS, &shape.disc_areas)];
            let others = others.into_iter().filter(|(_, vector)| !vector.is_empty());
            for (name, vector) in others.map(|(name, vector)| (name.to_owned(), vector)).chain(signatures) {
                let (bytes, sum) = row(&name, vector);
                self.database.change("INSERT INTO vectors VALUES (?, ?, ?, ?)", (id, name, bytes, sum))?;
                vectors += 1;
            }
            for (place, vector) in shape.components.iter().enumerate() {
                let (bytes, sum) = row(&place.to_string(), vector);
                self.database
                    .change("INSERT INTO components VALUES (?, ?, ?, ?)", (id, place, bytes, sum))?;
                vectors += 1;
            }
            self.put_entry(EntryRow { entry: shape.entry.clone(), vectors })?;
        }
        Ok(())
    }

    /// Replaces entries of shapes and keeps their vectors.
    ///
    /// # Errors
    /// [`IndexError::NoSuchShape`].
    pub fn set_entries(&mut self, entries: &[Entry]) -> Result<(), IndexError> {
        for entry in entries {
            let EntryRow { vectors, .. } = self.expect(&entry.id)?;
            self.put_entry(EntryRow { entry: entry.clone(), vectors })?;
        }
        Ok(())
    }

    fn put_entry(&self, row: EntryRow) -> Result<(), IndexError> {
        let sum = row.checksum();
        let EntryRow { entry: Entry { id, label, path, content, facts }, vectors } = row;
        let texts = [id, label, path, content.to_string()].map(Value::Text).into_iter();
        let facts = facts.named().map(|(_, fact)| Value::Real(fact));
        let values = texts.chain(facts).chain([vectors as i64, sum.into()].map(Value::Integer));
        let sql = "INSERT OR REPLACE INTO shapes VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)";
        self.database.change(sql, params_from_iter(values))
    }

    /// What was noted under a name.
    pub fn note(&self, name: &'static str) -> Result<Option<String>, IndexError> {
        self.database.meta(name)
    }

    /// Notes what is true of the whole index, under a name that is not one of the schema, or removes the note.
    pub fn set_note(&mut self, name: &'static str, text: Option<&str>) -> Result<(), IndexError> {
        self.database.set_meta(name, text)
    }

    /// Removes shapes.
    ///
    /// # Errors
    /// [`IndexError::NoSuchShape`].
    pub fn remove(&mut self, ids: &[String]) -> Result<(), IndexError> {
        ids.iter().try_for_each(|id| self.expect(id).map(drop))?;
        ids.iter().try_for_each(|id| self.delete(id))
    }

    /// Removes all shapes.
    pub fn clear(&mut self) -> Result<(), IndexError> {
        self.database
            .execute("DELETE FROM shapes; DELETE FROM fused; DELETE FROM vectors; DELETE FROM components")?;
        (self.n_shapes, self.length) = (0, None);
        Ok(())
    }

    /// Removes a shape, if it is there.
    fn delete(&mut self, id: &str) -> Result<(), IndexError> {
        self.database.change("DELETE FROM shapes WHERE id = ?", [id])?;
        if self.database.connection.changes() > 0 {
            self.n_shapes -= 1;
            self.database.change("DELETE FROM fused WHERE id = ?", [id])?;
            self.database.change("DELETE FROM vectors WHERE id = ?", [id])?;
            self.database.change("DELETE FROM components WHERE id = ?", [id])?;
        }
        Ok(())
    }

    /// Lets the file grow no further, as a full disk does.
    #[cfg(test)]
    pub(crate) fn limit_pages(&self, pages: u32) {
        self.database.execute(&format!("PRAGMA max_page_count = {pages}")).unwrap();
    }

    fn expect(&self, id: &str) -> Result<EntryRow, IndexError> {
        let missing = || IndexError::NoSuchShape { path: self.path().to_owned(), id: id.to_owned() };
        find(&self.database, id)?.ok_or_else(missing)
    }

    /// Puts all changes on disk. The index says that it is not finished.
    pub fn commit(&mut self) -> Result<(), IndexError> {
        self.database.set_meta(meta::UNFINISHED, Some("run the command again to finish it"))?;
        self.commit_all()?;
        self.database.begin_writing()
    }

    fn commit_all(&mut self) -> Result<(), IndexError> {
        let change = self.database.count(meta::CHANGE)? + 1;
        self.database.set_meta(meta::CHANGE, Some(&change.to_string()))?;
        self.database.set_meta(meta::SHAPES, Some(&self.n_shapes.to_string()))?;
        self.database.execute("COMMIT")?;
        self.unwritten.0 = None;
        Ok(())
    }

    /// Finishes the index: puts all changes on disk.
    ///
    /// # Errors
    /// [`IndexError::Io`]; then the index is as it was after the last [`commit`](Self::commit).
    pub fn finish(mut self) -> Result<Index, IndexError> {
        self.database.set_meta(meta::UNFINISHED, None)?;
        self.commit_all()?;
        let path = self.path().to_owned();
        drop(self);
        Index::open(&path)
    }
}
