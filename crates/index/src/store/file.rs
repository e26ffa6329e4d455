//! Index files.
//!
//! A file is a head and one or more [segments](super::segment). The first segment holds a whole index, each further one
//! what additions and removals have changed. A value counts as it is in the last segment that holds its key.
//!
//! | part | bytes | content |
//! |---|---|---|
//! | head | 4096 | two slots, at 0 and 2048, and zeros |
//! | slot | 48 | magic: 16; format version: u32; number of the change: u64; where the last segment ends: u64; checksum of its footer: u32; zeros: 4; CRC-32 of the slot without this field: u32 |
//! | segments | | |
//!
//! Checksums cover every byte, and each block is checked when it is read, so a changed byte never becomes a result.
//!
//! Nothing that a reader uses is ever written again. A writer appends a segment, flushes it to disk, and then writes the
//! slot that is not in use. What follows the last segment of the newer slot was left by a writer that was interrupted,
//! and does not count. So that few segments count, one that is appended takes in those before it that are not much
//! larger; their bytes stay until the file is written anew.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use super::records::{Record, Rows, Run, StoredRecord, read_at, record_at, u32_at, u64_at};
use super::segment::{Segment, SegmentWriter};
use crate::IndexError;
use crate::error::FORMAT_VERSION;

/// Bytes before the first segment.
const HEAD: usize = 4096;

const MAGIC: [u8; 16] = *b"canonform index\n";
const SLOT: usize = 48;
const SLOTS: [usize; 2] = [0, HEAD / 2];

/// A finished state of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct State {
    /// Number of the change that led to it.
    number: u64,
    /// Where its last segment ends.
    end: u64,
    /// Checksum of the footer there.
    sum: u32,
}

impl State {
    fn to_bytes(self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(FORMAT_VERSION.to_le_bytes());
        bytes.extend(self.number.to_le_bytes());
        bytes.extend(self.end.to_le_bytes());
        bytes.extend(self.sum.to_le_bytes());
        bytes.extend([0; 4]);
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        bytes
    }

    /// The version of the format and the state in a slot; `None` if the slot is damaged.
    fn of_slot(slot: &[u8]) -> Option<(u32, Self)> {
        let state = Self { number: u64_at(slot, 20), end: u64_at(slot, 28), sum: u32_at(slot, 36) };
        let is_intact = slot[..16] == MAGIC && crc32fast::hash(&slot[..SLOT - 4]) == u32_at(slot, SLOT - 4);
        is_intact.then(|| (u32_at(slot, 16), state))
    }

    /// Reads the head of a file.
    fn read(file: &mut File, path: &Path) -> Result<Self, IndexError> {
        let cannot_read = IndexError::io("read", path);
        let mut head = Vec::new();
        for _ in 0..5 {
            head.clear();
            file.seek(SeekFrom::Start(0)).map_err(cannot_read)?;
            Read::by_ref(file).take(HEAD as u64).read_to_end(&mut head).map_err(cannot_read)?;
            if head.len() < HEAD || SLOTS.iter().all(|at| head[*at..][..16] != MAGIC) {
                return Err(no_head(file, &head, path));
            }
            let slots = SLOTS.map(|at| Self::of_slot(&head[at..][..SLOT]));
            let mut versions = slots.iter().flatten().map(|(version, _)| *version);
            if let Some(found) = versions.find(|version| *version != FORMAT_VERSION) {
                return Err(IndexError::other_version(path, found));
            }
            let is_rest_zero =
                SLOTS.iter().all(|at| head[at + SLOT..at + HEAD / 2].iter().all(|byte| *byte == 0));
            if let [Some((_, a)), Some((_, b))] = slots
                && is_rest_zero
            {
                return Ok(if a.number > b.number { a } else { b });
            }
            // A writer may be just about to write it.
            std::thread::sleep(Duration::from_millis(2));
        }
        Err(IndexError::damaged(path, "its head changed"))
    }

    /// Makes it the state of a file whose segments are on disk.
    fn commit(self, file: &mut File) -> io::Result<()> {
        file.seek(SeekFrom::Start(SLOTS[(self.number % 2) as usize] as u64))?;
        file.write_all(&self.to_bytes())?;
        file.sync_all()
    }
}

/// What is wrong with a file that has no head.
fn no_head(file: &mut File, head: &[u8], path: &Path) -> IndexError {
    // Format 1 was a redb database, and ended with the magic.
    let mut end = Vec::new();
    let tail = file.seek(SeekFrom::End(-(MAGIC.len() as i64)));
    let is_format_1 = head.starts_with(b"redb") && tail.is_ok_and(|_| file.read_to_end(&mut end).is_ok());
    if is_format_1 && end == MAGIC {
        return IndexError::other_version(path, 1);
    }
    let is_start = head.len() >= 4 && MAGIC.starts_with(&head[..head.len().min(MAGIC.len())]);
    match is_start {
        true => IndexError::damaged(path, "its end is missing"),
        false => IndexError::Foreign(path.to_owned()),
    }
}

