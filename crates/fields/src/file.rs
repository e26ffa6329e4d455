//! Fields as files.
//!
//! | part | content |
//! |---|---|
//! | start | `canonfld`, the format (`u32`), the length of the head (`u32`) |
//! | head | how the field was made, and the size and the unit of every part, as JSON |
//! | surface | faces (3 x `u32`), edge lengths (`f64`), links (2 x `u32`, `f64`) |
//! | map | the repaired vertex of each input vertex (`u32`, the largest for none); left out if none changed |
//! | landmarks | repaired vertices (`u32`) |
//! | columns | distances in quanta (`u16`), one row per vertex |
//! | factors | entries in quanta (`i16`), one row per vertex |
//! | end | CRC-32 of everything before (`u32`) |
//!
//! All numbers are little-endian. A reader checks the checksum, then that the sizes make up the length, before it reserves
//! memory, and then every number that others refer to.

use std::path::Path;
use std::sync::Mutex;

use base::files::FileError;
use mesh::Remap;
use serde::{Deserialize, Serialize};
use surface::{IntrinsicMesh, Link, Topology, VertexId};

use crate::distance_field::{DistanceField, Provenance};
use crate::error::FieldError;
use crate::fault::FieldFault;
use crate::metric::{ColumnError, LandmarkMetric, Tables};

const MAGIC: &[u8; 8] = b"canonfld";

/// The format that this version reads and writes.
const VERSION: u32 = 2;

/// Bytes before the head.
const START: usize = MAGIC.len() + 8;

/// Bytes of the checksum.
const SUM: usize = 4;

/// The fault of a file that ends too early.
const CUT: &str = "it has been cut";

/// Stands for a dropped vertex.
const DROPPED: u32 = u32::MAX;

/// What the rest of the file is made of.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    provenance: Provenance,
    /// Vertices of the input.
    n_input: usize,
    /// Vertices of the repaired mesh.
    n_vertices: usize,
    n_faces: usize,
    n_edges: usize,
    n_links: usize,
    is_mapped: bool,
    n_landmarks: usize,
    n_exact: usize,
    error: ColumnError,
    quantum: f64,
    rank: usize,
    n_positive: usize,
    factor_quantum: f64,
}

impl Head {
    fn of(field: &DistanceField) -> Self {
        let (tables, topology) = (field.metric.tables(), field.surface.topology());
        Self {
            provenance: field.provenance,
            n_input: field.remap.n_old(),
            n_vertices: topology.n_vertices(),
            n_faces: topology.n_faces(),
            n_edges: topology.n_edges(),
            n_links: field.surface.links().len(),
            is_mapped: !field.remap.is_identity(),
            n_landmarks: tables.n_landmarks,
            n_exact: tables.n_exact,
            error: tables.error,
            quantum: tables.quantum,
            rank: tables.rank,
            n_positive: tables.n_positive,
            factor_quantum: tables.factor_quantum,
        }
    }

    fn text(&self) -> Vec<u8> {
        serde_json::to_vec(self).unwrap_or_else(|fault| unreachable!("plain data: {fault}"))
    }

    /// The bytes of all parts behind the head; `None` if they cannot be counted.
    fn n_bytes(&self) -> Option<usize> {
        let n_mapped = if self.is_mapped { self.n_input } else { 0 };
        let table = self.n_landmarks.checked_add(self.rank)?.checked_mul(2)?;
        let parts = [
            (self.n_faces, 12),
            (self.n_edges, 8),
            (self.n_links, 16),
            (n_mapped, 4),
            (self.n_landmarks, 4),
            (self.n_vertices, table),
        ];
        parts.into_iter().try_fold(SUM, |sum, (n, bytes)| sum.checked_add(n.checked_mul(bytes)?))
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
        let head = Head::of(self);
        START + head.text().len() + head.n_bytes().unwrap_or(usize::MAX)
    }

