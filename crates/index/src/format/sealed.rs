//! Finished index files.
//!
//! A file is a head and one or more segments. The first segment holds the blocks of a whole database, each further one
//! the blocks that an addition or a removal changed. A block counts as it is in the last segment that holds it; blocks
//! of no segment are zero.
//!
//! | part | bytes | content |
//! |---|---|---|
//! | head | 4096 | two slots, at 0 and 2048, and zeros |
//! | slot | 48 | magic: 16; format version: u32; number of the change: u64; where the last segment ends: u64; CRC-32 of all checksums of segments: u32; zeros: 4; CRC-32 of the slot without this field: u32 |
//! | segment | | `b` blocks of 4096 bytes |
//! | | `16 r` | `r` runs: number of the first block, number of blocks: u64 each |
//! | | `4 b` | CRC-32 of each block |
//! | | 24 | `r`, `b`, size of the database: u64 each |
//! | | 40 | where the segment starts: u64; CRC-32 of the 3 parts before: u32; block size: u32; format version: u32; CRC-32 of these 20 bytes and the magic: u32; magic: 16 |
//!
//! All numbers are little-endian. Checksums cover every byte, and each block is checked when it is read, so a changed
//! byte never becomes a result.
//!
//! Nothing that a reader uses is ever written again. A writer appends a segment, flushes it to disk, and then writes the
//! slot that is not in use. What follows the last segment of the newer slot was left by a writer that was interrupted,
//! and does not count.
//!
//! Format 2 is the same without the [graph](super::stored_graph) of nearest neighbours.
//!
//! Format 1 has no head and no runs: the database, a mark of 24 bytes, the checksums of its blocks, and the last 40 bytes,
//! which state the size of the database in the place of the start.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::IndexError;

/// Version of the file format.
pub const FORMAT_VERSION: u32 = 3;

/// Bytes under one checksum: the size of redb's pages, so that reading a page checks exactly that page.
pub(crate) const BLOCK: usize = 4096;

/// Bytes before the first segment.
pub(crate) const HEAD: u64 = BLOCK as u64;

const MAGIC: [u8; 16] = *b"canonform index\n";
const SLOT: usize = 48;
const SLOTS: [usize; 2] = [0, BLOCK / 2];
const COUNTS: u64 = 24;
const FOOTER: u64 = 40;
const MARK: u64 = 24;
/// The first bytes of a redb file.
pub(crate) const DATABASE_MAGIC: [u8; 4] = *b"redb";

/// In runs, the first of blocks that belong to no database.
const PADDING: u64 = u64::MAX;

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    bytes[at..].first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes))
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    bytes[at..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes))
}

/// A finished state of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct State {
    /// Version of the format that wrote it.
    pub(crate) version: u32,
    /// Number of the change that led to it.
    pub(crate) number: u64,
    /// Where its last segment ends.
    pub(crate) end: u64,
    /// CRC-32 of the checksums of its segments.
    sums: u32,
}

impl State {
    fn to_bytes(self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(self.version.to_le_bytes());
        bytes.extend(self.number.to_le_bytes());
        bytes.extend(self.end.to_le_bytes());
        bytes.extend(self.sums.to_le_bytes());
        bytes.extend([0; 4]);
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        bytes
    }

    /// The state in a slot, or the newer version of the format that wrote it; `None` if the slot is damaged.
    fn of_slot(slot: &[u8]) -> Option<Result<Self, u32>> {
        let version = u32_at(slot, 16);
        if slot[..16] != MAGIC || crc32fast::hash(&slot[..SLOT - 4]) != u32_at(slot, SLOT - 4) {
            return None;
        }
        let (number, end, sums) = (u64_at(slot, 20), u64_at(slot, 28), u32_at(slot, 36));
        let state = Self { version, number, end, sums };
        Some(if version > FORMAT_VERSION { Err(version) } else { Ok(state) })
    }

