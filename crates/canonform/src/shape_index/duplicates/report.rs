//! Groups of duplicates as they are told.

use std::path::PathBuf;

use relations::{Change, Relation};
use serde::Serialize;

/// A file of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DuplicateFile {
    /// The shape.
    pub id: String,
    /// Its file.
    pub path: PathBuf,
    /// Size of the file in bytes, also of a member of an archive, which need less.
    pub bytes: Option<u64>,
    /// When it was last changed, in seconds since 1970.
    pub modified: Option<u64>,
    /// Lengths of the bounding box, in units of the file; unknown for a file that cannot be read.
    pub size: Option<[f64; 3]>,
    /// Number of vertices in different positions.
    pub vertices: Option<usize>,
    /// Other shapes of the index that are this file: links and hard links.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<String>,
    /// Whether it is in a folder from which nothing is to be removed.
    pub reference: bool,
    /// Whether nothing is spared without it: it is found through a link, has several names (hard links), or is in an archive.
    #[serde(skip)]
    pub is_linked: bool,
}

/// A file that is the shape of the keeper of its group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DuplicateMember {
    /// The file.
    #[serde(flatten)]
    pub file: DuplicateFile,
    /// The file that it is compared with: the keeper, or a member that it is an exact copy of.
    pub of: String,
    /// How it is related to that file.
    pub relation: Relation,
}

impl DuplicateMember {
    /// Whether it can be spared: it is the surface of a file that is kept, is no reference, and its bytes would be free. Parts of other
    /// sizes, unless the unit changed, and left and right ones are not spared.
    pub fn is_spare(&self) -> bool {
        let told = &self.relation;
        let is_other =
            told.has(Change::Mirrored) || told.has(Change::Scaled) && told.evidence.units.is_none();
        told.kind.is_one_surface() && !(is_other || self.file.reference || self.file.is_linked)
    }
}

/// Files of one shape.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DuplicateGroup {
    /// The file that is suggested to be kept.
    pub keeper: DuplicateFile,
    /// Why it is suggested.
    pub why: String,
    /// The others, by what they have in common with it.
    pub members: Vec<DuplicateMember>,
}

/// The duplicates of an index.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DuplicateReport {
    /// Shapes of the index.
    pub n_shapes: usize,
    /// Pairs of meshes that were compared.
    pub n_compared: usize,
    /// Groups, those with the most files first.
    pub groups: Vec<DuplicateGroup>,
    /// Shapes whose file is gone or has changed since it was indexed; only equal contents are known of them.
    pub unread: Vec<String>,
    /// Wall-clock seconds.
    pub seconds: f64,
}

impl DuplicateReport {
    /// Every file of every group.
    pub fn files_mut(&mut self) -> impl Iterator<Item = &mut DuplicateFile> {
        self.groups.iter_mut().flat_map(|DuplicateGroup { keeper, members, .. }| {
            members.iter_mut().map(|member| &mut member.file).chain([keeper])
        })
    }

    /// The files that [can be spared](DuplicateMember::is_spare).
    pub fn spare(&self) -> impl Iterator<Item = &DuplicateFile> {
        let members = self.groups.iter().flat_map(|group| &group.members);
        members.filter(|member| member.is_spare()).map(|member| &member.file)
    }

    /// Bytes of all files that can be spared.
    pub fn spare_bytes(&self) -> u64 {
        self.spare().filter_map(|file| file.bytes).sum()
    }
}
