//! The SQLite database of an index: its schema, and what is done to open it.
//!
//! ```sql
#![doc = include_str!("schema.sql")]
//! ```
//!
//! `application_id` is [`APPLICATION`], `user_version` the format. Vectors are 32-bit floats, least significant byte first.
//! SQLite finds defects of its own structure when it meets them, but not a changed byte within a value: so every row has a
//! CRC-32 of its values, which is compared whenever it is read.
//!
//! The journal is a write-ahead log. A reader sees the state of the moment it was opened for as long as it likes, beside a
//! writer. Each transaction is copied into the file as soon as no reader needs the old pages, and the log is removed when
//! the last program closes the index. SQLite's documentation says which cases of a crash it recovers from.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::time::Duration;

use base::files::{Pending, fill_atomically, has_other_names, is_input};
use rusqlite::config::DbConfig;
use rusqlite::types::FromSql;
use rusqlite::{CachedStatement, Connection, OpenFlags, OptionalExtension, Params, ffi};

use crate::error::FORMAT_VERSION;
use crate::{Entry, Facts, IndexError};

/// `CnFm`, by which the program `file` and others can tell an index from other databases.
pub(crate) const APPLICATION: i64 = 0x436E_466D;

/// The start of an index of format 5 or less, which was no database; its version follows.
const OLD_MAGIC: [u8; 16] = *b"canonform index\n";

/// Programs open and close an index within milliseconds; only another writer keeps one waiting for longer.
const WAIT: Duration = Duration::from_secs(1);

/// Bytes of a page. Four hold the fused vectors of 128 shapes, so that a scan reads few pages.
const PAGE: u32 = 16_384;

/// Longest value in bytes. A form of 1,000 points has 16,000.
const MAX_VALUE: i32 = 64 << 20;

/// Names of what is stored once for an index. The program that writes it adds notes of its own.
pub(crate) mod meta {
    /// How shapes were described.
    pub(crate) const OPTIONS: &str = "options";
    /// Number of shapes.
    pub(crate) const SHAPES: &str = "shapes";
    /// Whether a writer was interrupted, or is at work.
    pub(crate) const UNFINISHED: &str = "unfinished";
    /// A number that grows with every transaction.
    pub(crate) const CHANGE: &str = "change";
    /// A random word for each writer whose changes may be in the log, that of the state before it first.
    pub(crate) const WRITERS: &str = "writers";
}

/// An open database, and its path for errors.
#[derive(Debug)]
pub(crate) struct Database {
    pub(crate) connection: Connection,
    pub(crate) path: PathBuf,
}

