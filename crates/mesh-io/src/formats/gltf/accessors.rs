//! Typed arrays of numbers in buffers, dense and sparse.

use nalgebra::Point3;

use super::container::{Buffers, missing};
use super::schema::{self, Accessor, Index, Root};
use crate::binary::{ByteOrder, Scalar};
use crate::located::{At, Located};
use crate::polygons::finite;
use mesh::Fault;

/// The accessors of a file.
pub(super) struct Accessors<'a> {
    pub(super) root: &'a Root,
    pub(super) buffers: Buffers<'a>,
    /// Bytes of all files.
    pub(super) n_bytes: u64,
}

/// How the rows of an accessor are stored.
#[derive(Clone, Copy)]
struct Layout {
    accessor: Index,
    scalar: Scalar,
    width: usize,
}

impl Layout {
    fn at(self, fault: Fault) -> Located {
        fault.in_part("accessor", self.accessor)
    }
}

impl Accessors<'_> {
    /// Number of rows.
    pub(super) fn len(&self, index: Index) -> Result<u64, Located> {
        Ok(self.get(index)?.count)
    }

    /// Positions; integers that are normalised are fractions of their largest value.
    pub(super) fn positions(&self, index: Index) -> Result<Vec<Point3<f64>>, Located> {
        let (accessor, layout) = self.typed(index, "VEC3", 3, "positions of type VEC3")?;
        let numbers = self.numbers(accessor, layout)?;
        let unit = if accessor.normalized { largest(layout.scalar) } else { 1.0 };
        // The most negative integer stands for -1 too.
        let scaled = |x: f64| if accessor.normalized { (x / unit).max(-1.0) } else { x };
        let rows = numbers.as_chunks::<3>().0.iter().enumerate();
        rows.map(|(vertex, row)| finite(row.map(scaled), vertex).map_err(|fault| layout.at(fault))).collect()
    }

    /// Vertex numbers, less than `n_vertices`.
    pub(super) fn indices(&self, index: Index, n_vertices: usize) -> Result<Vec<u32>, Located> {
        let (accessor, layout) = self.typed(index, "SCALAR", 1, "indices of type SCALAR")?;
        if !matches!(layout.scalar, Scalar::U8 | Scalar::U16 | Scalar::U32) {
            let found = format!("{:?}", layout.scalar);
            return Err(layout.at(Fault::syntax("indices that are unsigned integers", found)));
        }
        let numbers = self.numbers(accessor, layout)?;
        match numbers.iter().find(|x| **x >= n_vertices as f64) {
            Some(number) => Err(layout.at(Fault::no_vertex(number.to_string(), 0, n_vertices as u64))),
            None => Ok(numbers.into_iter().map(|x| x as u32).collect()),
        }
    }

    fn get(&self, index: Index) -> Result<&Accessor, Located> {
        let count = self.root.accessors.len();
        self.root.accessors.get(index).ok_or_else(|| missing("accessor", index, count))
    }

    /// An accessor with rows of a kind.
    fn typed(
        &self,
        accessor: Index,
        kind: &str,
        width: usize,
        expected: &'static str,
    ) -> Result<(&Accessor, Layout), Located> {
        let found = self.get(accessor)?;
        match schema::scalar(found.component_type) {
            Some(scalar) if found.kind == kind => Ok((found, Layout { accessor, scalar, width })),
            _ => Err(Fault::syntax(expected, "another type").in_part("accessor", accessor)),
        }
    }

    /// All numbers of an accessor, row by row.
    fn numbers(&self, accessor: &Accessor, layout: Layout) -> Result<Vec<f64>, Located> {
        let count = accessor.count;
        let mut numbers = match accessor.buffer_view {
            Some(view) => self.rows(view, accessor.byte_offset.unwrap_or(0), count, layout, true)?,
            None if accessor.sparse.is_none() => {
                return Err(layout.at(Fault::unsupported(
                    "its numbers are not in the file, as in compressed meshes",
                    "decompress it, for example with `gltf-transform copy in.glb out.glb`",
                )));
            }
            None if count > self.n_bytes => return Err(layout.at(Fault::Inflates { limit: self.n_bytes })),
            None => vec![0.0; count as usize * layout.width],
        };
        let Some(sparse) = &accessor.sparse else { return Ok(numbers) };
        let (places, values, n) = (&sparse.indices, &sparse.values, sparse.count);
        let Some(scalar) = schema::scalar(places.component_type) else {
            return Err(layout.at(Fault::syntax("indices that are unsigned integers", "another type")));
        };
        let of_places = Layout { scalar, width: 1, ..layout };
        let places = self.rows(places.buffer_view, places.byte_offset, n, of_places, false)?;
        let values = self.rows(values.buffer_view, values.byte_offset, n, layout, false)?;
        for (place, row) in places.iter().zip(values.chunks_exact(layout.width)) {
            let Some(slot) = (*place < count as f64).then_some(*place as usize * layout.width) else {
                return Err(layout.at(Fault::no_vertex(place.to_string(), 0, count)));
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
        layout: Layout,
        strided: bool,
    ) -> Result<Vec<f64>, Located> {
        let (bytes, stride) = self.buffers.view(self.root, view)?;
        let size = layout.scalar.size();
        let row = size * layout.width;
        let stride = stride.filter(|_| strided).unwrap_or(row);
        if stride < row {
            let found = format!("{stride} bytes");
            return Err(layout.at(Fault::syntax("a stride no shorter than a row", found)));
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
                layout.at(Fault::truncated("rows", count, found))
            })?;
        let mut numbers = Vec::with_capacity(count as usize * layout.width);
        for i in 0..count as usize {
            let decoded = bytes[i * stride..i * stride + row].chunks_exact(size);
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
