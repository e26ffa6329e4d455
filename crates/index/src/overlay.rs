//! Writes that stay in memory, over a file that is only read.

use std::collections::BTreeMap;
use std::io;
use std::sync::Mutex;

use super::sealed::{BLOCK, Sealed, lock};

/// What was written, block by block, over `base`.
#[derive(Debug)]
pub(super) struct Overlay<B> {
    base: B,
    top: Mutex<Top>,
}

#[derive(Debug)]
struct Top {
    length: u64,
    blocks: BTreeMap<u64, Vec<u8>>,
}

impl Overlay<Sealed> {
    pub(super) fn new(base: Sealed) -> Self {
        let top = Top { length: base.len(), blocks: BTreeMap::new() };
        Self { base, top: Mutex::new(top) }
    }

    pub(super) fn length(&self) -> u64 {
        lock(&self.top).length
    }

    pub(super) fn resize(&self, length: u64) {
        let mut top = lock(&self.top);
        top.length = length;
        // What is cut off and grown again is zero.
        top.blocks.retain(|number, _| number * (BLOCK as u64) < length);
        if let Some(block) = top.blocks.get_mut(&(length / BLOCK as u64)) {
            block[(length % BLOCK as u64) as usize..].fill(0);
        }
    }

    pub(super) fn read_through(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        let top = lock(&self.top);
        let end = offset + out.len() as u64;
        if end > top.length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let blocks = offset / BLOCK as u64..end.div_ceil(BLOCK as u64);
        if top.blocks.range(blocks.clone()).next().is_none() {
            drop(top);
            if offset.is_multiple_of(BLOCK as u64)
                && (end.is_multiple_of(BLOCK as u64) || end == self.base.len())
            {
                return self.base.read(offset, out);
            }
            return self.each(offset, out, |number, place, part| {
                part.copy_from_slice(&self.block(number)?[place..place + part.len()]);
                Ok(())
            });
        }
        self.each(offset, out, |number, place, part| {
            let below;
            let block = match top.blocks.get(&number) {
                Some(block) => block,
                None => {
                    below = self.block(number)?;
                    &below
                }
            };
            part.copy_from_slice(&block[place..place + part.len()]);
            Ok(())
        })
    }

    pub(super) fn write_over(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        let mut top = lock(&self.top);
        if offset + data.len() as u64 > top.length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let mut at = 0;
        while at < data.len() {
            let (number, place) = ((offset + at as u64) / BLOCK as u64, (offset as usize + at) % BLOCK);
            let take = (BLOCK - place).min(data.len() - at);
            let block = match top.blocks.entry(number) {
                std::collections::btree_map::Entry::Occupied(known) => known.into_mut(),
                std::collections::btree_map::Entry::Vacant(gap) => gap.insert(self.block(number)?),
            };
            block[place..place + take].copy_from_slice(&data[at..at + take]);
            at += take;
        }
        Ok(())
    }

    /// Walks the parts of `out` that lie in one block each: the block, where in it, the part.
    fn each(
        &self,
        offset: u64,
        out: &mut [u8],
        mut part: impl FnMut(u64, usize, &mut [u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut at = 0;
        while at < out.len() {
            let (number, place) = ((offset + at as u64) / BLOCK as u64, (offset as usize + at) % BLOCK);
            let take = (BLOCK - place).min(out.len() - at);
            part(number, place, &mut out[at..at + take])?;
            at += take;
        }
        Ok(())
    }

    /// A whole block of the file; zeros where it has none.
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