    /// Reads the head of a file; `None` if it has none.
    fn read(file: &mut File, path: &Path) -> Result<Option<Self>, IndexError> {
        let mut head = Vec::new();
        for _ in 0..5 {
            let cannot_read = IndexError::io("read", path);
            head.clear();
            file.seek(SeekFrom::Start(0)).map_err(cannot_read)?;
            Read::by_ref(file).take(HEAD).read_to_end(&mut head).map_err(cannot_read)?;
            if head.len() < BLOCK || SLOTS.iter().all(|at| head[*at..][..16] != MAGIC) {
                return Ok(None);
            }
            let slots = SLOTS.map(|at| Self::of_slot(&head[at..][..SLOT]));
            let is_rest_zero =
                SLOTS.iter().all(|at| head[at + SLOT..at + BLOCK / 2].iter().all(|byte| *byte == 0));
            match slots {
                [Some(Err(found)), _] | [_, Some(Err(found))] => {
                    let (path, supported) = (path.to_owned(), FORMAT_VERSION);
                    return Err(IndexError::FutureVersion { path, found, supported });
                }
                [Some(Ok(a)), Some(Ok(b))] if is_rest_zero => {
                    return Ok(Some(if a.number > b.number { a } else { b }));
                }
                // A writer may be just about to write it.
                _ => std::thread::sleep(Duration::from_millis(2)),
            }
        }
        Err(IndexError::damaged(path, "its head changed"))
    }

    /// Makes it the state of a file whose segments are on disk.
    pub(crate) fn commit(self, file: &mut File) -> io::Result<()> {
        file.seek(SeekFrom::Start(SLOTS[(self.number % 2) as usize] as u64))?;
        file.write_all(&self.to_bytes())?;
        file.sync_all()
    }
}

/// Blocks of a file with their checksums.
#[derive(Debug)]
struct Segment {
    start: u64,
    /// Number of the first block and number of blocks.
    runs: Vec<(u64, u64)>,
    sums: Vec<u8>,
    /// Size of the database in bytes.
    database: u64,
    table_sum: u32,
}

impl Segment {
    /// Reads the segment that ends at `end`. Returns `None` if there is none.
    fn read(file: &mut File, end: u64) -> io::Result<Option<Self>> {
        let mut footer = [0; (COUNTS + FOOTER) as usize];
        let Some(at) = end.checked_sub(COUNTS + FOOTER) else { return Ok(None) };
        file.seek(SeekFrom::Start(at))?;
        file.read_exact(&mut footer)?;
        let (counts, footer) = footer.split_at(COUNTS as usize);
        if footer[24..] != MAGIC || footer_sum(&footer[..20]) != u32_at(footer, 20) {
            return Ok(None);
        }
        let (n_runs, n_blocks, database) = (u64_at(counts, 0), u64_at(counts, 8), u64_at(counts, 16));
        let (start, table_sum) = (u64_at(footer, 0), u32_at(footer, 8));
        let size = |of: u64, bytes: u64| of.checked_mul(bytes);
        let table = size(n_runs, 16).zip(size(n_blocks, 4)).and_then(|(runs, sums)| runs.checked_add(sums));
        let whole =
            table.zip(size(n_blocks, BLOCK as u64)).and_then(|(a, b)| a.checked_add(b)?.checked_add(start));
        let (Some(table), true) = (table, whole == Some(at) && start >= HEAD) else { return Ok(None) };
        file.seek(SeekFrom::Start(at - table))?;
        let mut runs = vec![0; table as usize];
        file.read_exact(&mut runs)?;
        let mut sum = crc32fast::Hasher::new();
        sum.update(&runs);
        sum.update(counts);
        let sums = runs.split_off(16 * n_runs as usize);
        let runs: Vec<(u64, u64)> =
            runs.chunks_exact(16).map(|run| (u64_at(run, 0), u64_at(run, 8))).collect();
        let total = runs.iter().try_fold(0u64, |sum, (first, n)| {
            let is_known = *first == PADDING || first.checked_add(*n)? <= 1 << 50;
            is_known.then_some(sum.checked_add(*n)?)
        });
        let is_intact = sum.finalize() == table_sum && total == Some(n_blocks);
        match is_intact && database.is_multiple_of(BLOCK as u64) {
            true => Ok(Some(Self { start, runs, sums, database, table_sum })),
            false => Ok(None),
        }
    }