    /// The content of its file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let text = Head::of(self).text();
        let tables = self.metric.tables();
        let mut out = Vec::with_capacity(self.n_bytes());
        out.extend_from_slice(MAGIC);
        out.extend([VERSION, text.len() as u32].into_iter().flat_map(u32::to_le_bytes));
        out.extend_from_slice(&text);
        let vertex = |v: VertexId| v.0.to_le_bytes();
        out.extend(self.surface.topology().faces().iter().flatten().copied().flat_map(vertex));
        out.extend(self.surface.edge_lengths().iter().flat_map(|length| length.to_le_bytes()));
        for link in self.surface.links() {
            out.extend(link.ends.into_iter().flat_map(vertex));
            out.extend(link.length.to_le_bytes());
        }
        if !self.remap.is_identity() {
            out.extend(self.remap.all_to_new().flat_map(|to| vertex(to.unwrap_or(VertexId(DROPPED)))));
        }
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
        let mut rest = Rest(bytes.strip_prefix(MAGIC).ok_or(NotAField)?);
        let number = |bytes: &[u8; 4]| u32::from_le_bytes(*bytes);
        let found = rest.numbers(1, number).map_err(Damaged)?[0];
        if found != VERSION {
            return Err(OtherVersion { found, known: VERSION });
        }
        let (content, sum) = bytes.split_last_chunk::<SUM>().ok_or(Damaged(CUT))?;
        if crc32fast::hash(content) != number(sum) {
            return Err(Damaged("its checksum is wrong"));
        }
        let length = rest.numbers(1, number).map_err(Damaged)?[0] as usize;
        let text = rest.numbers(length, |[byte]: &[u8; 1]| *byte).map_err(Damaged)?;
        let head: Head = serde_json::from_slice(&text).map_err(|_| Damaged("its head is unknown"))?;
        if head.n_bytes() != Some(rest.0.len()) {
            return Err(Damaged("its length is wrong"));
        }
        field(head, rest).map_err(Damaged)
    }
}

/// What has not been read yet.
struct Rest<'a>(&'a [u8]);

impl Rest<'_> {
    /// The next `n` values of `N` bytes each.
    fn numbers<const N: usize, T>(
        &mut self,
        n: usize,
        value: impl Fn(&[u8; N]) -> T,
    ) -> Result<Vec<T>, &'static str> {
        let (bytes, rest) = n.checked_mul(N).and_then(|n| self.0.split_at_checked(n)).ok_or(CUT)?;
        self.0 = rest;
        Ok(bytes.as_chunks::<N>().0.iter().map(value).collect())
    }
}

/// The field, or what is wrong with it.
fn field(head: Head, mut rest: Rest<'_>) -> Result<DistanceField, &'static str> {
    let Head { provenance, n_input, n_vertices, n_faces, n_edges, n_landmarks, rank, .. } = head;
    // Tables with columns make the length of the file a bound of the number of vertices.
    if n_landmarks == 0 || rank == 0 {
        return Err("it has no tables");
    }
    let is_vertex = |v: VertexId| v.index() < n_vertices;
    let is_length = |length: f64| length.is_finite() && length >= 0.0;
    let faces: Vec<[VertexId; 3]> =
        rest.numbers(n_faces, |bytes: &[u8; 12]| words::<12, 3>(bytes).map(VertexId))?;
    if faces.iter().any(|&[a, b, c]| a == b || b == c || c == a || ![a, b, c].into_iter().all(is_vertex)) {
        return Err("a face is impossible");
    }
    if n_vertices > Topology::MAX_VERTICES || n_faces > Topology::MAX_FACES {
        return Err("it has more vertices or faces than a mesh may have");
    }
    let topology = Topology::new(n_vertices, faces);
    if topology.n_edges() != n_edges {
        return Err("it has another number of edges");
    }
    let edges = rest.numbers(n_edges, |bytes| f64::from_le_bytes(*bytes))?;
    let links: Vec<Link> = rest.numbers(head.n_links, |bytes: &[u8; 16]| {
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
    let remap = match head.is_mapped {
        true => rest.numbers(n_input, |bytes| Some(vertex(bytes)).filter(|v| v.0 != DROPPED))?,
        false => (0..n_vertices).map(|v| Some(VertexId::from(v))).collect(),
    };
    let mut is_reached = vec![false; n_vertices];
    for vertex in remap.iter().flatten() {
        *is_reached.get_mut(vertex.index()).ok_or("a vertex of the input is elsewhere")? = true;
    }
    if remap.len() != n_input || is_reached.contains(&false) {
        return Err("vertices of the input are missing");
    }
    let landmarks = rest.numbers(n_landmarks, vertex)?;
    if !landmarks.iter().copied().all(is_vertex) {
        return Err("a landmark is missing");
    }
    let tables = Tables {
        n_landmarks,
        n_exact: head.n_exact,
        error: head.error,
        quantum: head.quantum,
        codes: rest.numbers(n_vertices * n_landmarks, |bytes| u16::from_le_bytes(*bytes))?,
        rank,
        n_positive: head.n_positive,
        factor_quantum: head.factor_quantum,
        factor: rest.numbers(n_vertices * rank, |bytes| i16::from_le_bytes(*bytes))?,
    };
    Ok(DistanceField {
        provenance,
        metric: LandmarkMetric::of(tables).ok_or("its tables are impossible")?,
        landmarks,
        surface: IntrinsicMesh::new(topology, edges).with_links(links),
        remap: Remap::new(remap, n_vertices),
        exact: Mutex::default(),
    })
}

fn words<const B: usize, const N: usize>(bytes: &[u8; B]) -> [u32; N] {
    let words = bytes.as_chunks::<4>().0;
    std::array::from_fn(|i| u32::from_le_bytes(words[i]))
}
