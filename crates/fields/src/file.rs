//! Fields as files.
//!
//! | part | content |
//! |---|---|
//! | start | `canonfld`, the format (`u32`), the length of the head (`u32`) |
//! | head | all that is small, as JSON: how the field was made, sizes and units, links, the map of vertices, landmarks |
//! | surface | faces (3 x `u32`), edge lengths (`f64`) |
//! | columns | distances in quanta (`u16`), one row per vertex |
//! | factors | entries in quanta (`i16`), one row per vertex |
//! | end | CRC-32 of everything before (`u32`) |
//!
//! All numbers are little-endian. A reader checks the checksum, reserves no more memory than the length of the file justifies, and
//! checks every number that others refer to.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Mutex;

use base::files::FileError;
use mesh::Remap;
use serde::{Deserialize, Serialize};
use surface::{IntrinsicMesh, Link, Topology, VertexId};

use crate::distance_field::{DistanceField, Provenance};
use crate::error::{FieldError, FieldFault};
use crate::metric::{LandmarkMetric, Tables};

const MAGIC: &[u8; 8] = b"canonfld";
/// The format that this version reads and writes.
const VERSION: u32 = 3;
/// Bytes before the head.
const START: usize = MAGIC.len() + 8;
/// Bytes of the checksum.
const SUM: usize = 4;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head<'a> {
    provenance: Provenance,
    /// Vertices of the repaired mesh.
    n_vertices: usize,
    n_faces: usize,
    links: Cow<'a, [Link]>,
    /// The repaired vertex of each input vertex; `None` if none changed.
    remap: Option<Vec<Option<VertexId>>>,
    landmarks: Cow<'a, [VertexId]>,
    /// Without the numbers of every vertex.
    tables: Cow<'a, Tables>,
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

    fn head(&self) -> Vec<u8> {
        let head = Head {
            provenance: self.provenance,
            n_vertices: self.surface.n_vertices(),
            n_faces: self.surface.topology().n_faces(),
            links: self.surface.links().into(),
            remap: (!self.remap.is_identity()).then(|| self.remap.all_to_new().collect()),
            landmarks: self.landmarks.as_slice().into(),
            tables: Cow::Borrowed(self.metric.tables()),
        };
        serde_json::to_vec(&head).unwrap_or_else(|fault| unreachable!("plain data: {fault}"))
    }

    /// The size of its file, in bytes.
    pub(crate) fn n_bytes(&self) -> usize {
        let (tables, topology) = (self.metric.tables(), self.surface.topology());
        let surface = 12 * topology.n_faces() + 8 * topology.n_edges();
        START + self.head().len() + surface + 2 * (tables.codes.len() + tables.factor.len()) + SUM
    }

    /// The content of its file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let (head, tables) = (self.head(), self.metric.tables());
        let mut out = Vec::with_capacity(self.n_bytes());
        out.extend_from_slice(MAGIC);
        out.extend([VERSION, head.len() as u32].into_iter().flat_map(u32::to_le_bytes));
        out.extend_from_slice(&head);
        out.extend(self.surface.topology().faces().iter().flatten().flat_map(|v| v.0.to_le_bytes()));
        out.extend(self.surface.edge_lengths().iter().flat_map(|length| length.to_le_bytes()));
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
        let found = rest.numbers(1, u32::from_le_bytes).map_err(Damaged)?[0];
        if found != VERSION {
            return Err(OtherVersion { found, known: VERSION });
        }
        let (content, sum) = bytes.split_last_chunk::<SUM>().ok_or(Damaged(CUT))?;
        match crc32fast::hash(content) == u32::from_le_bytes(*sum) {
            true => field(rest).map_err(Damaged),
            false => Err(Damaged("its checksum is wrong")),
        }
    }
}

/// The fault of a file that ends too early.
const CUT: &str = "it has been cut";

/// What has not been read yet.
struct Rest<'a>(&'a [u8]);

impl<'a> Rest<'a> {
    fn take(&mut self, length: usize) -> Result<&'a [u8], &'static str> {
        let (taken, rest) = self.0.split_at_checked(length).ok_or(CUT)?;
        self.0 = rest;
        Ok(taken)
    }

    /// The next `n` numbers of `N` bytes each.
    fn numbers<const N: usize, T>(
        &mut self,
        n: usize,
        number: fn([u8; N]) -> T,
    ) -> Result<Vec<T>, &'static str> {
        let bytes = self.take(n.checked_mul(N).ok_or(CUT)?)?;
        Ok(bytes.as_chunks::<N>().0.iter().map(|bytes| number(*bytes)).collect())
    }
}

/// The field behind the format, or what is wrong with it.
fn field(mut rest: Rest<'_>) -> Result<DistanceField, &'static str> {
    let length = rest.numbers(1, u32::from_le_bytes)?[0] as usize;
    let head = serde_json::from_slice(rest.take(length)?).map_err(|_| "its head is unknown")?;
    let Head { provenance, n_vertices, n_faces, links, remap, landmarks, tables } = head;
    let (links, landmarks, mut tables) = (links.into_owned(), landmarks.into_owned(), tables.into_owned());
    // Rows of the tables make the length of the file a bound of the number of vertices.
    let in_row = tables.n_landmarks.saturating_add(tables.rank);
    if tables.n_landmarks != landmarks.len()
        || n_vertices.saturating_mul(in_row) > rest.0.len()
        || in_row == 0
    {
        return Err("its tables have another size");
    }
    let is_vertex = |v: &VertexId| v.index() < n_vertices;
    let is_length = |length: &f64| length.is_finite() && *length >= 0.0;
    let corners = rest.numbers(n_faces.checked_mul(3).ok_or(CUT)?, u32::from_le_bytes)?;
    let faces: Vec<[VertexId; 3]> = corners.as_chunks().0.iter().map(|face| face.map(VertexId)).collect();
    if faces.iter().any(|face| face[0] == face[1] || face[1] == face[2] || face[2] == face[0])
        || !faces.as_flattened().iter().chain(links.iter().flat_map(|link| &link.ends)).all(is_vertex)
        || !landmarks.iter().all(is_vertex)
    {
        return Err("a face, link or landmark is impossible");
    }
    if n_vertices > Topology::MAX_VERTICES || n_faces > Topology::MAX_FACES {
        return Err("it has more vertices or faces than a mesh may have");
    }
    let topology = Topology::new(n_vertices, faces);
    let edges = rest.numbers(topology.n_edges(), f64::from_le_bytes)?;
    if !edges.iter().chain(links.iter().map(|link| &link.length)).all(is_length) {
        return Err("an edge has no length");
    }
    let remap = remap.unwrap_or_else(|| (0..n_vertices).map(|v| Some(VertexId::from(v))).collect());
    let mut is_reached = vec![false; n_vertices];
    for vertex in remap.iter().flatten() {
        *is_reached.get_mut(vertex.index()).ok_or("a vertex of the input is elsewhere")? = true;
    }
    if is_reached.contains(&false) {
        return Err("vertices of the input are missing");
    }
    tables.codes = rest.numbers(n_vertices * tables.n_landmarks, u16::from_le_bytes)?;
    tables.factor = rest.numbers(n_vertices * tables.rank, i16::from_le_bytes)?;
    if rest.0.len() != SUM {
        return Err("its length is wrong");
    }
    Ok(DistanceField {
        provenance,
        metric: LandmarkMetric::of(tables).ok_or("its tables are impossible")?,
        landmarks,
        surface: IntrinsicMesh::new(topology, edges).with_links(links),
        remap: Remap::new(remap, n_vertices),
        exact: Mutex::default(),
    })
}