    fn n_blocks(&self) -> u64 {
        self.sums.len() as u64 / 4
    }

    /// The table, the counts and the footer.
    fn end_bytes(start: u64, runs: &[(u64, u64)], sums: &[u8], database: u64) -> (Vec<u8>, u32) {
        let mut bytes: Vec<u8> =
            runs.iter().flat_map(|(first, n)| [first.to_le_bytes(), n.to_le_bytes()]).flatten().collect();
        bytes.extend_from_slice(sums);
        for count in [runs.len() as u64, sums.len() as u64 / 4, database] {
            bytes.extend(count.to_le_bytes());
        }
        let table_sum = crc32fast::hash(&bytes);
        let mut footer = start.to_le_bytes().to_vec();
        footer.extend(table_sum.to_le_bytes());
        footer.extend((BLOCK as u32).to_le_bytes());
        footer.extend(FORMAT_VERSION.to_le_bytes());
        footer.extend(footer_sum(&footer).to_le_bytes());
        footer.extend(MAGIC);
        bytes.extend(footer);
        (bytes, table_sum)
    }
}

fn footer_sum(bytes: &[u8]) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    sum.update(bytes);
    sum.update(&MAGIC);
    sum.finalize()
}

/// The CRC-32 of the checksums of segments.
fn sum_of(table_sums: impl Iterator<Item = u32>) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    table_sums.for_each(|table_sum| sum.update(&table_sum.to_le_bytes()));
    sum.finalize()
}

/// Makes a finished file of a head and `padding` blocks that do not count, followed by a database that is not open.
/// Everything is on disk when it returns.
pub(crate) fn seal(file: &mut File, padding: u64) -> io::Result<()> {
    let end = file.seek(SeekFrom::End(0))?;
    if !end.is_multiple_of(BLOCK as u64) || end < HEAD {
        return Err(io::Error::other(format!("a database of {end} bytes does not end with a page")));
    }
    file.seek(SeekFrom::Start(HEAD))?;
    let mut sums = Vec::new();
    let mut block = Vec::with_capacity(BLOCK);
    let mut reader = BufReader::with_capacity(1 << 20, &mut *file);
    loop {
        block.clear();
        (&mut reader).take(BLOCK as u64).read_to_end(&mut block)?;
        if block.is_empty() {
            break;
        }
        sums.extend(crc32fast::hash(&block).to_le_bytes());
    }
    drop(reader);
    let n_blocks = sums.len() as u64 / 4 - padding;
    let runs = [(PADDING, padding), (0, n_blocks)];
    let runs = if padding == 0 { &runs[1..] } else { &runs };
    let (bytes, table_sum) = Segment::end_bytes(HEAD, runs, &sums, n_blocks * BLOCK as u64);
    file.seek(SeekFrom::Start(end))?;
    file.write_all(&bytes)?;
    file.sync_all()?;
    let (end, sums) = (end + bytes.len() as u64, sum_of([table_sum].into_iter()));
    let state = State { version: FORMAT_VERSION, number: 1, end, sums };
    let mut head = vec![0; BLOCK];
    SLOTS.iter().for_each(|at| head[*at..][..SLOT].copy_from_slice(&state.to_bytes()));
    file.seek(SeekFrom::Start(0))?;
    file.write_all(&head)?;
    file.sync_all()
}

/// Where the database of a file that is sealed whole ends, and the number of blocks before it that do not count; `None`
/// for other files.
pub(crate) fn sealed_whole(file: &mut File, path: &Path) -> Result<Option<(u64, u64)>, IndexError> {
    let Some(state) = State::read(file, path)? else { return Ok(None) };
    let segment = Segment::read(file, state.end).map_err(IndexError::io("read", path))?;
    Ok(segment.filter(|segment| segment.start == HEAD).map(|segment| {
        let padding = segment.runs.first().filter(|(first, _)| *first == PADDING).map_or(0, |(_, n)| *n);
        (segment.start + segment.n_blocks() * BLOCK as u64, padding)
    }))
}

