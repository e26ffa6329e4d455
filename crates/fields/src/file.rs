//! Fields as files.
//!
//! | part | content |
//! |---|---|
//! | head | `canonfld`, the format (`u32`), the length of the text and nine counts (`u32`), four lengths (`f64`) |
//! | text | method and repair, as JSON |
//! | surface | faces (3 x `u32`), edge lengths (`f64`), links (2 x `u32`, `f64`) |
//! | map | the repaired vertex of each input vertex (`u32`, the largest for none); left out if none changed |
//! | landmarks | repaired vertices (`u32`) |
//! | columns | distances in quanta (`u16`), one row per vertex |
//! | factors | entries in quanta (`i16`), one row per vertex |
//! | end | CRC-32 of everything before (`u32`) |
//!
//! All numbers are little-endian. A reader checks the checksum, then that the counts make up the length, before it reserves
//! memory, and then every number that others refer to.

use std::path::Path;
use std::sync::Mutex;

use base::files::FileError;
use surface::{IntrinsicMesh, Link, Topology, VertexId};

use crate::distance_field::{DistanceField, VertexMap};
use crate::error::FieldError;
use crate::fault::FieldFault;
use crate::metric::{ColumnError, LandmarkMetric, Tables};

const MAGIC: &[u8; 8] = b"canonfld";

/// The format that this version reads and writes.
const VERSION: u32 = 1;

/// Bytes of the checksum.
const SUM: usize = 4;

/// The fault of a file that ends too early.
const CUT: FieldFault = FieldFault::Damaged("it has been cut");

/// Stands for a dropped vertex.
const DROPPED: u32 = u32::MAX;

/// The sizes of all parts.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    text: usize,
    /// Vertices of the input.
    n_input: usize,
    /// Vertices of the repaired mesh.
    n_vertices: usize,
    n_faces: usize,
    n_edges: usize,
    n_links: usize,
    n_landmarks: usize,
    n_exact: usize,
    rank: usize,
    n_positive: usize,
    /// Entries of the map.
    n_mapped: usize,
}

impl Counts {
    const N: usize = 11;

    /// In the order of the file.
    fn in_order(&mut self) -> [&mut usize; Self::N] {
        [
            &mut self.text,
            &mut self.n_input,
            &mut self.n_vertices,
            &mut self.n_faces,
            &mut self.n_edges,
            &mut self.n_links,
            &mut self.n_landmarks,
            &mut self.n_exact,
            &mut self.rank,
            &mut self.n_positive,
            &mut self.n_mapped,
        ]
    }

    /// The length of the file, in bytes.
    fn n_bytes(&self) -> u64 {
        // Counts have 32 bits, so only the tables per vertex could overflow 64 bits in a sum, and they cannot either.
        let [text, n_faces, n_edges, n_links] =
            [self.text, self.n_faces, self.n_edges, self.n_links].map(|n| n as u64);
        let head = (MAGIC.len() + size_of::<u32>() * (1 + Self::N) + size_of::<f64>() * 4) as u64;
        let surface = 12 * n_faces + 8 * n_edges + 16 * n_links;
        let vertices = 4 * (self.n_mapped as u64 + self.n_landmarks as u64);
        let table = |columns: usize| (self.n_vertices as u64).saturating_mul(2 * columns as u64);
        let tables = table(self.n_landmarks).saturating_add(table(self.rank));
        (head + text + surface + vertices + SUM as u64).saturating_add(tables)
    }
}

impl DistanceField {
    /// Writes the field to a file, which is complete or absent.
    ///
    /// # Errors
    /// [`FieldError::File`].
    pub fn save(&self, path: &Path) -> Result<(), FieldError> {
        let bytes = self.to_bytes();
        Ok(base::files::write_atomically(path, |out| out.write_all(&bytes))?)
    }

    /// Reads a field.
    ///
    /// # Errors
    /// [`FieldError::File`]; [`FieldError::BadField`] if it is damaged or no field.
    pub fn open(path: &Path) -> Result<Self, FieldError> {
        let bytes = std::fs::read(path).map_err(|source| FileError::read(path, source))?;
        Self::from_bytes(&bytes).map_err(|fault| FieldError::BadField { path: path.to_owned(), fault })
    }

