//! What the fuzz targets share: how bytes become meshes and options, and what must hold.
//!
//! An input for a mesh target begins with bytes of options: the format of the file, and for `repair_embed` also how it is
//! repaired and embedded. The rest is the file. A `.vert`/`.tri` pair is separated by the first zero byte.

use std::path::Path;
use std::time::Duration;

use base::Budget;
use canonform::Observer;
use mesh::TriMesh;
use mesh_io::{FORMATS, MemoryFile, ReadLimits, read_memory};

/// Limits the time of one input and cancels nothing else.
#[derive(Debug)]
pub struct Limited(Budget);

impl Limited {
    /// A budget that starts now. The time limit is far below that of libFuzzer: work that ignores its budget is a finding.
    #[must_use]
    pub fn start() -> Self {
        Self(Budget::unlimited().with_time(Duration::from_secs(5)).with_memory(512 << 20))
    }
}

impl Observer for Limited {
    fn budget(&self) -> Budget {
        self.0.clone()
    }

    fn begin(&self, _: &str, _: usize) {}

    fn step(&self) {}
}

/// Uses one thread, so that the coverage of an input is the same in every run.
pub fn single_threaded() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the pool is not built yet");
}

/// Splits off the leading byte; zero if there is none.
#[must_use]
pub fn first_byte(data: &[u8]) -> (usize, &[u8]) {
    data.split_first().map_or((0, data), |(byte, rest)| (usize::from(*byte), rest))
}

/// Reads a mesh of at most `max_vertices` vertices: the first byte is the format, the rest the file.
///
/// # Panics
/// If the reader breaks its promises.
#[must_use]
pub fn mesh_of(data: &[u8], max_vertices: u64) -> Option<TriMesh> {
    let (format, content) = first_byte(data);
    let format = &FORMATS[format % FORMATS.len()];
    let contents: Vec<&[u8]> = content.splitn(format.extensions.len(), |byte| *byte == 0).collect();
    let names: Vec<String> = format.extensions.iter().map(|extension| format!("fuzz.{extension}")).collect();
    let files: Vec<MemoryFile> = names
        .iter()
        .zip(contents)
        .map(|(name, bytes)| MemoryFile { name: Path::new(name), bytes })
        .collect();
    let limits = ReadLimits::of_vertices(max_vertices);
    let mesh = read_memory(&files, &limits).ok()?;
    assert!(mesh.n_faces() > 0 && mesh.n_faces() as u64 <= limits.max_faces);
    assert!(mesh.n_vertices() as u64 <= limits.max_vertices);
    assert!(mesh.faces.iter().flatten().all(|v| v.index() < mesh.n_vertices()));
    assert!(mesh.positions.iter().all(|p| p.iter().all(|x| x.is_finite())));
    Some(mesh)
}