/// A segment that is being appended to a finished file.
pub(crate) struct Appending<'a> {
    out: BufWriter<&'a mut File>,
    start: u64,
    runs: Vec<(u64, u64)>,
    sums: Vec<u8>,
}

impl<'a> Appending<'a> {
    /// Begins after the last segment of `base`, where nothing counts.
    pub(crate) fn new(file: &'a mut File, base: &Sealed) -> io::Result<Self> {
        let start = base.state.end;
        file.set_len(start)?;
        file.seek(SeekFrom::Start(start))?;
        Ok(Self { out: BufWriter::with_capacity(1 << 18, file), start, runs: Vec::new(), sums: Vec::new() })
    }

    /// Appends a block of the database. Blocks come in ascending order.
    pub(crate) fn put(&mut self, number: u64, block: &[u8]) -> io::Result<()> {
        match self.runs.last_mut() {
            Some((first, n)) if *first + *n == number => *n += 1,
            _ => self.runs.push((number, 1)),
        }
        self.sums.extend(crc32fast::hash(block).to_le_bytes());
        self.out.write_all(block)
    }

    /// Flushes the segment to disk. Returns the state that makes it count.
    pub(crate) fn end(mut self, base: &Sealed, database: u64) -> io::Result<State> {
        let (bytes, table_sum) = Segment::end_bytes(self.start, &self.runs, &self.sums, database);
        self.out.write_all(&bytes)?;
        self.out.flush()?;
        self.out.get_ref().sync_all()?;
        let end = self.start + self.sums.len() as u64 / 4 * BLOCK as u64 + bytes.len() as u64;
        let known = base.segments.iter().map(|segment| segment.table_sum);
        let (number, sums) = (base.state.number + 1, sum_of(known.chain([table_sum])));
        Ok(State { version: FORMAT_VERSION, number, end, sums })
    }
}

/// A block of a file: its place and its checksum.
#[derive(Debug, Clone, Copy)]
struct Place {
    at: u64,
    sum: [u8; 4],
}

/// The database of a finished file. Checks each block as it is read.
#[derive(Debug)]
pub(crate) struct Sealed {
    file: Mutex<File>,
    pub(crate) state: State,
    /// From the first one on.
    segments: Vec<Segment>,
    /// Where block 0 is in the first segment, and the number of blocks there.
    first: (u64, u64),
    /// Blocks of further segments.
    changed: BTreeMap<u64, Place>,
}

impl Sealed {
    /// # Errors
    /// [`IndexError::Foreign`], [`IndexError::FutureVersion`], [`IndexError::Damaged`], [`IndexError::Io`].
    pub(crate) fn open(path: &Path) -> Result<Self, IndexError> {
        let cannot_read = IndexError::io("read", path);
        let mut file = File::open(path).map_err(cannot_read)?;
        if !file.metadata().map_err(cannot_read)?.is_file() {
            return Err(IndexError::Foreign(path.to_owned()));
        }
        match State::read(&mut file, path)? {
            Some(state) => Self::of_state(file, path, state),
            None => Self::of_format_1(file, path),
        }
    }

    /// Opens a state of a file that need not be the one in its head.
    pub(crate) fn open_state(path: &Path, state: State) -> Result<Self, IndexError> {
        Self::of_state(File::open(path).map_err(IndexError::io("read", path))?, path, state)
    }

