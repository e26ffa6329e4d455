//! What counts as a duplicate, and what is kept.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use relations::{Relation, RelationKind};

/// The kinds that make two files duplicates.
const KINDS: [RelationKind; 6] = [
    RelationKind::IdenticalFile,
    RelationKind::IdenticalGeometry,
    RelationKind::Scaled,
    RelationKind::Mirrored,
    RelationKind::Noisy,
    RelationKind::Remeshed,
];

/// Which file of a group is suggested to be kept. Between equal ones, references come first, then files before links and
/// members of archives, formats that lose nothing, the folders in the order of [`folders`](DuplicateOptions::folders), the oldest, the
/// shortest path.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Keep {
    /// The most [exact](Relation::more_exact): without noise, with all detail, in the fewest vertices.
    #[default]
    Exact,
    /// That with the most vertices, then bytes.
    Largest,
    /// That with the fewest.
    Smallest,
    /// The one that was changed first.
    Oldest,
    /// The one that was changed last.
    Newest,
    /// One in this folder, then the most exact.
    In(PathBuf),
}

impl FromStr for Keep {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Ok(match text {
            "exact" => Self::Exact,
            "largest" => Self::Largest,
            "smallest" => Self::Smallest,
            "oldest" => Self::Oldest,
            "newest" => Self::Newest,
            folder if Path::new(folder).is_dir() => Self::In(folder.into()),
            _ => return Err("use `exact`, `largest`, `smallest`, `oldest`, `newest`, or a folder".to_owned()),
        })
    }
}

/// What counts as a duplicate, and what is kept.
#[derive(Debug, Clone, PartialEq)]
pub struct DuplicateOptions {
    /// Kinds of relation. Default: one file, one geometry, scaled, mirrored, noisy, remeshed.
    pub kinds: Vec<RelationKind>,
    /// The least confidence. Default: 0.9.
    pub min_confidence: f64,
    /// Which file of a group is kept. Default: the most exact.
    pub keep: Keep,
    /// Folders and archives from which nothing is to be removed. Default: none.
    pub reference: Vec<PathBuf>,
    /// Folders and archives in the order in which their files are kept. Default: none goes first.
    pub folders: Vec<PathBuf>,
}

impl Default for DuplicateOptions {
    fn default() -> Self {
        let (keep, reference, folders) = Default::default();
        Self { kinds: KINDS.to_vec(), min_confidence: 0.9, keep, reference, folders }
    }
}

impl DuplicateOptions {
    /// Whether a relation makes two files duplicates.
    pub(super) fn accept(&self, told: &Relation) -> bool {
        self.kinds.contains(&told.kind) && told.confidence >= self.min_confidence
    }

    /// Whether parts and variants do not count.
    pub(super) fn asks_surfaces_only(&self) -> bool {
        self.kinds.iter().all(|kind| kind.is_one_surface())
    }
}