impl Database {
    /// Opens an index to read it. The state stays that of this moment.
    pub(crate) fn read(path: &Path) -> Result<Self, IndexError> {
        let about = std::fs::metadata(path).map_err(IndexError::io("read", path))?;
        if about.is_dir() {
            let folder = "this is a folder; build an index of it (`index build`) and give that";
            return Err(IndexError::io("read", path)(std::io::Error::other(folder)));
        }
        Self::expect_own_log(path)?;
        // Readers of a write-ahead log share memory in files beside it, and the last of them tidies up.
        let database = Self::open(path, "", OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        match database.begin_reading() {
            Err(IndexError::Io { .. }) if !log_path(path).exists() => {
                // No file can be made on a read-only disk, where nobody writes either.
                let fixed = Self::open(path, "?immutable=1", OpenFlags::SQLITE_OPEN_READ_ONLY)?;
                fixed.begin_reading()?;
                Ok(fixed)
            }
            found => found.map(|()| database),
        }
    }

    fn begin_reading(&self) -> Result<(), IndexError> {
        // Takes over what is committed, so that the file alone is whole. It fails where there is nothing to take over.
        let _ = self.execute("PRAGMA wal_checkpoint(PASSIVE)");
        self.execute("PRAGMA query_only = 1; BEGIN")?;
        self.check_format()
    }

    /// Opens an index to write it. There is one writer at a time.
    pub(crate) fn write(path: &Path) -> Result<Self, IndexError> {
        let cannot_write = IndexError::io("write", path);
        let file = File::open(path).map_err(IndexError::io("read", path))?;
        if file.metadata().is_ok_and(|about| about.is_dir()) {
            return Err(cannot_write(ErrorKind::IsADirectory.into()));
        }
        if is_input(path) {
            return Err(cannot_write(io::Error::new(ErrorKind::ResourceBusy, "it is one of the inputs")));
        }
        if has_other_names(&file) {
            // A backup may be the same file by another name, and keeps its content.
            let copied = fill_atomically(path, |copy| io::copy(&mut &file, copy).map(drop));
            copied.map_err(|fault| cannot_write(fault.source))?;
        }
        drop(file);
        Self::expect_own_log(path)?;
        let database = Self::open(path, "", OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        database.check_format()?;
        if database.connection.is_readonly(rusqlite::MAIN_DB).unwrap_or(true) {
            return Err(cannot_write(ErrorKind::PermissionDenied.into()));
        }
        database
            .execute("PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 1; PRAGMA synchronous = FULL")?;
        database.begin_writing()?;
        let known = database.meta(meta::WRITERS)?.unwrap_or_default();
        let kept = if has_log(path) { &known } else { known.rsplit(' ').next().unwrap_or_default() };
        let word: String = database.one("SELECT lower(hex(randomblob(8)))")?;
        database.set_meta(meta::WRITERS, Some(&format!("{kept} {word}")))?;
        Ok(database)
    }

    /// Checks that the log beside an index, if there is one, belongs to it. A file that took the place of another while a
    /// program had that open would be read and written together with the changes of the other.
    fn expect_own_log(path: &Path) -> Result<(), IndexError> {
        let writers = |query: &str, flags| -> Result<String, IndexError> {
            let database = Self::open(path, query, flags)?;
            let keeps = DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE;
            database.connection.set_db_config(keeps, true).map_err(|fault| database.fault(fault))?;
            database.check_format()?;
            Ok(database.meta(meta::WRITERS)?.unwrap_or_default())
        };
        for is_last in [false, false, true] {
            if !has_log(path) {
                break;
            }
            let of_file = writers("?immutable=1", OpenFlags::SQLITE_OPEN_READ_ONLY);
            let of_both = writers("", OpenFlags::SQLITE_OPEN_READ_WRITE)?;
            match of_file {
                Ok(words) if of_both.split(' ').any(|word| words.ends_with(word)) => break,
                // A copy of the log into the file was interrupted, and goes on.
                Err(IndexError::Damaged { .. }) => break,
                // Another program may just be copying the log into the file.
                _ if !is_last => std::thread::sleep(WAIT / 20),
                Ok(_) => return Err(IndexError::OtherLog(path.to_owned())),
                Err(fault) => return Err(fault),
            }
        }
        Ok(())
    }

    /// Makes an index without shapes, completely or not at all, unless there is a file.
    pub(crate) fn create(path: &Path) -> Result<(), IndexError> {
        let bytes = || {
            let mut blank = Connection::open_in_memory()?;
            blank.execute_batch(&format!(
                "PRAGMA page_size = {PAGE}; PRAGMA application_id = {APPLICATION}; \
                 PRAGMA user_version = {FORMAT_VERSION}; {}; \
                 INSERT INTO meta VALUES ('{}', lower(hex(randomblob(8))))",
                include_str!("schema.sql"),
                meta::WRITERS
            ))?;
            Ok::<_, rusqlite::Error>(blank.serialize(rusqlite::MAIN_DB)?.to_vec())
        };
        let bytes = bytes().map_err(|fault| IndexError::of_database(path, fault))?;
        let written = Pending::write(path, |out| out.write_all(&bytes)).and_then(Pending::publish_new);
        match written {
            Err(fault) if fault.source.kind() != ErrorKind::AlreadyExists => {
                Err(IndexError::io("write", path)(fault.source))
            }
            _ => Ok(()),
        }
    }

    /// Begins a transaction, unless another program writes.
    pub(crate) fn begin_writing(&self) -> Result<(), IndexError> {
        self.execute("BEGIN IMMEDIATE")
    }

    fn open(path: &Path, query: &str, flags: OpenFlags) -> Result<Self, IndexError> {
        let failed = |source: rusqlite::Error| IndexError::of_database(path, source);
        let flags = flags | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
        let connection = Connection::open_with_flags(uri(path, query), flags).map_err(failed)?;
        connection.busy_timeout(WAIT).map_err(failed)?;
        connection.set_limit(rusqlite::limits::Limit::SQLITE_LIMIT_LENGTH, MAX_VALUE).map_err(failed)?;
        let database = Self { connection, path: path.to_owned() };
        // A forged schema runs nothing.
        database.execute("PRAGMA trusted_schema = 0; PRAGMA cell_size_check = 1; PRAGMA mmap_size = 0")?;
        Ok(database)
    }

    fn check_format(&self) -> Result<(), IndexError> {
        let application: i64 = self.one("PRAGMA application_id")?;
        let found: i64 = self.one("PRAGMA user_version")?;
        match application == APPLICATION {
            false => Err(IndexError::Foreign(self.path.clone())),
            true if found == i64::from(FORMAT_VERSION) => Ok(()),
            true => Err(IndexError::other_version(&self.path, u32::try_from(found).unwrap_or(u32::MAX))),
        }
    }

    fn one<T: FromSql>(&self, sql: &str) -> Result<T, IndexError> {
        self.connection.query_row(sql, [], |row| row.get(0)).map_err(|fault| self.fault(fault))
    }

    pub(crate) fn execute(&self, sql: &str) -> Result<(), IndexError> {
        self.connection.execute_batch(sql).map_err(|fault| self.fault(fault))
    }

    pub(crate) fn statement(&self, sql: &str) -> Result<CachedStatement<'_>, IndexError> {
        self.connection.prepare_cached(sql).map_err(|fault| self.fault(fault))
    }

    /// Runs a statement that changes rows.
    pub(crate) fn change(&self, sql: &str, values: impl Params) -> Result<(), IndexError> {
        self.statement(sql)?.execute(values).map(drop).map_err(|fault| self.fault(fault))
    }

    pub(crate) fn meta(&self, name: &str) -> Result<Option<String>, IndexError> {
        let mut statement = self.statement("SELECT value FROM meta WHERE name = ?")?;
        statement.query_row([name], |row| row.get(0)).optional().map_err(|fault| self.fault(fault))
    }

    pub(crate) fn set_meta(&self, name: &str, value: Option<&str>) -> Result<(), IndexError> {
        match value {
            Some(value) => self.change("INSERT OR REPLACE INTO meta VALUES (?, ?)", (name, value)),
            None => self.change("DELETE FROM meta WHERE name = ?", [name]),
        }
    }

    /// A number that is stored once.
    pub(crate) fn count(&self, name: &str) -> Result<u64, IndexError> {
        let text = self.meta(name)?.unwrap_or_else(|| "0".to_owned());
        text.parse().map_err(|_| self.damaged(format!("`{}` is `{text}`", name)))
    }

    /// Visits the rows of a query, up to the first error of `visit`.
    pub(crate) fn each<T>(
        &self,
        sql: &str,
        values: impl Params,
        read: impl Fn(&rusqlite::Row<'_>) -> rusqlite::Result<T>,
        mut visit: impl FnMut(T) -> Result<(), IndexError>,
    ) -> Result<(), IndexError> {
        let mut statement = self.statement(sql)?;
        let mut rows = statement.query(values).map_err(|fault| self.fault(fault))?;
        while let Some(row) = rows.next().map_err(|fault| self.fault(fault))? {
            visit(read(row).map_err(|fault| self.fault(fault))?)?;
        }
        Ok(())
    }

    /// The rows of a query.
    pub(crate) fn all<T>(
        &self,
        sql: &str,
        values: impl Params,
        read: impl Fn(&rusqlite::Row<'_>) -> rusqlite::Result<T>,
    ) -> Result<Vec<T>, IndexError> {
        let mut all = Vec::new();
        self.each(sql, values, read, |row| {
            all.push(row);
            Ok(())
        })?;
        Ok(all)
    }

    pub(crate) fn fault(&self, fault: rusqlite::Error) -> IndexError {
        IndexError::of_database(&self.path, fault)
    }

    pub(crate) fn damaged(&self, what: impl Into<String>) -> IndexError {
        IndexError::damaged(&self.path, what)
    }
}

impl IndexError {
    /// An error of SQLite, in our own terms.
    fn of_database(path: &Path, fault: rusqlite::Error) -> Self {
        let code = fault.sqlite_error().map_or(0, |error| error.extended_code);
        let text = fault.to_string();
        let io = |action, kind| Self::Io {
            action,
            path: path.to_owned(),
            source: io::Error::new(kind, text.clone()),
        };
        match code & 0xFF {
            ffi::SQLITE_BUSY | ffi::SQLITE_LOCKED => Self::Busy(path.to_owned()),
            ffi::SQLITE_NOTADB => no_database(path),
            ffi::SQLITE_FULL => io("write", ErrorKind::StorageFull),
            ffi::SQLITE_READONLY => io("write", ErrorKind::PermissionDenied),
            ffi::SQLITE_CANTOPEN | ffi::SQLITE_PERM | ffi::SQLITE_AUTH => {
                io("open", if path.exists() { ErrorKind::PermissionDenied } else { ErrorKind::NotFound })
            }
            ffi::SQLITE_IOERR => match code {
                ffi::SQLITE_IOERR_READ | ffi::SQLITE_IOERR_SHORT_READ => io("read", ErrorKind::Other),
                // A limit of the size of files, or a disk that fills up while a page is written.
                ffi::SQLITE_IOERR_WRITE
                | ffi::SQLITE_IOERR_TRUNCATE
                | ffi::SQLITE_IOERR_SHMSIZE
                | ffi::SQLITE_IOERR_SHMMAP => io("write", ErrorKind::StorageFull),
                _ => io("write", ErrorKind::Other),
            },
            _ => Self::damaged(path, text),
        }
    }
}

/// What a file is that SQLite does not know.
fn no_database(path: &Path) -> IndexError {
    let mut head = [0; 20];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut head));
    match (read, head.strip_prefix(&OLD_MAGIC)) {
        (Ok(()), Some(&[a, b, c, d])) => IndexError::other_version(path, u32::from_le_bytes([a, b, c, d])),
        (Ok(()), None) if head.starts_with(b"SQLite format 3\0") => {
            IndexError::damaged(path, "its head has changed")
        }
        _ => IndexError::Foreign(path.to_owned()),
    }
}

/// The path as SQLite reads it, with a query.
fn uri(path: &Path, query: &str) -> String {
    let mut uri = "file:".to_owned();
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    for byte in absolute.as_os_str().as_encoded_bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b':' => {
                uri.push(char::from(*byte))
            }
            b'\\' if cfg!(windows) => uri.push('/'),
            byte => uri += &format!("%{byte:02X}"),
        }
    }
    uri + query
}