    fn of_state(mut file: File, path: &Path, state: State) -> Result<Self, IndexError> {
        let cannot_read = IndexError::io("read", path);
        let length = file.metadata().map_err(cannot_read)?.len();
        if length < state.end {
            let what = format!("{} bytes at its end are missing", state.end - length);
            return Err(IndexError::damaged(path, what));
        }
        let mut segments: Vec<Segment> = Vec::new();
        let mut end = state.end;
        while end > HEAD {
            let segment = Segment::read(&mut file, end).map_err(cannot_read)?;
            let segment = segment.ok_or_else(|| IndexError::damaged(path, "its checksums changed"))?;
            end = segment.start;
            segments.push(segment);
        }
        segments.reverse();
        // Blocks of no segment take no place in the file, but a forged size must not make redb reserve memory.
        let most = state.end.saturating_mul(16).saturating_add(1 << 34);
        if segments.last().is_none_or(|segment| segment.database > most)
            || sum_of(segments.iter().map(|segment| segment.table_sum)) != state.sums
        {
            return Err(IndexError::damaged(path, "its checksums changed"));
        }
        Ok(Self::new(file, state, segments))
    }

    fn new(file: File, state: State, segments: Vec<Segment>) -> Self {
        let mut sealed =
            Self { file: Mutex::new(file), state, first: (0, 0), changed: BTreeMap::new(), segments };
        for (i, segment) in sealed.segments.iter().enumerate() {
            let mut at = segment.start;
            let mut sums = segment.sums.as_chunks::<4>().0.iter();
            for (first, n) in &segment.runs {
                let block = BLOCK as u64;
                let of_run = sums.by_ref().take(*n as usize);
                if i == 0 && *first == 0 {
                    sealed.first = (at, *n);
                    of_run.for_each(drop);
                } else if *first == PADDING {
                    of_run.for_each(drop);
                } else {
                    let places =
                        of_run.zip(0..).map(|(sum, i)| (first + i, Place { at: at + i * block, sum: *sum }));
                    sealed.changed.extend(places);
                }
                at += n * block;
            }
        }
        sealed
    }

    fn of_format_1(mut file: File, path: &Path) -> Result<Self, IndexError> {
        let cannot_read = IndexError::io("read", path);
        let length = file.metadata().map_err(cannot_read)?.len();
        let mut head = Vec::new();
        file.seek(SeekFrom::Start(0)).map_err(cannot_read)?;
        Read::by_ref(&mut file).take(16).read_to_end(&mut head).map_err(cannot_read)?;
        let mut footer = Vec::new();
        file.seek(SeekFrom::Start(length.saturating_sub(FOOTER))).map_err(cannot_read)?;
        Read::by_ref(&mut file).take(FOOTER).read_to_end(&mut footer).map_err(cannot_read)?;
        if length < FOOTER || footer[24..] != MAGIC {
            let is_start = head.len() >= 4 && (head.starts_with(&DATABASE_MAGIC) || MAGIC.starts_with(&head));
            return Err(match is_start {
                true => IndexError::damaged(path, "its end is missing"),
                false => IndexError::Foreign(path.to_owned()),
            });
        }
        let database = u64_at(&footer, 0);
        let table = database.div_ceil(BLOCK as u64).saturating_mul(4);
        let is_intact = footer_sum(&footer[..20]) == u32_at(&footer, 20) && u32_at(&footer, 16) == 1;
        if !is_intact || database.checked_add(table + MARK + FOOTER) != Some(length) {
            return Err(IndexError::damaged(path, "its footer changed, or bytes before it are missing"));
        }
        let (mut mark, mut sums) = ([0; MARK as usize], vec![0; table as usize]);
        file.seek(SeekFrom::Start(database)).map_err(cannot_read)?;
        file.read_exact(&mut mark).map_err(cannot_read)?;
        file.read_exact(&mut sums).map_err(cannot_read)?;
        let table_sum = u32_at(&footer, 8);
        let is_marked = mark[..12] == *b"canonform ->"
            && u64_at(&mark, 12) == database
            && crc32fast::hash(&mark[..20]) == u32_at(&mark, 20);
        if crc32fast::hash(&sums) != table_sum || !is_marked || !database.is_multiple_of(BLOCK as u64) {
            return Err(IndexError::damaged(path, "its checksums changed"));
        }
        let state = State { version: 1, number: 0, end: database, sums: table_sum };
        let runs = vec![(0, database / BLOCK as u64)];
        Ok(Self::new(file, state, vec![Segment { start: 0, runs, sums, database, table_sum }]))
    }

