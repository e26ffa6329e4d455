//! The file that a writer works in: what it has put, removed or changed so far.
//!
//! | part | bytes | content |
//! |---|---|---|
//! | magic | 16 | |
//! | frame | 12 | length of its content: u64; CRC-32 of that: u32 |
//! | | | the job, in the first frame; [records](super::records), in all others |
//!
//! Each further frame is one change, on disk before the writer goes on. Frames from the first one on that is not whole were left
//! by a writer that was interrupted, and do not count.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::records::{Changes, Run, StoredRecord, lock, push, read_at, record_at, u32_at, u64_at};
use crate::IndexError;

const MAGIC: [u8; 16] = *b"canonform work 2";
const FRAME: usize = 12;

/// What a writer has changed. Its file is locked by the writer.
#[derive(Debug)]
pub(crate) struct Log {
    path: PathBuf,
    file: Mutex<File>,
    end: u64,
    /// What its first frame holds.
    job: Vec<u8>,
    /// Where the value of each changed key is in the file.
    values: BTreeMap<Vec<u8>, Option<Range<u64>>>,
}

impl Log {
    /// A log of a job without changes; what the file holds is lost.
    pub(crate) fn begin(file: File, path: &Path, job: Vec<u8>) -> Result<Self, IndexError> {
        let mut log = Self::of(file, path);
        log.write(&MAGIC).and_then(|()| lock(&log.file).set_len(log.end)).map_err(log.cannot_write())?;
        log.write_frame(&job).map_err(log.cannot_write())?;
        Ok(Self { job, ..log })
    }

    /// What an interrupted writer left; `None` if it left no job.
    pub(crate) fn resume(file: File, path: &Path) -> Result<Option<Self>, IndexError> {
        let mut log = Self::of(file, path);
        let is_log = log.replay().map_err(log.cannot_write())?;
        Ok(is_log.then_some(log))
    }

    fn of(file: File, path: &Path) -> Self {
        let (path, file) = (path.to_owned(), Mutex::new(file));
        Self { path, file, end: 0, job: Vec::new(), values: BTreeMap::new() }
    }

    fn cannot_write(&self) -> impl Fn(io::Error) -> IndexError + use<> {
        let path = self.path.clone();
        move |source| IndexError::io("write", &path)(source)
    }

    fn replay(&mut self) -> io::Result<bool> {
        let file = lock(&self.file).try_clone()?;
        let length = file.metadata()?.len();
        let mut reader = BufReader::with_capacity(1 << 18, file);
        reader.seek(SeekFrom::Start(0))?;
        let mut content = Vec::new();
        Read::by_ref(&mut reader).take(MAGIC.len() as u64).read_to_end(&mut content)?;
        if content != MAGIC {
            return Ok(false);
        }
        self.end = MAGIC.len() as u64;
        while length - self.end >= FRAME as u64 {
            let mut frame = [0; FRAME];
            reader.read_exact(&mut frame)?;
            let (n, start) = (u64_at(&frame, 0), self.end + FRAME as u64);
            if n > length - start {
                break;
            }
            content.clear();
            Read::by_ref(&mut reader).take(n).read_to_end(&mut content)?;
            if crc32fast::hash(&content) != u32_at(&frame, 8) {
                break;
            }
            match self.job.is_empty() {
                true => self.job.clone_from(&content),
                false => self.learn(start, &content),
            }
            self.end = start + n;
        }
        Ok(!self.job.is_empty())
    }

    /// Writes at the end.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut file = lock(&self.file);
        file.seek(SeekFrom::Start(self.end))?;
        file.write_all(bytes)?;
        file.sync_data()?;
        self.end += bytes.len() as u64;
        Ok(())
    }

    fn write_frame(&mut self, content: &[u8]) -> io::Result<()> {
        let head = [&(content.len() as u64).to_le_bytes()[..], &crc32fast::hash(content).to_le_bytes()];
        self.write(&[&head.concat(), content].concat())
    }

    /// Remembers where the values of a frame are, whose records start at `start`.
    fn learn(&mut self, start: u64, records: &[u8]) {
        let mut at = 0;
        while let Some(StoredRecord { key, value, end }) = record_at(records, at) {
            let place = |value: &[u8]| start + (end - value.len()) as u64..start + end as u64;
            self.values.insert(key.to_vec(), value.map(place));
            at = end;
        }
    }

    /// Adds changes, which are on disk when it returns.
    ///
    /// # Errors
    /// [`IndexError::Io`]; then none of them is there.
    pub(crate) fn append(&mut self, changes: &Changes) -> Result<(), IndexError> {
        let mut records = Vec::new();
        changes.iter().for_each(|(key, value)| push(&mut records, key, value.as_deref()));
        let start = self.end + FRAME as u64;
        self.write_frame(&records).map_err(self.cannot_write())?;
        self.learn(start, &records);
        Ok(())
    }

    /// The job that it began with.
    pub(crate) fn job(&self) -> &[u8] {
        &self.job
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Size of its file.
    pub(crate) fn n_bytes(&self) -> u64 {
        self.end
    }

    /// The value of a key: `None` if it has not changed, `Some(None)` if it was removed.
    pub(super) fn get(&self, key: &[u8]) -> Result<Option<Option<Vec<u8>>>, IndexError> {
        self.values.get(key).map(|place| self.read(place)).transpose()
    }

    /// The changed keys that begin with `prefix`, and whether they have a value.
    pub(super) fn keys<'a>(&'a self, prefix: &'a [u8]) -> impl Iterator<Item = (&'a [u8], bool)> {
        let keys = self.values.range(prefix.to_vec()..);
        keys.take_while(move |(key, _)| key.starts_with(prefix))
            .map(|(key, place)| (key.as_slice(), place.is_some()))
    }

    /// All changes from a key on.
    pub(super) fn run<'a>(&'a self, from: &[u8]) -> Run<'a> {
        let read = |(key, place): (&Vec<u8>, &_)| Ok((key.clone(), self.read(place)?));
        Box::new(self.values.range(from.to_vec()..).map(read))
    }

    fn read(&self, place: &Option<Range<u64>>) -> Result<Option<Vec<u8>>, IndexError> {
        let Some(place) = place else { return Ok(None) };
        let mut bytes = vec![0; (place.end - place.start) as usize];
        read_at(&self.file, place.start, &mut bytes).map_err(IndexError::io("read", &self.path))?;
        Ok(Some(bytes))
    }
}
