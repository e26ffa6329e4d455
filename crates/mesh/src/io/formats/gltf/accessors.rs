//! Typed arrays of numbers in buffers, dense and sparse.

use super::container::{Buffers, missing};
use super::schema::{self, Accessor, Index, Root};
use crate::error::{Fault, Located, Place};
use crate::io::binary::{ByteOrder, Scalar};

/// The accessors of a file.
pub(super) struct Accessors<'a> {
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    /// Bytes of all files.
    n_bytes: u64,
}

/// How rows of numbers are stored.
struct Layout {
    scalar: Scalar,
    width: usize,
}

impl<'a> Accessors<'a> {
    pub(super) fn new(root: &'a Root, buffers: &'a Buffers<'a>, n_bytes: u64) -> Self {
        Self { root, buffers, n_bytes }
    }

    /// Number of rows.
    pub(super) fn len(&self, index: Index) -> Result<u64, Located> {
        Ok(self.get(index)?.count)
    }

    /// Rows of three coordinates; integers that are normalised are fractions of their largest value.
    pub(super) fn positions(&self, index: Index) -> Result<Vec<[f64; 3]>, Located> {
        let accessor = self.get(index)?;
        let at = |fault: Fault| fault.at(Place::Part("accessor", index));
        let ("VEC3", Some(scalar)) = (accessor.kind.as_str(), schema::scalar(accessor.component_type)) else {
            let found = "another type".to_owned();
            return Err(at(Fault::Syntax { expected: "positions of type VEC3", found }));
        };
        let numbers = self.numbers(accessor, index, &Layout { scalar, width: 3 })?;
        let unit = if accessor.normalized { largest(scalar) } else { 1.0 };
        // The most negative integer stands for -1 too.
        let scaled = |x: &f64| if accessor.normalized { (x / unit).max(-1.0) } else { *x };
        let rows: Vec<[f64; 3]> =
            numbers.as_chunks().0.iter().map(|row: &[f64; 3]| row.each_ref().map(scaled)).collect();
        let is_bad = |row: &[f64; 3]| row.iter().find(|x| !x.is_finite()).copied();
        match rows.iter().enumerate().find_map(|(vertex, row)| Some((vertex as u64, is_bad(row)?))) {
            Some((vertex, value)) => Err(at(Fault::NonFinite { vertex, value })),
            None => Ok(rows),
        }
    }

    /// Vertex numbers, less than `n_vertices`.
    pub(super) fn indices(&self, index: Index, n_vertices: usize) -> Result<Vec<u32>, Located> {
        let accessor = self.get(index)?;
        let at = |fault: Fault| fault.at(Place::Part("accessor", index));
        let ("SCALAR", Some(scalar)) = (accessor.kind.as_str(), schema::scalar(accessor.component_type))
        else {
            let found = "another type".to_owned();
            return Err(at(Fault::Syntax { expected: "indices of type SCALAR", found }));
        };
        if !matches!(scalar, Scalar::U8 | Scalar::U16 | Scalar::U32) {
            let found = format!("{scalar:?}");
            return Err(at(Fault::Syntax { expected: "indices that are unsigned integers", found }));
        }
        let numbers = self.numbers(accessor, index, &Layout { scalar, width: 1 })?;
        if let Some(index) = numbers.iter().find(|x| **x >= n_vertices as f64) {
            let last = (n_vertices as u64).saturating_sub(1);
            return Err(at(Fault::IndexOutOfRange { index: index.to_string(), first: 0, last }));
        }
        Ok(numbers.into_iter().map(|x| x as u32).collect())
    }

    fn get(&self, index: Index) -> Result<&Accessor, Located> {
        let count = self.root.accessors.len();
        self.root.accessors.get(index).ok_or_else(|| missing("accessor", index, count))
    }

    /// All numbers of an accessor, row by row.
    fn numbers(&self, accessor: &Accessor, number: usize, layout: &Layout) -> Result<Vec<f64>, Located> {
        let at = |fault: Fault| fault.at(Place::Part("accessor", number));
        let count = accessor.count;
        let mut numbers = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or(0);
                self.rows(view, offset, count, layout, true, number)?
            }
            None if accessor.sparse.is_none() => {
                return Err(at(Fault::Unsupported {
                    what: "its numbers are not in the file, as in compressed meshes".into(),
                    remedy: "decompress it, for example with `gltf-transform copy in.glb out.glb`",
                }));
            }
            None if count > self.n_bytes => return Err(at(Fault::Inflates { limit: self.n_bytes })),
            None => vec![0.0; count as usize * layout.width],
        };
        let Some(sparse) = &accessor.sparse else { return Ok(numbers) };
        let Some(scalar) = schema::scalar(sparse.indices.component_type) else {
            let found = "another type".to_owned();
            return Err(at(Fault::Syntax { expected: "indices that are unsigned integers", found }));
        };
        let places = Layout { scalar, width: 1 };
        let (of_places, of_values) = (&sparse.indices, &sparse.values);
        let n = sparse.count;
        let places = self.rows(of_places.buffer_view, of_places.byte_offset, n, &places, false, number)?;
        let values = self.rows(of_values.buffer_view, of_values.byte_offset, n, layout, false, number)?;
        for (place, row) in places.iter().zip(values.chunks_exact(layout.width)) {
            let Some(slot) = (*place < count as f64).then_some(*place as usize * layout.width) else {
                let (index, last) = (place.to_string(), count.saturating_sub(1));
                return Err(at(Fault::IndexOutOfRange { index, first: 0, last }));
            };
            numbers[slot..slot + layout.width].copy_from_slice(row);
        }
        Ok(numbers)
    }

    /// Rows of a buffer view.
    fn rows(
        &self,
        view: Index,
        offset: u64,
        count: u64,
        layout: &Layout,
        strided: bool,
        number: usize,
    ) -> Result<Vec<f64>, Located> {
        let (bytes, stride) = self.buffers.view(self.root, view)?;
        let row = layout.scalar.size() * layout.width;
        let stride = stride.filter(|_| strided).unwrap_or(row);
        let at = |fault: Fault| fault.at(Place::Part("accessor", number));
        if stride < row {
            let found = format!("{stride} bytes");
            return Err(at(Fault::Syntax { expected: "a stride no shorter than a row", found }));
        }
        let needed = match count {
            0 => Some(offset),
            _ => (count - 1)
                .checked_mul(stride as u64)
                .and_then(|last| last.checked_add(offset)?.checked_add(row as u64)),
        };
        let bytes = needed
            .filter(|needed| *needed <= bytes.len() as u64)
            .and_then(|_| bytes.get(offset as usize..))
            .ok_or_else(|| {
                let found = (bytes.len() as u64).saturating_sub(offset) / stride as u64;
                at(Fault::Truncated { items: "rows".into(), promised: count, found })
            })?;
        let mut numbers = Vec::with_capacity(count as usize * layout.width);
        for i in 0..count as usize {
            let row = &bytes[i * stride..i * stride + row];
            let decoded = row.chunks_exact(layout.scalar.size());
            numbers.extend(decoded.filter_map(|bytes| layout.scalar.decode(ByteOrder::Little, bytes)));
        }
        Ok(numbers)
    }
}

/// The integer that stands for 1.
fn largest(scalar: Scalar) -> f64 {
    match scalar {
        Scalar::I8 => f64::from(i8::MAX),
        Scalar::U8 => f64::from(u8::MAX),
        Scalar::I16 => f64::from(i16::MAX),
        Scalar::U16 => f64::from(u16::MAX),
        Scalar::U32 => f64::from(u32::MAX),
        _ => 1.0,
    }
}
