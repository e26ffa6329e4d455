//! Sorted runs of records in a file.
//!
//! | part | bytes | content |
//! |---|---|---|
//! | blocks | | [records](super::records), ascending by key |
//! | list | | for each block, its length and CRC-32: u32 each; the length of its first key: u32; that key |
//! | footer | 40 | where the segment starts, where the segment that counts below it ends, bytes of the list: u64 each; CRC-32 of the list, of the footer before (0 for the first), and of this footer without this field and the magic that follows: u32 each; `segm` |

use std::fs::File;
use std::io::{self, Write};
use std::ops::Range;
use std::sync::Mutex;

use super::records::{push, read_at, u32_at, u64_at};

/// Bytes of a block, unless a single record is longer.
const BLOCK: usize = 16 << 10;

const FOOTER: usize = 40;
const MAGIC: [u8; 4] = *b"segm";

/// Writes a segment.
pub(super) struct SegmentWriter<W: Write> {
    out: W,
    start: u64,
    /// Where the segment below ends, and the checksum of the footer before.
    below: u64,
    before: u32,
    /// Bytes written so far.
    length: u64,
    block: Vec<u8>,
    first: Vec<u8>,
    list: Vec<u8>,
}

impl<W: Write> SegmentWriter<W> {
    pub(super) fn new(out: W, start: u64, below: u64, before: u32) -> Self {
        let (block, first, list) = (Vec::new(), Vec::new(), Vec::new());
        Self { out, start, below, before, length: 0, block, first, list }
    }

    /// Writes a record. Keys come in ascending order.
    pub(super) fn put(&mut self, key: &[u8], value: Option<&[u8]>) -> io::Result<()> {
        let length = super::records::n_bytes(key, value.map_or(0, <[u8]>::len));
        if !self.block.is_empty() && self.block.len() + length > BLOCK {
            self.end_block()?;
        }
        if self.block.is_empty() {
            self.first = key.to_vec();
        }
        push(&mut self.block, key, value);
        Ok(())
    }

    fn end_block(&mut self) -> io::Result<()> {
        for number in [self.block.len() as u32, crc32fast::hash(&self.block), self.first.len() as u32] {
            self.list.extend(number.to_le_bytes());
        }
        self.list.append(&mut self.first);
        self.length += self.block.len() as u64;
        self.out.write_all(&self.block)?;
        self.block.clear();
        Ok(())
    }

    /// Returns where the segment ends and the checksum of its footer.
    pub(super) fn finish(mut self) -> io::Result<(u64, u32)> {
        if !self.block.is_empty() {
            self.end_block()?;
        }
        let n_list = self.list.len() as u64;
        let mut footer: Vec<u8> =
            [self.start, self.below, n_list].into_iter().flat_map(u64::to_le_bytes).collect();
        footer.extend(crc32fast::hash(&self.list).to_le_bytes());
        footer.extend(self.before.to_le_bytes());
        let sum = crc32fast::hash(&footer);
        footer.extend(sum.to_le_bytes());
        footer.extend(MAGIC);
        self.out.write_all(&self.list)?;
        self.out.write_all(&footer)?;
        self.out.flush()?;
        Ok((self.start + self.length + n_list + FOOTER as u64, sum))
    }
}

/// A block of a segment.
#[derive(Debug)]
pub(super) struct Block {
    pub(super) at: u64,
    pub(super) length: u32,
    pub(super) sum: u32,
    /// Its first key, in the list of the segment.
    first: Range<usize>,
}

/// A segment as readers know it.
#[derive(Debug)]
pub(super) struct Segment {
    pub(super) start: u64,
    pub(super) end: u64,
    /// Where the segment that counts below it ends.
    pub(super) below: u64,
    /// Checksums of its footer and of the one before.
    pub(super) sum: u32,
    pub(super) before: u32,
    /// Whether it counts: no later one has taken it in.
    pub(super) counts: bool,
    list: Vec<u8>,
    pub(super) blocks: Vec<Block>,
}

impl Segment {
    /// Reads the segment that ends at `end`; `None` if there is none.
    pub(super) fn read(file: &Mutex<File>, end: u64) -> io::Result<Option<Self>> {
        let Some(footer_at) = end.checked_sub(FOOTER as u64) else { return Ok(None) };
        let mut footer = [0; FOOTER];
        read_at(file, footer_at, &mut footer)?;
        let [start, below, n_list] = [0, 8, 16].map(|at| u64_at(&footer, at));
        let [list_sum, before, sum] = [24, 28, 32].map(|at| u32_at(&footer, at));
        let is_known = footer[36..] == MAGIC && crc32fast::hash(&footer[..32]) == sum;
        let Some(list_at) = footer_at.checked_sub(n_list).filter(|at| is_known && *at >= start) else {
            return Ok(None);
        };
        let mut list = vec![0; n_list as usize];
        read_at(file, list_at, &mut list)?;
        let blocks = blocks(&list, start, list_at).filter(|_| crc32fast::hash(&list) == list_sum);
        Ok(blocks.map(|blocks| Self { start, end, below, sum, before, counts: false, list, blocks }))
    }

    pub(super) fn n_bytes(&self) -> u64 {
        self.end - self.start
    }

    pub(super) fn first_key(&self, block: &Block) -> &[u8] {
        &self.list[block.first.clone()]
    }

    /// The block that holds a key if the segment does.
    pub(super) fn block_of(&self, key: &[u8]) -> Option<usize> {
        self.blocks.partition_point(|block| self.first_key(block) <= key).checked_sub(1)
    }
}

/// The blocks that a list names; `None` unless they fill the space before it and are in ascending order.
fn blocks(list: &[u8], start: u64, end: u64) -> Option<Vec<Block>> {
    let (mut blocks, mut at, mut place) = (Vec::<Block>::new(), start, 0);
    while place < list.len() {
        let (numbers, rest) = list[place..].split_at_checked(12)?;
        let [length, sum, n_key] = [0, 4, 8].map(|at| u32_at(numbers, at));
        let first = place + 12..place + 12 + rest.get(..n_key as usize)?.len();
        if blocks.last().is_some_and(|last| list[last.first.clone()] >= list[first.clone()]) {
            return None;
        }
        place = first.end;
        blocks.push(Block { at, length, sum, first });
        at = at.checked_add(u64::from(length)).filter(|at| *at <= end)?;
    }
    (at == end).then_some(blocks)
}
