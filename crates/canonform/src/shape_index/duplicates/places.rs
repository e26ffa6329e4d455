//! Where files are, and which of them is rather kept.

use std::path::{Path, PathBuf};

use collection::Storage;
use index::Entry;
use relations::MeshGeometry;

use super::options::{DuplicateOptions, Keep};
use super::report::DuplicateFile;
use crate::error::Error;
use crate::shape_index::place::{Home, absolute, canonical, mesh_path};
use crate::shape_index::search::ShapeSearch;

/// Whether a path is a file that is no link of either kind.
pub(in crate::shape_index) fn has_one_name(path: &Path) -> bool {
    std::fs::symlink_metadata(path).is_ok_and(|about| about.is_file())
        && std::fs::File::open(path).is_ok_and(|file| !base::files::has_other_names(&file))
}

/// Where files are, and what that says about keeping them.
pub(super) struct Places<'a> {
    pub(super) search: &'a ShapeSearch,
    home: Home,
    keep: &'a Keep,
    /// Without links: the folder to keep, that of [`Keep::In`].
    folder: Option<PathBuf>,
    reference: Vec<PathBuf>,
    folders: Vec<PathBuf>,
}

impl<'a> Places<'a> {
    pub(super) fn new(search: &'a ShapeSearch, options: &'a DuplicateOptions) -> Result<Self, Error> {
        let all =
            |paths: &[PathBuf]| paths.iter().map(|path| canonical(path)).collect::<Result<Vec<_>, Error>>();
        let DuplicateOptions { keep, reference, folders, .. } = options;
        let folder = if let Keep::In(folder) = keep { Some(canonical(folder)?) } else { None };
        let (reference, folders) = (all(reference)?, all(folders)?);
        Ok(Self { search, home: Home::new(&search.index().path)?, keep, folder, reference, folders })
    }

    pub(super) fn file(
        &self,
        entry: &Entry,
        links: &[String],
        geometry: Option<&MeshGeometry>,
    ) -> DuplicateFile {
        let path = mesh_path(&self.search.index().path, &entry.path);
        let modified = std::fs::metadata(&path).ok().and_then(|facts| facts.modified().ok());
        let since_1970 = modified.and_then(|time| time.duration_since(std::time::UNIX_EPOCH).ok());
        let place = absolute(&path).unwrap_or_else(|_| path.clone());
        DuplicateFile {
            id: entry.id.clone(),
            // The folders of a file have no links if its path without them is the one that is known.
            is_linked: !(has_one_name(&path) && self.home.file_text(&path) == entry.path),
            bytes: Storage.n_bytes(&path).ok(),
            modified: since_1970.map(|time| time.as_secs()),
            size: geometry.and_then(|geometry| {
                let [low, high] = geometry.to_mesh().bounds()?;
                Some((high - low).into())
            }),
            vertices: geometry.map(MeshGeometry::n_vertices),
            links: links.to_vec(),
            reference: self.reference.iter().any(|folder| place.starts_with(folder)),
            path,
        }
    }

    /// Files in the order of these are kept: as far as the user [says](WANTED), and where neither is more exact. Triangles of STL
    /// have no vertices in common, and coordinates of 32 bits.
    pub(super) fn order(&self, file: &DuplicateFile) -> Order {
        let place = absolute(&file.path).unwrap_or_else(|_| file.path.clone());
        let is_elsewhere = self.folder.as_ref().is_some_and(|folder| !place.starts_with(folder));
        let folder = self.folders.iter().position(|folder| place.starts_with(folder));
        let vertices = file.vertices.unwrap_or_default() as i64;
        let bytes = file.bytes.unwrap_or_default() as i64;
        let age = file.modified.map_or(i64::MAX, |seconds| seconds as i64);
        let (first, second, why) = match self.keep {
            Keep::Exact | Keep::In(_) => (0, 0, ""),
            Keep::Largest => (-vertices, -bytes, "it is the largest"),
            Keep::Smallest => (vertices, bytes, "it is the smallest"),
            Keep::Oldest => (age, 0, "it is the oldest"),
            Keep::Newest => (-age, 0, "it is the newest"),
        };
        [
            (i64::from(is_elsewhere), "it is in the folder to keep"),
            (first, why),
            (second, why),
            (i64::from(!file.reference), "it is in a reference folder"),
            (i64::from(file.is_linked), "it is neither a link nor in an archive"),
            (i64::from(mesh_io::extension(&file.path) == "stl"), "its format keeps what triangles share"),
            (folder.unwrap_or(self.folders.len()) as i64, "its folder comes first"),
            (file.modified.unwrap_or_default() as i64, "it is the oldest"),
            (file.path.as_os_str().len() as i64, "it has the shortest path"),
        ]
    }
}

/// Numbers in descending order of weight, and why the file with the least one is kept.
pub(super) type Order = [(i64, &'static str); 9];

/// So many of them go before exactness.
pub(super) const WANTED: usize = 3;
