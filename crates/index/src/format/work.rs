//! The file that a writer works in: a database, or what has changed in one.
//!
//! | part | bytes | content |
//! |---|---|---|
//! | head | 4096 | magic: 16; fingerprint of the base, blocks of the map, where the database ends while it is sealed, whether the database is whole: u64 each; CRC-32 of these 48 bytes: u32; zeros |
//! | map | 4096 each | a bit for each of the first blocks of the database: whether it is here |
//! | database | | blocks that are not here are those of the base |
//!
//! A block that is not here leaves a hole in the file. The map is written after the blocks that it lists are on disk, so a
//! writer may be killed at any moment: the database is a file to redb, which survives that. Without a base there is no
//! map, and everything is here.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;
use std::sync::{Arc, Mutex};

use redb::backends::FileBackend;
use redb::{Database, StorageBackend};

use super::IndexError;
use super::guard::Guarded;
use super::overlay::pieces;
use super::sealed::{Appending, BLOCK, HEAD, Sealed, State, lock, seal, sealed_whole};
use super::tables::{CACHE, call};

const MAGIC: [u8; 16] = *b"canonform work \n";
const FIELDS: usize = 52;

/// Blocks listed by one block of the map.
const LISTED: u64 = 8 * BLOCK as u64;

/// What the head of a work file states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Head {
    /// Fingerprint of the base; 0 if there is none.
    base: u64,
    /// Blocks of the map.
    n_map: u64,
    /// Where the database ends, while checksums are appended to it; otherwise 0.
    sealing: u64,
    /// Whether all blocks are here.
    is_whole: bool,
}

impl Head {
    fn write(self, file: &mut File) -> io::Result<()> {
        let mut bytes = MAGIC.to_vec();
        for number in [self.base, self.n_map, self.sealing, u64::from(self.is_whole)] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        bytes.resize(HEAD as usize, 0);
        file.seek(SeekFrom::Start(0))?;
        file.write_all(&bytes)?;
        file.sync_data()
    }

    fn read(file: &mut File) -> io::Result<Option<Self>> {
        let mut bytes = Vec::new();
        file.seek(SeekFrom::Start(0))?;
        Read::by_ref(file).take(FIELDS as u64).read_to_end(&mut bytes)?;
        let Some((fields, sum)) = bytes.split_last_chunk::<4>() else { return Ok(None) };
        if bytes.len() < FIELDS || fields[..16] != MAGIC || crc32fast::hash(fields).to_le_bytes() != *sum {
            return Ok(None);
        }
        let number =
            |i: usize| fields[16 + 8 * i..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
        Ok(Some(Self { base: number(0), n_map: number(1), sealing: number(2), is_whole: number(3) != 0 }))
    }
}

/// A work file that its writer has locked.
#[derive(Debug)]
pub(crate) struct WorkFile {
    file: File,
    head: Head,
    /// Where blocks come from that are not here.
    base: Option<Arc<Sealed>>,
}

impl WorkFile {
    /// Begins with the database of `base`, or with an empty one.
    pub(crate) fn begin(mut file: File, base: Option<Arc<Sealed>>) -> io::Result<Self> {
        file.set_len(0)?;
        // Beyond the map, which has room to grow, everything counts as changed.
        let n_map = base.as_ref().map_or(0, |base| (2 * base.len() / BLOCK as u64 + 1).div_ceil(LISTED));
        let fingerprint = base.as_ref().map_or(0, |base| base.fingerprint());
        let head = Head { base: fingerprint, n_map, sealing: 0, is_whole: base.is_none() };
        file.set_len(HEAD + n_map * BLOCK as u64 + base.as_ref().map_or(0, |base| base.len()))?;
        head.write(&mut file)?;
        Ok(Self { file, head, base })
    }

    /// Continues an interrupted work, also one that had been sealed. Returns `None` if there is none, or if it needs
    /// another base.
    pub(crate) fn resume(
        lock: &File,
        path: &Path,
        base: Option<&Arc<Sealed>>,
    ) -> Result<Option<Self>, IndexError> {
        let cannot_write = IndexError::io("write", path);
        let mut file = lock.try_clone().map_err(cannot_write)?;
        let head = match Head::read(&mut file).map_err(cannot_write)? {
            Some(head) => head,
            None => match sealed_whole(&mut file, path) {
                Ok(Some((end, n_map))) => Head { base: 0, n_map, sealing: end, is_whole: true },
                _ => return Ok(None),
            },
        };
        let fits = base.is_some_and(|base| base.fingerprint() == head.base);
        if !head.is_whole && !fits {
            return Ok(None);
        }
        let base = base.filter(|_| !head.is_whole).cloned();
        let mut work = Self { file, head, base };
        if head.sealing > 0 {
            work.file.set_len(head.sealing).map_err(cannot_write)?;
            work.head.sealing = 0;
            work.head.write(&mut work.file).map_err(cannot_write)?;
        }
        Ok(Some(work))
    }