/// An index file. Checks each block as it is read.
#[derive(Debug)]
pub(crate) struct StoredFile {
    path: PathBuf,
    file: Mutex<File>,
    state: State,
    /// The last one first, also those that were taken in by later ones.
    segments: Vec<Segment>,
}

impl StoredFile {
    /// # Errors
    /// [`IndexError::Foreign`], [`IndexError::FutureVersion`], [`IndexError::PastVersion`], [`IndexError::Damaged`],
    /// [`IndexError::Io`].
    pub(crate) fn open(path: &Path) -> Result<Self, IndexError> {
        let cannot_read = IndexError::io("read", path);
        let mut file = File::open(path).map_err(cannot_read)?;
        let about = file.metadata().map_err(cannot_read)?;
        if !about.is_file() {
            return Err(IndexError::Foreign(path.to_owned()));
        }
        let state = State::read(&mut file, path)?;
        if about.len() < state.end {
            let what = format!("{} bytes at its end are missing", state.end - about.len());
            return Err(IndexError::damaged(path, what));
        }
        let file = Mutex::new(file);
        let changed = || IndexError::damaged(path, "its lists of blocks changed");
        let (mut segments, mut end, mut sum) = (Vec::<Segment>::new(), state.end, state.sum);
        let mut below = end;
        while end > HEAD as u64 {
            let segment = Segment::read(&file, end).map_err(cannot_read)?;
            let mut segment = segment.filter(|segment| segment.sum == sum).ok_or_else(changed)?;
            if segment.end == below {
                (segment.counts, below) = (true, segment.below);
            }
            (end, sum) = (segment.start, segment.before);
            segments.push(segment);
        }
        if (end, sum, below) != (HEAD as u64, 0, HEAD as u64) || segments.is_empty() {
            return Err(changed());
        }
        Ok(Self { path: path.to_owned(), file, state, segments })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Bytes of the file that count.
    pub(crate) fn n_bytes(&self) -> u64 {
        self.state.end
    }

    /// A number that changes with the content of the file.
    pub(crate) fn fingerprint(&self) -> u64 {
        self.state.end << 32 ^ u64::from(self.state.sum)
    }

    /// The value of a key.
    pub(super) fn get(&self, key: &[u8]) -> Result<Option<Vec<u8>>, IndexError> {
        for segment in self.segments.iter().filter(|segment| segment.counts) {
            let Some(block) = segment.block_of(key) else { continue };
            let (bytes, mut at) = (self.block(segment, block)?, 0);
            while at < bytes.len() {
                let StoredRecord { key: known, value, end } = self.record(&bytes, at)?;
                if known == key {
                    return Ok(value.map(<[u8]>::to_vec));
                }
                at = end;
            }
        }
        Ok(None)
    }

    /// The segments that count as runs from a key on, the last one first.
    pub(super) fn runs<'a>(&'a self, from: &[u8]) -> impl Iterator<Item = Run<'a>> {
        let (from, counting) = (from.to_vec(), self.segments.iter().filter(|segment| segment.counts));
        counting.map(move |segment| Box::new(Cursor::new(self, segment, &from)) as Run<'a>)
    }

    /// Reads a block.
    fn block(&self, segment: &Segment, i: usize) -> Result<Vec<u8>, IndexError> {
        let block = &segment.blocks[i];
        let mut bytes = vec![0; block.length as usize];
        read_at(&self.file, block.at, &mut bytes).map_err(IndexError::io("read", &self.path))?;
        if crc32fast::hash(&bytes) != block.sum {
            let end = block.at + u64::from(block.length) - 1;
            return Err(IndexError::damaged(&self.path, format!("bytes {} to {end} changed", block.at)));
        }
        match self.record(&bytes, 0)?.key == segment.first_key(block) {
            true => Ok(bytes),
            false => Err(IndexError::damaged(&self.path, "a list of blocks contradicts a block")),
        }
    }

