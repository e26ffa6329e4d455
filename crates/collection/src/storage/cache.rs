//! Archives that are open, so that their directories are read once.

use std::collections::VecDeque;
use std::fs::File;
use std::path::Path;
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};
use std::time::SystemTime;

use base::files::{FileError, FileId};
use mesh::{Fault, MeshError};

use super::archive::Archive;
use super::container::{Container, fault};
use super::{parquet, tar, zip};

/// What tells whether a file is the one that was opened.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Key {
    id: FileId,
    length: u64,
    modified: Option<SystemTime>,
}

/// Filled by the first thread that needs it; the others wait for it, but not for other archives.
type Slot = Arc<OnceLock<Result<Arc<Archive>, Fault>>>;

/// The archives used last, the newest first.
static OPEN: LazyLock<Mutex<VecDeque<(Key, Slot)>>> = LazyLock::new(Mutex::default);

/// Archives that stay open.
const MOST: usize = 16;

/// Opens an archive, or finds it open.
pub(crate) fn open(path: &Path) -> Result<Arc<Archive>, MeshError> {
    let cannot_read = |source| MeshError::Io(FileError::read(path, source));
    let about = std::fs::metadata(path).map_err(cannot_read)?;
    let id = FileId::of(path).map_err(cannot_read)?;
    let key = Key { id, length: about.len(), modified: about.modified().ok() };
    let slot = {
        let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
        let found = open.iter().position(|(known, _)| *known == key).and_then(|place| open.remove(place));
        let entry = found.unwrap_or_else(|| (key, Slot::default()));
        let slot = entry.1.clone();
        open.push_front(entry);
        open.truncate(MOST);
        slot
    };
    let archive = match slot.get() {
        Some(known) => known,
        None => {
            // Outside of the slot, since the error of the system may go away.
            let file = File::open(path).map_err(cannot_read)?;
            let container = Container::by_name(path).unwrap_or(Container::Zip);
            slot.get_or_init(|| members(path, file, container, u64::MAX).map(Arc::new))
        }
    };
    archive.clone().map_err(|what| fault(path, what))
}

/// Reads the names of all members. Compression of the whole hides at most so many bytes.
pub(super) fn members(path: &Path, file: File, container: Container, most: u64) -> Result<Archive, Fault> {
    match container {
        Container::Zip => zip::open(file),
        Container::Tar => tar::open(path, file, most),
        _ => parquet::open(file),
    }
}