/// The write-ahead log of an index, which is there while a program has it open.
pub fn log_path(path: &Path) -> PathBuf {
    with_suffix(path, "-wal")
}

fn has_log(path: &Path) -> bool {
    std::fs::metadata(log_path(path)).is_ok_and(|about| about.len() > 0)
}

/// The file that keeps an index that could not be read after it was built again.
pub fn damaged_path(path: &Path) -> PathBuf {
    with_suffix(path, ".damaged")
}

pub(crate) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name: OsString = path.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

/// A vector as it is stored.
pub(crate) fn to_bytes(vector: &[f32]) -> Vec<u8> {
    vector.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A row `id, name, vector, checksum`: the two names, and the vector unless it has changed.
pub(crate) fn vector_row(row: &rusqlite::Row<'_>) -> rusqlite::Result<(String, String, Option<Vec<f32>>)> {
    let (id, name): (String, String) = (row.get(0)?, row.get(1)?);
    let bytes = row.get_ref(2)?.as_blob()?;
    let is_intact = row.get::<_, u32>(3)? == checksum(&[&id, &name], bytes);
    let (numbers, rest) = bytes.as_chunks::<4>();
    let vector = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    Ok((id, name, Some(vector).filter(|_| is_intact && rest.is_empty())))
}

/// The checksum of a row of texts and a vector. Each part ends where it is said to.
pub(crate) fn checksum(texts: &[&str], bytes: &[u8]) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    for text in texts {
        sum.update(&(text.len() as u64).to_le_bytes());
        sum.update(text.as_bytes());
    }
    sum.update(bytes);
    sum.finalize()
}