    fn record<'b>(&self, block: &'b [u8], at: usize) -> Result<StoredRecord<'b>, IndexError> {
        record_at(block, at).ok_or_else(|| IndexError::damaged(&self.path, "a block contradicts itself"))
    }

    /// Reads everything, also what no longer counts.
    pub(crate) fn check(&self) -> Result<(), IndexError> {
        let mut records = self.segments.iter().flat_map(|segment| Cursor::new(self, segment, &[]));
        records.try_for_each(|record| record.map(drop))
    }

    /// The file, if changes may be appended to it: it still has its name and its content, may be written, and has no
    /// other name.
    fn appendable(&self) -> Option<File> {
        let file = OpenOptions::new().read(true).write(true).open(&self.path).ok()?;
        let is_same = Self::open(&self.path).is_ok_and(|now| now.fingerprint() == self.fingerprint());
        (is_same && base::files::is_at(&file, &self.path) && !base::files::has_other_names(&file))
            .then_some(file)
    }

    /// Appends changes, which take `n_bytes`. Returns whether it did: after many changes, or where nothing can be
    /// appended, the file is better written anew.
    ///
    /// # Errors
    /// [`IndexError::Io`]; then the file is as it was.
    pub(crate) fn append(&self, changes: Vec<Run<'_>>, mut n_bytes: u64) -> Result<bool, IndexError> {
        let Some((first, later)) = self.segments.split_last() else { return Ok(false) };
        // As much as half of the first segment, so that the time to write the file anew is proportional to the changes.
        let room = (first.n_bytes() / 2).saturating_sub(self.state.end - first.end);
        let (mut taken, mut below) = (changes, self.state.end);
        for segment in later.iter().filter(|segment| segment.counts) {
            if segment.n_bytes() > 2 * n_bytes {
                break;
            }
            n_bytes += segment.n_bytes();
            below = segment.below;
            taken.push(Box::new(Cursor::new(self, segment, &[])));
        }
        let Some(mut file) = self.appendable().filter(|_| n_bytes <= room) else { return Ok(false) };
        let start = self.state.end;
        let write = |file: &mut File| {
            file.set_len(start)?;
            file.seek(SeekFrom::Start(start))?;
            let out = BufWriter::with_capacity(1 << 18, &mut *file);
            let (end, sum) = fill(SegmentWriter::new(out, start, below, self.state.sum), Rows::of(taken))?;
            file.sync_all()?;
            State { number: self.state.number + 1, end, sum }.commit(file)
        };
        let written = write(&mut file);
        if written.is_err() {
            // What follows the end does not count, so it does no harm if it stays.
            let _ = file.set_len(start);
        }
        written.map(|()| true).map_err(|error| IndexError::of_write(&self.path, error))
    }

    /// Writes a file of one segment, which replaces `path` once it is whole. Records come in ascending order.
    ///
    /// # Errors
    /// [`IndexError::Io`]; then the previous file stays.
    pub(crate) fn write(
        path: &Path,
        records: impl Iterator<Item = Result<Record, IndexError>>,
    ) -> Result<(), IndexError> {
        let whole = base::files::fill_atomically(path, |file| write_into(file, records));
        whole.map_err(|error| IndexError::of_write(path, error.source))
    }
}

fn write_into(file: &mut File, records: impl Iterator<Item = Result<Record, IndexError>>) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(1 << 18, &mut *file);
    out.write_all(&[0; HEAD])?;
    let live = records.filter(|record| !matches!(record, Ok((_, None))));
    let (end, sum) = fill(SegmentWriter::new(out, HEAD as u64, HEAD as u64, 0), live)?;
    file.sync_all()?;
    [0, 1].into_iter().try_for_each(|number| State { number, end, sum }.commit(file))
}

fn fill(
    mut segment: SegmentWriter<impl Write>,
    records: impl Iterator<Item = Result<Record, IndexError>>,
) -> io::Result<(u64, u32)> {
    for record in records {
        let (key, value) = record.map_err(io::Error::other)?;
        segment.put(&key, value.as_deref())?;
    }
    segment.finish()
}

/// Writes a file of these records, which need not be in order.
#[cfg(test)]
pub(crate) fn write_forged(path: &Path, records: Vec<Record>) {
    write_into(&mut File::create(path).unwrap(), records.into_iter().map(Ok)).unwrap();
}

/// The records of a segment, from a key on.
struct Cursor<'a> {
    stored: &'a StoredFile,
    segment: &'a Segment,
    from: Vec<u8>,
    /// The block that comes next.
    next: usize,
    block: Vec<u8>,
    at: usize,
    last: Option<Vec<u8>>,
}

impl<'a> Cursor<'a> {
    fn new(stored: &'a StoredFile, segment: &'a Segment, from: &[u8]) -> Self {
        let next = segment.block_of(from).unwrap_or(0);
        Self { stored, segment, from: from.to_vec(), next, block: Vec::new(), at: 0, last: None }
    }

    fn advance(&mut self) -> Result<Option<Record>, IndexError> {
        loop {
            if self.at >= self.block.len() {
                if self.next >= self.segment.blocks.len() {
                    return Ok(None);
                }
                (self.block, self.at) = (self.stored.block(self.segment, self.next)?, 0);
                self.next += 1;
            }
            let StoredRecord { key, value, end } = self.stored.record(&self.block, self.at)?;
            self.at = end;
            if self.last.as_deref().is_some_and(|last| key <= last) {
                return Err(IndexError::damaged(&self.stored.path, "its keys are out of order"));
            }
            if key >= self.from.as_slice() {
                self.last = Some(key.to_vec());
                return Ok(Some((key.to_vec(), value.map(<[u8]>::to_vec))));
            }
        }
    }
}

impl Iterator for Cursor<'_> {
    type Item = Result<Record, IndexError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.advance().transpose()
    }
}
