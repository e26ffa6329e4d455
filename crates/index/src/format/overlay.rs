//! A sealed file as a database: writes stay in memory.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io;
use std::ops::Range;
use std::sync::{Arc, Mutex};

use redb::StorageBackend;

use super::sealed::{BLOCK, Sealed, lock};

/// A sealed file, and in memory the blocks that were written over it: redb writes a little even when it only reads.
#[derive(Debug)]
pub(crate) struct Overlay {
    base: Arc<Sealed>,
    top: Mutex<Top>,
}

#[derive(Debug)]
struct Top {
    length: u64,
    blocks: BTreeMap<u64, Vec<u8>>,
}

impl Overlay {
    pub(crate) fn new(base: Arc<Sealed>) -> Self {
        let top = Top { length: base.len(), blocks: BTreeMap::new() };
        Self { base, top: Mutex::new(top) }
    }

    /// Reads a whole block of the file; zeros beyond its end.
    fn block(&self, number: u64) -> io::Result<Vec<u8>> {
        let mut block = vec![0; BLOCK];
        let start = number * BLOCK as u64;
        if start < self.base.len() {
            let known = (self.base.len() - start).min(BLOCK as u64) as usize;
            self.base.read(start, &mut block[..known])?;
        }
        Ok(block)
    }
}

/// Splits `length` bytes from `offset` on at block boundaries: the number of the block, the range inside it, and the
/// range counted from `offset`.
pub(super) fn pieces(offset: u64, length: usize) -> impl Iterator<Item = (u64, Range<usize>, Range<usize>)> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let (number, start) = ((offset + at as u64) / BLOCK as u64, (offset as usize + at) % BLOCK);
        let first = at;
        at += (BLOCK - start).min(length - at);
        (at > first).then(|| (number, start..start + at - first, first..at))
    })
}

impl StorageBackend for Overlay {
    fn len(&self) -> io::Result<u64> {
        Ok(lock(&self.top).length)
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        let top = lock(&self.top);
        let end = offset + out.len() as u64;
        if end > top.length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let block = BLOCK as u64;
        if top.blocks.range(offset / block..end.div_ceil(block)).next().is_none()
            && offset.is_multiple_of(block)
            && (end.is_multiple_of(block) || end == self.base.len())
        {
            drop(top);
            return self.base.read(offset, out);
        }
        for (number, inside, piece) in pieces(offset, out.len()) {
            match top.blocks.get(&number) {
                Some(block) => out[piece].copy_from_slice(&block[inside]),
                None => out[piece].copy_from_slice(&self.block(number)?[inside]),
            }
        }
        Ok(())
    }

    fn set_len(&self, length: u64) -> io::Result<()> {
        let mut top = lock(&self.top);
        top.length = length;
        // Bytes that are cut off and grown again are zero.
        top.blocks.retain(|number, _| number * (BLOCK as u64) < length);
        if let Some(block) = top.blocks.get_mut(&(length / BLOCK as u64)) {
            block[(length % BLOCK as u64) as usize..].fill(0);
        }
        Ok(())
    }

    fn sync_data(&self) -> io::Result<()> {
        Ok(())
    }

    fn write(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        let mut top = lock(&self.top);
        if offset + data.len() as u64 > top.length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        for (number, inside, piece) in pieces(offset, data.len()) {
            let block = match top.blocks.entry(number) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(vacant) => vacant.insert(self.block(number)?),
            };
            block[inside].copy_from_slice(&data[piece]);
        }
        Ok(())
    }
}