/// A row of the table of shapes.
pub(crate) struct EntryRow {
    pub(crate) entry: Entry,
    /// Rows of the shape in the tables of vectors and components, so that a lost one is noticed.
    pub(crate) vectors: u64,
}

impl EntryRow {
    pub(crate) const COLUMNS: &str = "id, label, path, content, vertices, faces, area, diameter, dropped_area_share, \
         components, shortcuts, longest_boundary, vectors, checksum";

    /// Reads a row; `None` if it is not what was written.
    pub(crate) fn read(row: &rusqlite::Row<'_>) -> rusqlite::Result<Option<Self>> {
        let Ok(content) = row.get::<_, String>(3)?.parse() else { return Ok(None) };
        let facts = Facts {
            vertices: row.get(4)?,
            faces: row.get(5)?,
            area: row.get(6)?,
            diameter: row.get(7)?,
            dropped_area_share: row.get(8)?,
            components: row.get(9)?,
            shortcuts: row.get(10)?,
            longest_boundary: row.get(11)?,
        };
        let entry = Entry { id: row.get(0)?, label: row.get(1)?, path: row.get(2)?, content, facts };
        let read = Self { entry, vectors: row.get(12)? };
        Ok((row.get::<_, u32>(13)? == read.checksum()).then_some(read))
    }

    pub(crate) fn checksum(&self) -> u32 {
        let Entry { id, label, path, content, facts } = &self.entry;
        let numbers = facts.named().iter().flat_map(|(_, x)| x.to_le_bytes()).collect::<Vec<u8>>();
        let numbers = [numbers, self.vectors.to_le_bytes().to_vec()].concat();
        checksum(&[id, label, path, &content.to_string()], &numbers)
    }
}
