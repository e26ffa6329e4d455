//! LAS, point clouds of laser scanners (ASPRS, LAS 1.0 to 1.4).

#[cfg(test)]
use nalgebra::Point3;

use crate::error::{Fault, Located};
use crate::io::binary::{ByteOrder, Scalar};
use crate::io::facts::MeshFile;
use crate::io::limits::ReadLimits;
use crate::io::polygons::{finish, finite};
use crate::tri_mesh::TriMesh;

/// Bytes of the header that all versions have.
const HEADER: usize = 227;

/// Bytes of the three coordinates of a point, which its record begins with.
const COORDINATES: usize = 12;

/// Checks the header, and that the file is as long as it promises.
pub(super) fn check_start(start: &[u8], size: Option<u64>) -> Result<(), Located> {
    match start.trim_ascii() {
        [] => Err(Fault::Empty.whole()),
        _ if !start.starts_with(b"LASF") => {
            Err(Fault::wrong_format("a LAS file", "it does not begin with `LASF`").whole())
        }
        _ => Header::parse(start)?.check(size),
    }
}

/// Where the points are.
struct Header {
    start: u64,
    /// Bytes from one point to the next.
    length: u64,
    promised: u64,
    scale: [f64; 3],
    offset: [f64; 3],
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Self, Located> {
        if bytes.len() < HEADER {
            let expected = format!("the rest of a header of {HEADER} bytes");
            return Err(Fault::cut_short(expected).at_byte(bytes.len()));
        }
        if bytes[104] & 0x80 != 0 {
            let remedy = "decompress the file to LAS, for example with `pdal translate`";
            return Err(Fault::unsupported("compressed points (LAZ)", remedy).at_byte(104));
        }
        let integer = |at, scalar| number(bytes, at, scalar) as u64;
        let promised = match (bytes[25], integer(107, Scalar::U32)) {
            // From version 1.4 on, the number of points has 64 bits elsewhere; old programs may still find it here.
            (4.., 0) => integer(247, Scalar::U64),
            (_, promised) => promised,
        };
        Ok(Self {
            start: integer(96, Scalar::U32),
            length: integer(105, Scalar::U16),
            promised,
            scale: [131, 139, 147].map(|at| number(bytes, at, Scalar::F64)),
            offset: [155, 163, 171].map(|at| number(bytes, at, Scalar::F64)),
        })
    }

    fn check(&self, size: Option<u64>) -> Result<(), Located> {
        let &Self { start, length, promised, .. } = self;
        if length < COORDINATES as u64 {
            let found = format!("{length} bytes");
            return Err(Fault::syntax("records of at least 12 bytes", found).at_byte(105));
        }
        match size.map(|size| size.saturating_sub(start) / length) {
            Some(found) if found < promised => Err(Fault::truncated("points", promised, found).whole()),
            _ => Ok(()),
        }
    }
}

/// The number at a byte; NaN beyond the end.
fn number(bytes: &[u8], at: usize, scalar: Scalar) -> f64 {
    scalar.decode(ByteOrder::Little, bytes.get(at..).unwrap_or_default()).unwrap_or(f64::NAN)
}

/// Reads the coordinates of all points; what else is known of them is ignored.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let bytes = files[0];
    check_start(bytes, Some(bytes.len() as u64))?;
    let header = Header::parse(bytes)?;
    limits.check(header.promised, 0).map_err(Fault::whole)?;
    let mut positions = Vec::with_capacity(header.promised as usize);
    for point in 0..header.promised {
        let at = (header.start + point * header.length) as usize;
        let coordinate = |i| number(bytes, at + 4 * i, Scalar::I32) * header.scale[i] + header.offset[i];
        let position = finite([0, 1, 2].map(coordinate), point as usize);
        positions.push(position.map_err(|fault| fault.at_byte(at))?);
    }
    finish(TriMesh { positions, faces: Vec::new() }, limits)
}

/// A file of points at multiples of 1e-4, of version 1.2 or 1.4.
#[cfg(test)]
pub(super) fn sample(points: &[Point3<f64>], minor: u8) -> Vec<u8> {
    const RECORD: u16 = 20;
    let start: u32 = if minor < 4 { 227 } else { 375 };
    let mut bytes = vec![0; start as usize];
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
    put(0, b"LASF");
    put(24, &[1, minor]);
    put(96, &start.to_le_bytes());
    put(105, &RECORD.to_le_bytes());
    match minor {
        4 => put(247, &(points.len() as u64).to_le_bytes()),
        _ => put(107, &(points.len() as u32).to_le_bytes()),
    }
    for i in 0..3 {
        put(131 + 8 * i, &1e-4f64.to_le_bytes());
        put(155 + 8 * i, &100f64.to_le_bytes());
    }
    for p in points {
        p.iter().for_each(|x| bytes.extend((((x - 100.0) * 1e4).round() as i32).to_le_bytes()));
        bytes.resize(bytes.len() + usize::from(RECORD) - COORDINATES, 7);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    fn parse(bytes: &[u8]) -> Result<TriMesh, Fault> {
        let file = super::parse(&[bytes], &ReadLimits::default());
        file.map(|file| file.mesh).map_err(|located| located.fault)
    }

    #[test]
    fn points_are_scaled_and_moved_in_all_versions() {
        let ball = shapes::icosphere(1);
        for minor in [2, 4] {
            let found = parse(&sample(&ball.positions, minor)).unwrap();
            assert_eq!((found.n_vertices(), found.n_faces()), (42, 0));
            let gap = |(p, q): (&Point3<f64>, &Point3<f64>)| (p - q).norm();
            assert!(found.positions.iter().zip(&ball.positions).all(|pair| gap(pair) < 1e-4));
        }
    }

    #[test]
    fn forged_headers_are_errors() {
        let whole = sample(&shapes::icosphere(1).positions, 2);
        let with = |at: usize, value: &[u8]| {
            let mut bytes = whole.clone();
            bytes[at..at + value.len()].copy_from_slice(value);
            parse(&bytes)
        };
        assert!(matches!(with(0, b"LAZF"), Err(Fault::WrongFormat { .. })));
        assert!(matches!(with(104, &[0x83]), Err(Fault::Unsupported { .. })));
        assert!(matches!(with(105, &[3, 0]), Err(Fault::Syntax { .. })));
        assert!(matches!(with(107, &[43, 0]), Err(Fault::Truncated { promised: 43, found: 42, .. })));
        assert!(matches!(with(107, &[5, 0]), Err(Fault::NoFaces { n_vertices: 5 })));
        assert!(matches!(with(131, &f64::NAN.to_le_bytes()), Err(Fault::NonFinite { vertex: 0, .. })));
        assert!(matches!(parse(&whole[..200]), Err(Fault::CutShort { .. })));
        assert_eq!(parse(b""), Err(Fault::Empty));
    }
}