    /// The size of its file, in bytes.
    pub(crate) fn n_bytes(&self) -> usize {
        usize::try_from(self.counts(self.text().len()).n_bytes()).unwrap_or(usize::MAX)
    }

    fn text(&self) -> String {
        serde_json::to_string(&self.provenance).unwrap_or_else(|fault| unreachable!("plain data: {fault}"))
    }

    fn counts(&self, text: usize) -> Counts {
        let tables = self.metric.tables();
        let topology = self.surface.topology();
        Counts {
            text,
            n_input: self.map.n_input,
            n_vertices: topology.n_vertices(),
            n_faces: topology.n_faces(),
            n_edges: topology.n_edges(),
            n_links: self.surface.links().len(),
            n_landmarks: tables.n_landmarks,
            n_exact: tables.n_exact,
            rank: tables.rank,
            n_positive: tables.n_positive,
            n_mapped: self.map.to_repaired.as_ref().map_or(0, Vec::len),
        }
    }

    /// The content of its file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let text = self.text();
        let mut counts = self.counts(text.len());
        let tables = self.metric.tables();
        let mut out = Vec::with_capacity(self.n_bytes());
        out.extend_from_slice(MAGIC);
        out.extend(VERSION.to_le_bytes());
        out.extend(counts.in_order().into_iter().flat_map(|count| (*count as u32).to_le_bytes()));
        let lengths = [tables.quantum, tables.error.over, tables.error.under, tables.factor_quantum];
        out.extend(lengths.into_iter().flat_map(f64::to_le_bytes));
        out.extend_from_slice(text.as_bytes());
        let vertex = |v: VertexId| v.0.to_le_bytes();
        out.extend(self.surface.topology().faces().iter().flatten().copied().flat_map(vertex));
        out.extend(self.surface.edge_lengths().iter().flat_map(|length| length.to_le_bytes()));
        for link in self.surface.links() {
            out.extend(link.ends.into_iter().flat_map(vertex));
            out.extend(link.length.to_le_bytes());
        }
        let map = self.map.to_repaired.iter().flatten();
        out.extend(map.flat_map(|to| vertex(to.unwrap_or(VertexId(DROPPED)))));
        out.extend(self.landmarks.iter().copied().flat_map(vertex));
        out.extend(tables.codes.iter().flat_map(|code| code.to_le_bytes()));
        out.extend(tables.factor.iter().flat_map(|code| code.to_le_bytes()));
        out.extend(crc32fast::hash(&out).to_le_bytes());
        out
    }

    /// Reads the content of a file.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FieldFault> {
        use FieldFault::{Damaged, NotAField, OtherVersion};
        let mut rest = bytes.strip_prefix(MAGIC).ok_or(NotAField)?;
        let found = u32::from_le_bytes(*take(&mut rest).ok_or(CUT)?);
        if found != VERSION {
            return Err(OtherVersion { found, known: VERSION });
        }
        let (content, sum) = bytes.split_last_chunk::<SUM>().ok_or(CUT)?;
        if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
            return Err(Damaged("its checksum is wrong"));
        }
        let mut counts = Counts::default();
        for count in counts.in_order() {
            *count = u32::from_le_bytes(*take(&mut rest).ok_or(CUT)?) as usize;
        }
        if counts.n_bytes() != bytes.len() as u64 {
            return Err(Damaged("its length is wrong"));
        }
        let mut lengths = [0.0; 4];
        for length in &mut lengths {
            *length = f64::from_le_bytes(*take(&mut rest).ok_or(CUT)?);
        }
        Parts { rest, counts, lengths }.field().map_err(Damaged)
    }
}

/// The first bytes of `rest`, which are taken from it.
fn take<'a, const N: usize>(rest: &mut &'a [u8]) -> Option<&'a [u8; N]> {
    let (first, others) = rest.split_first_chunk()?;
    *rest = others;
    Some(first)
}

/// What follows the head.
struct Parts<'a> {
    rest: &'a [u8],
    counts: Counts,
    lengths: [f64; 4],
}