    /// Size of the database in bytes.
    pub(crate) fn len(&self) -> u64 {
        self.segments.last().map_or(0, |segment| segment.database)
    }

    /// Bytes of the file that count.
    pub(crate) fn n_bytes(&self) -> u64 {
        self.state.end
    }

    /// A number that changes with the content of the file.
    pub(crate) fn fingerprint(&self) -> u64 {
        self.state.end << 32 ^ u64::from(self.state.sums)
    }

    /// Bytes that additions may append before the file is better written anew: as many as the first segment has, so that
    /// the time this takes is proportional to what was added. `None` if nothing can be appended.
    pub(crate) fn room(&self) -> Option<u64> {
        /// Each is read when the file is opened.
        const MOST_SEGMENTS: usize = 1000;
        let start = HEAD + self.first.1 * BLOCK as u64;
        let appended = self.state.end.saturating_sub(start);
        let room = self.first.1 * BLOCK as u64 / 2;
        (self.state.version == FORMAT_VERSION && self.segments.len() < MOST_SEGMENTS)
            .then(|| room.saturating_sub(appended))
    }

    /// Checks all blocks, those that no longer count included. Calls `done` after each mebibyte.
    ///
    /// # Errors
    /// An [`io::Error`] that names the first block that changed.
    pub(crate) fn check(&self, mut done: impl FnMut()) -> io::Result<()> {
        const STEP: usize = 256;
        let mut buffer = vec![0; STEP * BLOCK];
        for segment in &self.segments {
            let places = segment.sums.as_chunks::<4>().0.chunks(STEP);
            for (i, sums) in places.enumerate() {
                let at = segment.start + (i * STEP * BLOCK) as u64;
                let buffer = &mut buffer[..sums.len() * BLOCK];
                self.read_at(at, buffer, |i| sums[i])?;
                done();
            }
        }
        Ok(())
    }

    /// Reads whole blocks of the database.
    pub(crate) fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        let (first, n) = (offset / BLOCK as u64, out.len() / BLOCK);
        let end = first + n as u64;
        if end <= self.first.1 && self.changed.range(first..end).next().is_none() {
            let sums = self.segments[0].sums.as_chunks::<4>().0;
            let before = (self.first.0 - self.segments[0].start) as usize / BLOCK + first as usize;
            return self.read_at(self.first.0 + offset, out, |i| sums[before + i]);
        }
        for (number, block) in (first..end).zip(out.chunks_mut(BLOCK)) {
            match self.place(number) {
                Some(Place { at, sum }) => self.read_at(at, block, |_| sum)?,
                None => block.fill(0),
            }
        }
        Ok(())
    }

    /// Where a block of the database is; `None` if it is in no segment.
    fn place(&self, number: u64) -> Option<Place> {
        self.changed.get(&number).copied().or_else(|| {
            let before = (self.first.0 - self.segments[0].start) / BLOCK as u64;
            let sum = (number < self.first.1)
                .then(|| self.segments[0].sums.as_chunks::<4>().0.get((before + number) as usize))??;
            Some(Place { at: self.first.0 + number * BLOCK as u64, sum: *sum })
        })
    }

    /// Reads blocks at a place of the file.
    fn read_at(&self, at: u64, out: &mut [u8], sum: impl Fn(usize) -> [u8; 4]) -> io::Result<()> {
        {
            let mut file = lock(&self.file);
            file.seek(SeekFrom::Start(at))?;
            file.read_exact(out)?;
        }
        for (i, block) in out.chunks(BLOCK).enumerate() {
            if sum(i) != crc32fast::hash(block).to_le_bytes() {
                let start = at + (i * BLOCK) as u64;
                let what = format!("bytes {start} to {} changed", start + BLOCK as u64 - 1);
                return Err(io::Error::new(io::ErrorKind::InvalidData, what));
            }
        }
        Ok(())
    }
}

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
