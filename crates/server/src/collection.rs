//! The index that is served, reopened when its file changes.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use base::files::FileId;
use canonform::Error;
use canonform::index::{Entry, log_path};
use canonform::search::{SearchOptions, ShapeSearch};
use serde::Serialize;
use tokio::sync::watch;

use crate::cost;

/// An open index and the list of its shapes. Requests that began with it finish with it.
pub(crate) struct Collection {
    pub(crate) search: ShapeSearch,
    /// All shapes, by ascending name.
    pub(crate) shapes: Vec<Entry>,
    /// Changes with the content of the index.
    pub(crate) version: String,
    /// The folder of the index, absolute, and the same with links resolved.
    folders: Vec<PathBuf>,
}

impl Collection {
    fn open(path: &Path) -> Result<Self, Error> {
        let search = ShapeSearch::open(path)?;
        let shapes = search.index().entries()?;
        let version = format!("{:016x}", search.index().change);
        let absolute = std::path::absolute(path).ok();
        let folders = [absolute, path.canonicalize().ok()];
        let folders = folders.into_iter().flatten().filter_map(|file| Some(file.parent()?.to_owned()));
        Ok(Self { folders: folders.collect(), search, shapes, version })
    }

    /// A shape by its name.
    pub(crate) fn shape(&self, id: &str) -> Option<&Entry> {
        let place = self.shapes.binary_search_by(|shape| shape.id.as_str().cmp(id)).ok()?;
        self.shapes.get(place)
    }

    /// Vertices of a shape, or zero.
    pub(crate) fn n_vertices(&self, id: &str) -> u64 {
        self.shape(id).map_or(0, |shape| shape.facts.vertices)
    }

    /// What a search with a described query of so many vertices costs.
    pub(crate) fn search_cost(&self, options: &SearchOptions, vertices: u64) -> f64 {
        let all: u64 = self.shapes.iter().map(|shape| shape.facts.vertices).sum();
        let n = self.shapes.len();
        cost::of_search(options, n, all / n.max(1) as u64, vertices)
    }

    /// A path as clients may see it: relative to the folder of the index, or only the name of the file. Clients must
    /// not learn where the index lies on this machine.
    pub(crate) fn public_path(&self, path: &str) -> String {
        let given = Path::new(path);
        if given.is_relative() {
            return path.to_owned();
        }
        let relative = self.folders.iter().find_map(|folder| given.strip_prefix(folder).ok());
        let name = || Path::new(given.file_name().unwrap_or_default());
        relative.unwrap_or_else(name).display().to_string()
    }
}

/// Whether the file of the index is the one that is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum FileState {
    /// It is.
    Current,
    /// There is no file; searches go on in the one that was opened.
    Missing,
    /// The file has changed and cannot be opened; searches go on in the old one.
    Unreadable,
}

/// The index in service.
pub(crate) struct Served {
    path: PathBuf,
    now: watch::Sender<Now>,
}

struct Now {
    collection: Arc<Collection>,
    /// The file that was opened or tried last.
    seen: Option<Identity>,
    state: FileState,
}

/// Differs when an index was replaced or written to: for its file and its log, the device and number where the system has
/// them, the length, and the time of the last change.
type Identity = Vec<Option<(Option<FileId>, u64, Option<SystemTime>)>>;

fn identity(path: &Path) -> Option<Identity> {
    let of_file = |path: &Path| {
        let about = std::fs::metadata(path).ok()?;
        Some((FileId::of(path).ok(), about.len(), about.modified().ok()))
    };
    let file = of_file(path)?;
    Some(vec![Some(file), of_file(&log_path(path)).filter(|(_, length, _)| *length > 0)])
}

impl Served {
    pub(crate) fn open(path: &Path) -> Result<Self, Error> {
        // Taken first: a file that is replaced in between is opened again.
        let seen = identity(path);
        let collection = Arc::new(Collection::open(path)?);
        let now = Now { collection, seen, state: FileState::Current };
        Ok(Self { path: path.to_owned(), now: watch::Sender::new(now) })
    }

    /// The index for a request.
    pub(crate) fn collection(&self) -> Arc<Collection> {
        self.now.borrow().collection.clone()
    }

    pub(crate) fn state(&self) -> FileState {
        self.now.borrow().state
    }

    /// Opens the file if it has changed. An error leaves the old index in service and is printed once.
    pub(crate) fn refresh(&self) {
        let found = identity(&self.path);
        if self.now.borrow().seen == found {
            return;
        }
        let opened = found.as_ref().map(|_| Collection::open(&self.path));
        self.now.send_modify(|now| {
            now.seen = found;
            now.state = match opened {
                None => FileState::Missing,
                Some(Ok(collection)) => {
                    let n = collection.shapes.len();
                    base::write_line(&format!("the index has changed: {n} shapes"));
                    now.collection = Arc::new(collection);
                    FileState::Current
                }
                Some(Err(error)) => {
                    base::write_line(&format!(
                        "the index has changed and cannot be opened; the old one is used: {error}"
                    ));
                    FileState::Unreadable
                }
            };
        });
    }
}