    /// Opens the database.
    pub(crate) fn database(&self, path: &Path) -> Result<Guarded<Database>, IndexError> {
        let database = call(path, "write", || {
            let backend = self.blocks()?;
            Database::builder().set_cache_size(CACHE).create_with_backend(backend)
        })?;
        Ok(Guarded::new(database))
    }

    fn blocks(&self) -> io::Result<Blocks> {
        let mut file = self.file.try_clone()?;
        let mut map = vec![0; self.head.n_map as usize * BLOCK];
        if !self.head.is_whole {
            file.seek(SeekFrom::Start(HEAD))?;
            file.read_exact(&mut map)?;
        }
        Ok(Blocks {
            file: FileBackend::new(file).map_err(io::Error::other)?,
            start: HEAD + self.head.n_map * BLOCK as u64,
            base: self.base.clone(),
            map: Mutex::new(Map { bits: map, unwritten: BTreeSet::new() }),
        })
    }

    /// Size of the database.
    fn len(&self) -> io::Result<u64> {
        Ok(self.file.metadata()?.len().saturating_sub(HEAD + self.head.n_map * BLOCK as u64))
    }

    /// The blocks of a database that is not open which differ from those of `base`; `None` if everything is here, or if
    /// they take more than `most` bytes.
    pub(crate) fn changed(&self, base: &Sealed, most: u64) -> io::Result<Option<Vec<u64>>> {
        if self.head.is_whole {
            return Ok(None);
        }
        let (blocks, end) = (self.blocks()?, self.len()? / BLOCK as u64);
        let mut changed = Vec::new();
        let [mut ours, mut theirs] = [vec![0; BLOCK], vec![0; BLOCK]];
        for number in blocks.present(end) {
            blocks.file.read(blocks.start + number * BLOCK as u64, &mut ours)?;
            base.read(number * BLOCK as u64, &mut theirs)?;
            if ours != theirs {
                changed.push(number);
            }
            if changed.len() as u64 * BLOCK as u64 > most {
                return Ok(None);
            }
        }
        Ok(Some(changed))
    }

    /// Appends changed blocks to the file of the base. They count once the returned state is committed.
    pub(crate) fn append(&self, changed: &[u64], base: &Sealed, file: &mut File) -> io::Result<State> {
        let blocks = self.blocks()?;
        let mut segment = Appending::new(file, base)?;
        let mut block = vec![0; BLOCK];
        for number in changed {
            blocks.file.read(blocks.start + number * BLOCK as u64, &mut block)?;
            segment.put(*number, &block)?;
        }
        segment.end(base, self.len()?)
    }

    /// Copies what is not here from the base. The database is not open.
    pub(crate) fn fill(&mut self) -> io::Result<()> {
        let Some(base) = self.base.clone() else { return Ok(()) };
        let (blocks, end) = (self.blocks()?, self.len()?.min(base.len()) / BLOCK as u64);
        let mut buffer = vec![0; 256 * BLOCK];
        for range in blocks.absent(end, 256) {
            let part = &mut buffer[..(range.end - range.start) as usize * BLOCK];
            base.read(range.start * BLOCK as u64, part)?;
            blocks.file.write(blocks.start + range.start * BLOCK as u64, part)?;
        }
        drop(blocks);
        // The map does not matter any more.
        let n_map = self.head.n_map as usize;
        self.file.sync_data()?;
        self.head.is_whole = true;
        self.head.write(&mut self.file)?;
        self.file.write_all(&vec![0; n_map * BLOCK])?;
        self.base = None;
        Ok(())
    }

    /// Makes it a finished file. The database is whole and not open.
    pub(crate) fn seal(&mut self) -> io::Result<()> {
        self.head.sealing = self.file.seek(SeekFrom::End(0))?;
        self.head.write(&mut self.file)?;
        seal(&mut self.file, self.head.n_map)
    }

    /// Size of the database in bytes and more; 0 if it is unknown.
    pub(crate) fn n_bytes(&self) -> u64 {
        self.file.metadata().map_or(0, |about| about.len())
    }
}

/// A bit for each block: whether it is here.
#[derive(Debug)]
struct Map {
    bits: Vec<u8>,
    /// Blocks of the map that have changed since they were written.
    unwritten: BTreeSet<u64>,
}

impl Map {
    fn holds(&self, block: u64) -> bool {
        self.bits.get((block / 8) as usize).is_none_or(|bits| bits >> (block % 8) & 1 == 1)
    }

