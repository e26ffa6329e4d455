//! How large a mesh may be.

use mesh::Fault;

/// The most vertices that 32-bit indices can count.
const MOST_VERTICES: u64 = u32::MAX as u64;
/// The most faces whose corners 32-bit indices can count.
const MOST_FACES: u64 = u32::MAX as u64 / 3;

/// The largest mesh to read.
///
/// The numbers in a header are checked before anything else is read. A file without a header is rejected as
/// soon as it exceeds a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadLimits {
    /// Vertices. Default: as many as 32-bit indices can count.
    pub max_vertices: u64,
    /// Triangles. Default: as many as have corners that 32-bit indices can count.
    pub max_faces: u64,
    /// Bytes of a stream, whose size is not known in advance. Default: 8 GiB.
    pub max_bytes: u64,
}

impl Default for ReadLimits {
    fn default() -> Self {
        Self { max_vertices: MOST_VERTICES, max_faces: MOST_FACES, max_bytes: 8 << 30 }
    }
}

impl ReadLimits {
    /// At most `max_vertices` vertices and four times as many faces, twice as many as a closed surface has.
    #[must_use]
    pub fn of_vertices(max_vertices: u64) -> Self {
        let max_vertices = max_vertices.min(MOST_VERTICES);
        let max_faces = max_vertices.saturating_mul(4).min(MOST_FACES);
        Self { max_vertices, max_faces, ..Self::default() }
    }

    /// Returns a fault if a count exceeds its limit.
    pub(super) fn check(&self, n_vertices: u64, n_faces: u64) -> Result<(), Fault> {
        let check = |items, count, limit, most| match count {
            _ if count <= limit => Ok(()),
            _ if limit >= most => Err(Fault::TooLarge { items, count, limit: most }),
            _ => Err(Fault::OverLimit { items, limit }),
        };
        check("vertices", n_vertices, self.max_vertices.min(MOST_VERTICES), MOST_VERTICES)?;
        check("faces", n_faces, self.max_faces.min(MOST_FACES), MOST_FACES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_beyond_the_index_types_are_errors() {
        let limits = ReadLimits::default();
        assert!(limits.check(1 << 32, 0).is_err_and(|f| matches!(f, Fault::TooLarge { .. })));
        assert!(limits.check(3, 1 << 31).is_err_and(|f| matches!(f, Fault::TooLarge { .. })));
        assert_eq!(limits.check(1 << 30, 1 << 30), Ok(()));
    }

    #[test]
    fn counts_beyond_the_given_limits_are_errors() {
        let limits = ReadLimits::of_vertices(100);
        assert_eq!(limits.check(100, 400), Ok(()));
        assert_eq!(limits.check(101, 0), Err(Fault::OverLimit { items: "vertices", limit: 100 }));
        assert_eq!(limits.check(0, 401), Err(Fault::OverLimit { items: "faces", limit: 400 }));
        assert_eq!(ReadLimits::of_vertices(u64::MAX), ReadLimits::default());
    }
}