impl Parts<'_> {
    /// The field, or what is wrong with it.
    fn field(mut self) -> Result<DistanceField, &'static str> {
        let Counts { text, n_input, n_vertices, n_faces, n_edges, n_links, n_landmarks, .. } = self.counts;
        let Counts { n_exact, rank, n_positive, n_mapped, .. } = self.counts;
        // Tables with columns make the length of the file a bound of the number of vertices.
        if n_landmarks == 0 || rank == 0 {
            return Err("it has no tables");
        }
        let (text, rest) = self.rest.split_at_checked(text).ok_or("it has been cut")?;
        self.rest = rest;
        let provenance = serde_json::from_slice(text).map_err(|_| "its options are unknown")?;
        let is_vertex = |v: VertexId| v.index() < n_vertices;
        let is_length = |length: f64| length.is_finite() && length >= 0.0;

        let faces: Vec<[VertexId; 3]> =
            self.numbers(n_faces, |bytes: &[u8; 12]| words::<12, 3>(bytes).map(VertexId))?;
        if faces.iter().any(|&[a, b, c]| a == b || b == c || c == a || ![a, b, c].into_iter().all(is_vertex))
        {
            return Err("a face is impossible");
        }
        if n_vertices > Topology::MAX_VERTICES || n_faces > Topology::MAX_FACES {
            return Err("it has more vertices or faces than a mesh may have");
        }
        let topology = Topology::new(n_vertices, faces);
        if topology.n_edges() != n_edges {
            return Err("it has another number of edges");
        }
        let edges = self.numbers(n_edges, |bytes| f64::from_le_bytes(*bytes))?;
        let links: Vec<Link> = self.numbers(n_links, |bytes: &[u8; 16]| {
            let [a, b, low, high] = words(bytes);
            let length = f64::from_bits(u64::from(high) << 32 | u64::from(low));
            Link { ends: [a, b].map(VertexId), length }
        })?;
        if !edges.iter().chain(links.iter().map(|link| &link.length)).all(|length| is_length(*length)) {
            return Err("an edge has no length");
        }
        if !links.iter().all(|link| link.ends.into_iter().all(is_vertex)) {
            return Err("a link is impossible");
        }
        let vertex = |bytes: &[u8; 4]| VertexId(u32::from_le_bytes(*bytes));
        let map: Vec<Option<VertexId>> =
            self.numbers(n_mapped, |bytes| Some(vertex(bytes)).filter(|v| v.0 != DROPPED))?;
        let is_mapped = match n_mapped {
            0 => n_input == n_vertices,
            _ => n_mapped == n_input && map.iter().flatten().copied().all(is_vertex),
        };
        if !is_mapped {
            return Err("vertices of the input are missing");
        }
        let landmarks = self.numbers(n_landmarks, vertex)?;
        if !landmarks.iter().copied().all(is_vertex) {
            return Err("a landmark is missing");
        }
        let [quantum, over, under, factor_quantum] = self.lengths;
        let codes = self.numbers(n_vertices * n_landmarks, |bytes| u16::from_le_bytes(*bytes))?;
        let factor = self.numbers(n_vertices * rank, |bytes| i16::from_le_bytes(*bytes))?;
        let error = ColumnError { over, under };
        let tables =
            Tables { n_landmarks, n_exact, error, quantum, codes, rank, n_positive, factor_quantum, factor };
        let metric = LandmarkMetric::of(tables).ok_or("its tables are impossible")?;
        Ok(DistanceField {
            provenance,
            metric,
            landmarks,
            surface: IntrinsicMesh::new(topology, edges).with_links(links),
            map: VertexMap { n_input, to_repaired: (n_mapped > 0).then_some(map) },
            exact: Mutex::default(),
        })
    }

    /// The next `n` values of `N` bytes each. The length of the file has been checked, so there are that many.
    fn numbers<const N: usize, T>(
        &mut self,
        n: usize,
        value: impl Fn(&[u8; N]) -> T,
    ) -> Result<Vec<T>, &'static str> {
        let (bytes, rest) =
            n.checked_mul(N).and_then(|n| self.rest.split_at_checked(n)).ok_or("it has been cut")?;
        self.rest = rest;
        Ok(bytes.as_chunks::<N>().0.iter().map(value).collect())
    }
}

fn words<const B: usize, const N: usize>(bytes: &[u8; B]) -> [u32; N] {
    let words = bytes.as_chunks::<4>().0;
    std::array::from_fn(|i| u32::from_le_bytes(words[i]))
}
