//! What all archives have in common: members by name.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::path::{Component, Path};

use base::files::{FileError, nameless_in};
use mesh::{Fault, MeshError};
use mesh_io::{inflated_limit, is_mesh_path};

use super::container::fault;
use super::window::Window;
use crate::dataset::{SkipKind, is_apple_double};
use crate::error::CollectionError;

/// A file in an archive.
#[derive(Debug, Clone, Default)]
pub(crate) struct Member {
    /// Bytes after decompression.
    pub(crate) size: u64,
    /// Its class; empty if the archive states none.
    pub(crate) label: String,
    /// Where it is: the number of a zip entry, or the first byte.
    pub(super) at: u64,
}

/// Most members that an error lists.
const MOST_NAMED: usize = 3;

/// An opened archive.
pub(crate) struct Archive {
    members: BTreeMap<String, Member>,
    /// Names of what is no member, with the reason.
    pub(crate) skipped: Vec<(String, SkipKind)>,
    data: Data,
}

/// Gives the content of a member, at most so many bytes.
type ReadMember = dyn Fn(&Member, u64) -> Result<Vec<u8>, Fault> + Send + Sync;

/// Where the bytes of members are.
pub(super) enum Data {
    /// Decompressed one by one.
    Entries(Box<ReadMember>),
    /// As they are, one after the other.
    Plain(Window),
}

impl Archive {
    pub(super) fn of(data: Data) -> Self {
        Self { members: BTreeMap::new(), skipped: Vec::new(), data }
    }

    /// Adds a member. A later one of the same name takes its place, as when an archive is unpacked.
    pub(super) fn add(&mut self, name: &str, member: Member) {
        match safe_name(name) {
            Some(name) if is_apple_double(Path::new(&name)) => self.skip(&name, SkipKind::AppleDouble),
            Some(name) => {
                if self.members.insert(name.clone(), member).is_some() {
                    self.skip(&name, SkipKind::Repeated);
                }
            }
            None => self.skip(name, SkipKind::UnsafeName),
        }
    }

    pub(super) fn skip(&mut self, name: &str, kind: SkipKind) {
        self.skipped.push((name.to_owned(), kind));
    }

    /// The member of this name, also if it is spelled as `./name`.
    pub(crate) fn member(&self, name: &str) -> Option<&Member> {
        self.members.get(name).or_else(|| self.members.get(&safe_name(name)?))
    }

    /// The name of the only mesh; `path` is that of the archive.
    pub(super) fn only_mesh(&self, path: &Path) -> Result<&str, CollectionError> {
        let meshes: Vec<&str> =
            self.members.keys().map(String::as_str).filter(|name| is_mesh_path(Path::new(name))).collect();
        match meshes[..] {
            [mesh] => Ok(mesh),
            _ => Err(CollectionError::NotOneMesh {
                path: path.to_owned(),
                n_meshes: meshes.len(),
                first: meshes.iter().take(MOST_NAMED).map(|name| (*name).to_owned()).collect(),
            }),
        }
    }

    /// All members in the order of their names.
    pub(crate) fn members(&self) -> impl Iterator<Item = (&str, &Member)> {
        self.members.iter().map(|(name, member)| (name.as_str(), member))
    }

    /// The content of a member; `path` names it in messages.
    pub(crate) fn read(&self, name: &str, path: &Path) -> Result<Vec<u8>, MeshError> {
        self.read_at_most(name, path, u64::MAX)
    }

    /// As [`read`](Self::read), or an error if the member has more bytes.
    pub(super) fn read_at_most(&self, name: &str, path: &Path, most: u64) -> Result<Vec<u8>, MeshError> {
        let cannot_read = |source| MeshError::Io(FileError::read(path, source));
        let missing = || io::Error::new(io::ErrorKind::NotFound, "the archive has no such member");
        let member = self.member(name).ok_or_else(|| cannot_read(missing()))?;
        let window = match &self.data {
            Data::Entries(read) => return read(member, most).map_err(|what| fault(path, what)),
            Data::Plain(window) => window,
        };
        let mut bytes = Vec::new();
        window.part(member.at, member.size).read_to_end(&mut bytes).map_err(cannot_read)?;
        match bytes.len() as u64 {
            found if found < member.size => Err(fault(path, Fault::truncated("bytes", member.size, found))),
            _ => Ok(bytes),
        }
    }
}

/// A name separated by `/` that stays inside the archive; `None` if it would lead out of it.
fn safe_name(name: &str) -> Option<String> {
    let slashed = name.replace('\\', "/");
    let mut parts = Vec::new();
    for part in Path::new(&slashed).components() {
        match part {
            Component::Normal(part) => parts.push(part.to_str()?),
            Component::CurDir => {}
            _ => return None,
        }
    }
    let is_strange = |c: char| c.is_control() || c == ':';
    (!parts.is_empty() && !parts.iter().any(|part| part.contains(is_strange))).then(|| parts.join("/"))
}

/// Where what was decompressed is kept: the system removes the file when it is closed.
pub(super) struct Spool {
    file: File,
    n_bytes: u64,
    limit: u64,
}

impl Spool {
    /// `size` is that of the compressed file; no more than `most` bytes are kept.
    pub(super) fn new(size: u64, most: u64) -> Result<Self, Fault> {
        let file = nameless_in(&std::env::temp_dir()).map_err(|error| cannot_keep(&error.source))?;
        Ok(Self { file, n_bytes: 0, limit: inflated_limit(size).min(most) })
    }

    /// Appends bytes and returns where they begin.
    pub(super) fn append(&mut self, bytes: &[u8]) -> Result<u64, Fault> {
        let start = self.n_bytes;
        self.n_bytes += bytes.len() as u64;
        if self.n_bytes > self.limit {
            return Err(Fault::decompression_bomb(self.limit));
        }
        self.file.write_all(bytes).map_err(|error| cannot_keep(&error))?;
        Ok(start)
    }

    /// Everything that was appended.
    pub(super) fn finish(mut self) -> Result<Window, Fault> {
        self.file.rewind().and_then(|()| Window::whole(self.file)).map_err(|error| cannot_keep(&error))
    }
}

fn cannot_keep(error: &io::Error) -> Fault {
    Fault::unsupported(
        format!("its decompressed data cannot be kept in a temporary file: {error}"),
        "free space, set TMPDIR to another folder, or unpack the archive",
    )
}
