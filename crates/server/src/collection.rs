//! The index that is served, reopened when its file changes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::SystemTime;

use base::files::FileId;
use canonform::index::{Entry, Facts, log_path};
use canonform::search::{SearchOptions, ShapeSearch};
use canonform::{ContentHash, Error};
use serde::Serialize;

use crate::cost;

/// An open index and the list of its shapes. Requests that began with it finish with it.
pub(crate) struct Collection {
    pub(crate) search: ShapeSearch,
    /// All shapes, by ascending name.
    pub(crate) shapes: Vec<ShapeSummary>,
    /// Places in `shapes`, by class.
    classes: Vec<Vec<usize>>,
    /// Changes with the content of the index.
    pub(crate) version: String,
    /// The folder of the index, absolute, and the same with links resolved.
    folders: Vec<PathBuf>,
}

/// A shape in a list.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ShapeSummary {
    pub(crate) id: String,
    pub(crate) label: String,
    pub(crate) vertices: u64,
    faces: u64,
    /// In squared mesh units.
    area: f64,
    /// The largest surface distance from a sample, in mesh units.
    diameter: f64,
    #[serde(skip)]
    pub(crate) content: ContentHash,
}

impl Collection {
    fn open(path: &Path) -> Result<Self, Error> {
        let search = ShapeSearch::open(path)?;
        let shapes =
            search.index().entries()?.into_iter().map(|Entry { id, label, content, facts, .. }| {
                let Facts { vertices, faces, area, diameter, .. } = facts;
                ShapeSummary { id, label, vertices, faces, area, diameter, content }
            });
        let shapes: Vec<ShapeSummary> = shapes.collect();
        let mut classes: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (place, shape) in shapes.iter().enumerate() {
            classes.entry(&shape.label).or_default().push(place);
        }
        let classes = classes.into_values().collect();
        let version = format!("{:016x}", search.index().change);
        let absolute = std::path::absolute(path).ok();
        let folders = [absolute, path.canonicalize().ok()];
        let folders = folders.into_iter().flatten().filter_map(|file| Some(file.parent()?.to_owned()));
        Ok(Self { folders: folders.collect(), search, shapes, classes, version })
    }

    /// A shape by its name.
    pub(crate) fn shape(&self, id: &str) -> Option<&ShapeSummary> {
        let place = self.shapes.binary_search_by(|shape| shape.id.as_str().cmp(id)).ok()?;
        self.shapes.get(place)
    }

    /// Vertices of a shape, or zero.
    pub(crate) fn n_vertices(&self, id: &str) -> u64 {
        self.shape(id).map_or(0, |shape| shape.vertices)
    }

    /// What a search with a described query of so many vertices costs.
    pub(crate) fn search_cost(&self, options: &SearchOptions, vertices: u64) -> f64 {
        let all: u64 = self.shapes.iter().map(|shape| shape.vertices).sum();
        let n = self.shapes.len();
        cost::of_search(options, n, all / n.max(1) as u64, vertices)
    }

    /// Up to `n` shapes of as many classes as possible.
    pub(crate) fn sample(&self, n: usize) -> Vec<&ShapeSummary> {
        let n_classes = self.classes.len();
        let places: Vec<usize> = if n_classes > n {
            (0..n).map(|i| self.classes[i * n_classes / n][0]).collect()
        } else {
            let longest = self.classes.iter().map(Vec::len).max().unwrap_or(0);
            let rounds = (0..longest).flat_map(|i| self.classes.iter().filter_map(move |class| class.get(i)));
            let mut places: Vec<usize> = rounds.take(n).copied().collect();
            places.sort_unstable();
            places
        };
        places.into_iter().map(|place| &self.shapes[place]).collect()
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
    now: RwLock<Now>,
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
        Ok(Self { path: path.to_owned(), now: RwLock::new(now) })
    }

    /// The index for a request.
    pub(crate) fn collection(&self) -> Arc<Collection> {
        self.read(|now| now.collection.clone())
    }

    pub(crate) fn state(&self) -> FileState {
        self.read(|now| now.state)
    }

    /// Opens the file if it has changed. An error leaves the old index in service and is printed once.
    pub(crate) fn refresh(&self) {
        let found = identity(&self.path);
        if self.read(|now| now.seen == found) {
            return;
        }
        let opened = found.as_ref().map(|_| Collection::open(&self.path));
        let mut now = self.now.write().unwrap_or_else(PoisonError::into_inner);
        now.seen = found;
        now.state = match opened {
            None => FileState::Missing,
            Some(Ok(collection)) => {
                let collection = Arc::new(collection);
                base::write_line(&format!("the index has changed: {} shapes", collection.shapes.len()));
                now.collection = collection;
                FileState::Current
            }
            Some(Err(error)) => {
                base::write_line(&format!(
                    "the index has changed and cannot be opened; the old one is used: {error}"
                ));
                FileState::Unreadable
            }
        };
    }

    /// A poisoned lock is harmless: the state changes as a whole.
    fn read<T>(&self, get: impl FnOnce(&Now) -> T) -> T {
        get(&self.now.read().unwrap_or_else(PoisonError::into_inner))
    }
}