    fn insert(&mut self, block: u64) {
        if let Some(bits) = self.bits.get_mut((block / 8) as usize)
            && *bits >> (block % 8) & 1 == 0
        {
            *bits |= 1 << (block % 8);
            self.unwritten.insert(block / LISTED);
        }
    }
}

/// A database whose blocks are here or in a base. It does not lock the file: the writer has done so.
#[derive(Debug)]
struct Blocks {
    file: FileBackend,
    /// Where block 0 is.
    start: u64,
    base: Option<Arc<Sealed>>,
    map: Mutex<Map>,
}

impl Blocks {
    fn is_here(&self, block: u64) -> bool {
        self.base.is_none() || lock(&self.map).holds(block)
    }

    /// The blocks before `end` that are here, in ascending order.
    fn present(&self, end: u64) -> impl Iterator<Item = u64> {
        let bits = lock(&self.map).bits.clone();
        let listed = 8 * bits.len() as u64;
        let of_byte =
            |(i, bits): (u64, u8)| (0..8).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| 8 * i + bit);
        let here = (0..).zip(bits).filter(|(_, bits)| *bits != 0).flat_map(of_byte);
        here.take_while(move |block| *block < end).chain(listed..end.max(listed))
    }

    /// Ranges of at most `most` blocks before `end` that are not here.
    fn absent(&self, end: u64, most: u64) -> impl Iterator<Item = Range<u64>> {
        let mut at = 0;
        std::iter::from_fn(move || {
            while at < end && self.is_here(at) {
                at += 1;
            }
            let start = at;
            while at < end && at - start < most && !self.is_here(at) {
                at += 1;
            }
            (start < at).then_some(start..at)
        })
    }

    /// Reads a whole block of the base; zeros beyond its end.
    fn read_base(&self, number: u64, block: &mut [u8]) -> io::Result<()> {
        match &self.base {
            Some(base) => base.read(number * BLOCK as u64, block),
            None => {
                block.fill(0);
                Ok(())
            }
        }
    }
}

impl StorageBackend for Blocks {
    fn len(&self) -> io::Result<u64> {
        Ok(self.file.len()?.saturating_sub(self.start))
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        let (first, end) = (offset / BLOCK as u64, (offset + out.len() as u64).div_ceil(BLOCK as u64));
        if (first..end).all(|block| self.is_here(block)) {
            return self.file.read(self.start + offset, out);
        }
        if let Some(base) = &self.base
            && (offset % BLOCK as u64, out.len() % BLOCK) == (0, 0)
            && !(first..end).any(|block| self.is_here(block))
        {
            return base.read(offset, out);
        }
        let mut block = vec![0; BLOCK];
        for (number, inside, piece) in pieces(offset, out.len()) {
            if self.is_here(number) {
                let at = self.start + number * BLOCK as u64 + inside.start as u64;
                self.file.read(at, &mut out[piece])?;
            } else {
                self.read_base(number, &mut block)?;
                out[piece].copy_from_slice(&block[inside]);
            }
        }
        Ok(())
    }

    fn set_len(&self, length: u64) -> io::Result<()> {
        let before = self.len()?;
        self.file.set_len(self.start + length)?;
        // Bytes that are cut off and grown again are zero.
        if self.base.is_some() && length < before {
            let mut map = lock(&self.map);
            let listed = 8 * map.bits.len() as u64;
            (length.div_ceil(BLOCK as u64)..before.div_ceil(BLOCK as u64).min(listed))
                .for_each(|block| map.insert(block));
        }
        Ok(())
    }

    fn sync_data(&self) -> io::Result<()> {
        self.file.sync_data()?;
        let mut map = lock(&self.map);
        if map.unwritten.is_empty() {
            return Ok(());
        }
        for i in std::mem::take(&mut map.unwritten) {
            self.file.write(HEAD + i * BLOCK as u64, &map.bits[i as usize * BLOCK..][..BLOCK])?;
        }
        self.file.sync_data()
    }

    fn close(&self) -> io::Result<()> {
        self.sync_data()
    }

    fn write(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        if self.base.is_none() {
            return self.file.write(self.start + offset, data);
        }
        let mut block = vec![0; BLOCK];
        for (number, inside, _) in pieces(offset, data.len()) {
            // The rest of the block comes from the base.
            if inside.len() < BLOCK && !self.is_here(number) {
                self.read_base(number, &mut block)?;
                self.file.write(self.start + number * BLOCK as u64, &block)?;
            }
        }
        self.file.write(self.start + offset, data)?;
        let mut map = lock(&self.map);
        pieces(offset, data.len()).for_each(|(number, ..)| map.insert(number));
        Ok(())
    }
}
