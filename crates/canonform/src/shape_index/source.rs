//! The mesh files that become shapes of an index.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use base::Budget;
use base::ContentHash;
use base::files::FileId;
use index::Entry;
use mesh::{MeshError, TriMesh};
use mesh_io::{FileSource, MemoryFile, ReadLimits, without_extension};
use rayon::prelude::*;

use super::place::{Home, Root, absolute, is_end, mesh_path};
use crate::error::Error;
use base::Observer;
use collection::{
    CollectionError, Dataset, LabelOrigin, LabelSource, ShapeFile, SkipKind, Skipped, Storage, UnusedLabel,
    content_hash, content_of, drop_single_class, is_dataset, is_suggested, label_of, label_shapes,
    read_mesh_file,
};

/// One of several equal parts of a collection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// Shard `index` of `count`, numbered from 1. 0 is another name of the last, so numbering from 0 works too.
    ///
    /// # Errors
    /// [`Error::Refused`].
    pub fn new(index: usize, count: usize) -> Result<Self, Error> {
        match count > 0 && index <= count {
            true => Ok(Self { index: index % count, count }),
            false => Err(Error::refused(format!(
                "shard {index} of {count} does not exist; shards are numbered 1 to {count}, or from 0"
            ))),
        }
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        let (index, count) = numbers.ok_or_else(|| format!("`{text}` is not of the form 2/8"))?;
        Self::new(index, count).map_err(|fault| fault.to_string())
    }
}

/// Meshes to add to an index.
#[derive(Debug, Clone, Copy)]
pub struct Inputs<'a> {
    /// Mesh files, and folders of them.
    pub paths: &'a [PathBuf],
    /// Where classes come from. Default: the names of folders and files decide, as for a [`Dataset`]; a single file has the
    /// class that its name suggests if the index knows it.
    pub labels: Option<&'a LabelSource>,
    /// One class for all of them, regardless of their names.
    pub label: Option<&'a str>,
    /// What describing each of them may use.
    pub limits: ShapeLimits,
}

/// What reading and describing one shape may use, so that a batch goes on past a large or slow one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ShapeLimits {
    /// Most vertices of a mesh, which may have four times as many faces. Default: as many as a mesh can have.
    pub max_vertices: Option<u64>,
    /// Time from reading the mesh to its description. Default: none.
    pub time: Option<Duration>,
    /// Bytes of memory, also of the files. Default: none.
    pub memory: Option<usize>,
}

impl ShapeLimits {
    /// The budget of a shape that is begun now, as part of that of the whole.
    pub fn budget(&self, whole: Budget) -> Budget {
        let budget = match self.time {
            Some(limit) => whole.with_time(limit),
            None => whole,
        };
        match self.memory {
            Some(bytes) => budget.with_memory(bytes),
            None => budget,
        }
    }

    /// Reads a mesh within these limits.
    pub(super) fn read(&self, path: &Path, budget: &Budget) -> Result<TriMesh, Error> {
        let limits = self.max_vertices.map_or_else(ReadLimits::default, ReadLimits::of_vertices);
        let mut n_bytes = 0;
        for file in mesh_io::files_in(path, &Storage) {
            n_bytes += Storage.n_bytes(&file)?;
        }
        budget.check_memory(usize::try_from(n_bytes).unwrap_or(usize::MAX))?;
        Ok(read_mesh_file(path, &limits)?.mesh)
    }
}

/// A mesh file, and how the index names it.
#[derive(Debug, Clone)]
pub(super) struct Listed {
    pub(super) file: ShapeFile,
    /// Its path as the index stores it.
    pub(super) stored: String,
    /// Whether it was named on its own, and not found in a dataset.
    pub(super) is_single: bool,
}

/// The meshes to index, and what was found beside them.
#[derive(Debug, Default)]
pub(super) struct Listing {
    pub(super) shapes: Vec<Listed>,
    pub(super) skipped: Vec<Skipped>,
    /// The label that nearly all shapes would have got.
    pub(super) single_class: Option<String>,
    /// Where classes come from; several inputs may differ.
    pub(super) labelled_by: Option<LabelOrigin>,
    /// Lines of the label file that name none of the shapes.
    pub(super) unused_labels: Vec<UnusedLabel>,
}

impl Listing {
    /// The meshes of a folder; files that differ only in their extensions have them in their names.
    pub(super) fn from_folder(root: &Root<'_>, labels: Option<&LabelSource>) -> Result<Self, Error> {
        let Dataset { shapes, labelled_by, skipped } = Dataset::read(root.given, labels)?;
        let listed =
            shapes.into_iter().map(|file| Listed { stored: root.text(&file.path), file, is_single: false });
        let listing = Self::new(listed, skipped, labels, |_| false)?;
        let is_unlabelled = |listed: &Listed| listed.file.label.is_empty();
        if let (Some(file), [first, ..]) = (labels.and_then(LabelSource::file), &listing.shapes[..])
            && listing.shapes.iter().all(is_unlabelled)
        {
            return Err(file.fits_none(&first.file.name).into());
        }
        let labelled_by = if listing.single_class.is_some() { LabelOrigin::None } else { labelled_by };
        Ok(Self { labelled_by: Some(labelled_by), ..listing })
    }

    /// Keeps the classes that shapes of an index have, if `all` were given or one is not what the name suggests.
    pub(super) fn keep_labels(&mut self, entries: &[Entry], all: bool) {
        let known: HashMap<&str, &str> =
            entries.iter().map(|entry| (entry.path.as_str(), entry.label.as_str())).collect();
        for Listed { file, stored, .. } in &mut self.shapes {
            let label = known.get(stored.as_str()).copied().unwrap_or_default();
            if all || !(label.is_empty() || is_suggested(label, &file.name)) {
                label.clone_into(&mut file.label);
            }
        }
        if all {
            self.labelled_by = Some(LabelOrigin::File);
        }
    }

    fn new(
        listed: impl IntoIterator<Item = Listed>,
        skipped: Vec<Skipped>,
        labels: Option<&LabelSource>,
        is_class: impl Fn(&str) -> bool,
    ) -> Result<Self, Error> {
        let places = listed.into_iter().map(|Listed { file, stored, is_single }| (file, (stored, is_single)));
        let (mut shapes, places): (Vec<ShapeFile>, Vec<_>) = places.unzip();
        let single_class = labels.is_none().then(|| drop_single_class(&mut shapes, is_class)).flatten();
        let file = labels.and_then(LabelSource::file);
        let unused_labels = file.map(|file| file.unused(&shapes)).transpose()?.unwrap_or_default();
        name_apart(&mut shapes);
        let shapes = shapes.into_iter().zip(places);
        let shapes = shapes.map(|(file, (stored, is_single))| Listed { file, stored, is_single }).collect();
        Ok(Self { shapes, skipped, single_class, labelled_by: None, unused_labels })
    }
}

impl Inputs<'_> {
    /// The meshes; files that differ only in their extensions have them in their names. `is_class` tells classes of the
    /// index.
    pub(super) fn list(&self, home: &Home, is_class: impl Fn(&str) -> bool) -> Result<Listing, Error> {
        let (mut listed, mut skipped) = (Vec::new(), Vec::new());
        for path in self.paths {
            let stem = without_extension(path);
            if is_dataset(path) {
                let (root, dataset) = (Root::new(path, home)?, Dataset::read(path, self.labels)?);
                let place =
                    |file: ShapeFile| Listed { stored: root.text(&file.path), file, is_single: false };
                listed.extend(dataset.shapes.into_iter().map(place));
                skipped.extend(dataset.skipped);
            } else if let Some(name) = stem.file_name().and_then(|name| name.to_str()) {
                let file = ShapeFile { label: String::new(), name: name.to_owned(), path: path.clone() };
                listed.push(Listed { file, stored: home.file_text(path), is_single: true });
            } else {
                skipped.push(Skipped { path: path.clone(), kind: SkipKind::NotUtf8 });
            }
        }
        let (mut seen, mut places) = (HashSet::new(), HashSet::new());
        listed.retain(|Listed { file: ShapeFile { path, .. }, stored, .. }| {
            // A link leads to a file that is there anyway; hard links are files of their own. What cannot be found is reported when
            // it is read.
            let is_link = path.symlink_metadata().is_ok_and(|about| about.is_symlink());
            let is_known = FileId::of(path).is_ok_and(|id| !seen.insert(id));
            let is_repeated = !places.insert(stored.clone()) || is_link && is_known;
            if is_repeated {
                skipped.push(Skipped { path: path.clone(), kind: SkipKind::Repeated });
            }
            !is_repeated
        });
        self.label_single(&mut listed, &is_class);
        if let Some(label) = self.label {
            listed.iter_mut().for_each(|listed| listed.file.label = label.to_owned());
        }
        // A class that was asked for is one.
        let is_class = |label: &str| self.label == Some(label) || is_class(label);
        Listing::new(listed, skipped, self.labels, is_class)
    }

    /// Labels the files that belong to no dataset, together.
    fn label_single(&self, listed: &mut [Listed], is_class: impl Fn(&str) -> bool) {
        let (mut files, places): (Vec<ShapeFile>, Vec<&mut ShapeFile>) = listed
            .iter_mut()
            .filter(|listed| listed.is_single)
            .map(|Listed { file, .. }| (file.clone(), file))
            .unzip();
        label_shapes(&mut files, self.labels);
        for (place, mut file) in places.into_iter().zip(files) {
            let suggested = label_of(&file.name);
            if self.labels.is_none() && file.label.is_empty() && is_class(&suggested) {
                file.label = suggested;
            }
            *place = file;
        }
    }
}

/// Adds the extension to the names of files beside each other that differ in nothing else.
pub(super) fn name_apart(shapes: &mut [ShapeFile]) {
    let place = |shape: &ShapeFile| without_extension(&shape.path);
    let mut counts: HashMap<PathBuf, usize> = HashMap::new();
    shapes.iter().for_each(|shape| *counts.entry(place(shape)).or_default() += 1);
    for shape in shapes {
        if counts[&place(shape)] > 1
            && let Some(extension) = full_extension(&shape.path)
        {
            shape.name = format!("{}.{extension}", shape.name);
        }
    }
}

/// [Names](name_places) files below a folder.
pub(super) fn name_below(
    root: &Root<'_>,
    files: &mut [Hashed],
    index: (&Path, &[Entry]),
) -> Result<(), Error> {
    let keeps = |listed: &Listed, entry: &Entry| is_end(&listed.file.name, &entry.id);
    name_places(files, index, keeps, |_, _, entry| root.contains_source(&entry.id, &entry.path))
}

/// Gives every file the name of its place in the index, or one that no other place has: with the names of folders around its
/// dataset in front. A name goes from one place to another if the file was moved, or if `gives` says so.
pub(super) fn name_places(
    files: &mut [Hashed],
    (index, entries): (&Path, &[Entry]),
    keeps: impl Fn(&Listed, &Entry) -> bool,
    gives: impl Fn(&Listed, Option<&ContentHash>, &Entry) -> bool,
) -> Result<(), Error> {
    let by_id: HashMap<&str, &Entry> = entries.iter().map(|entry| (entry.id.as_str(), entry)).collect();
    let by_place: HashMap<&str, &Entry> = entries.iter().map(|entry| (entry.path.as_str(), entry)).collect();
    let mut taken = HashSet::new();
    let mut nameless = Vec::new();
    for (i, (listed, hash)) in files.iter_mut().enumerate() {
        let known = by_place.get(listed.stored.as_str()).filter(|entry| keeps(listed, entry));
        if let Some(entry) = known {
            listed.file.name.clone_from(&entry.id);
        }
        let is_free = known.is_some()
            || by_id.get(listed.file.name.as_str()).is_none_or(|entry| {
                let hash = hash.as_ref().ok();
                let has_moved =
                    || hash == Some(&entry.content) && !Storage.holds(&mesh_path(index, &entry.path));
                entry.path == listed.stored || gives(listed, hash, entry) || has_moved()
            });
        if !is_free || !taken.insert(listed.file.name.clone()) {
            nameless.push(i);
        }
    }
    for i in nameless {
        let file = &mut files[i].0.file;
        let path = absolute(&file.path)?;
        let folders: Vec<String> = path.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        let around = &folders[..folders.len().saturating_sub(file.name.split('/').count())];
        let names =
            (0..around.len()).rev().map(|start| format!("{}/{}", around[start..].join("/"), file.name));
        let is_free = |name: &String| !by_id.contains_key(name.as_str()) && !taken.contains(name);
        if let Some(name) = names.into_iter().find(is_free) {
            file.name.clone_from(&name);
            taken.insert(name);
        }
    }
    Ok(())
}

/// The extension of a mesh, that of a compressed one with `.gz`.
pub(super) fn full_extension(path: &Path) -> Option<String> {
    let stem = without_extension(path).file_name()?.to_string_lossy().into_owned();
    let name = path.file_name()?.to_string_lossy();
    Some(name.strip_prefix(&stem)?.strip_prefix('.')?.to_owned())
}

/// The shapes of a shard.
pub(super) fn share<T>(shapes: Vec<T>, shard: Option<Shard>) -> Vec<T> {
    let Some(shard) = shard else { return shapes };
    let held = shapes.into_iter().zip(1..).filter(|(_, place)| place % shard.count == shard.index);
    held.map(|(shape, _)| shape).collect()
}

/// A mesh file and the hash of its content, or the error of reading it.
pub(super) type Hashed = (Listed, Result<ContentHash, Error>);

/// Hashes all files, in parallel.
pub(super) fn hash_all(shapes: Vec<Listed>, observer: &dyn Observer) -> Vec<Hashed> {
    observer.begin("reading", shapes.len());
    shapes
        .into_par_iter()
        .map(|shape| {
            let hash = content_hash(&shape.file.path).map_err(Error::from);
            observer.step();
            (shape, hash)
        })
        .collect()
}

/// Reads the mesh of an indexed shape, if the file still has the content that was indexed.
pub(super) fn read_unchanged(index: &Path, entry: &Entry) -> Result<TriMesh, Error> {
    let files = unchanged_files(index, entry)?;
    let files = files.iter().map(|(name, bytes)| MemoryFile { name, bytes });
    Ok(mesh_io::read_memory(&files.collect::<Vec<_>>(), &ReadLimits::default())?)
}

/// The files of the mesh of an indexed shape, if they still have the content that was indexed.
pub(super) fn unchanged_files(index: &Path, entry: &Entry) -> Result<Vec<(PathBuf, Vec<u8>)>, Error> {
    let path = mesh_path(index, &entry.path);
    let gone = |fault: CollectionError| match fault {
        CollectionError::File(fault) | CollectionError::Mesh(MeshError::Io(fault)) => {
            let (id, path, source) = (entry.id.clone(), path.clone(), fault.source);
            Error::MeshGone { id, path, source }
        }
        other => other.into(),
    };
    let changed = || Error::MeshChanged { id: entry.id.clone(), path: path.clone() };
    let files = mesh_io::files_in(&path, &Storage);
    // Hashing takes little memory, whatever the path of a foreign index leads to.
    if content_hash(&path).map_err(gone)? != entry.content {
        return Err(changed());
    }
    let pieces = files.iter().map(|file| content_of(file)).collect::<Result<Vec<_>, _>>().map_err(gone)?;
    // The file might have changed in between.
    if ContentHash::of(&pieces) != entry.content {
        return Err(changed());
    }
    Ok(files.into_iter().zip(pieces).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(name: &str, path: &str) -> ShapeFile {
        ShapeFile { name: name.to_owned(), label: String::new(), path: path.into() }
    }

    #[test]
    fn shards_are_a_partition_numbered_from_one_or_from_zero() {
        let all: Vec<ShapeFile> = (0..10).map(|i| shape(&i.to_string(), "a")).collect();
        for first in [0, 1] {
            let parts: Vec<_> =
                (first..first + 3).map(|i| share(all.clone(), Some(Shard::new(i, 3).unwrap()))).collect();
            assert!(parts.iter().all(|part| (3..=4).contains(&part.len())));
            let mut joined: Vec<_> = parts.into_iter().flatten().map(|s| s.name).collect();
            joined.sort();
            assert!(joined.into_iter().eq((0..10).map(|i| i.to_string())));
        }
        assert_eq!("2/8".parse(), Ok(Shard::new(2, 8).unwrap()));
        for bad in ["", "3", "a/b", "4/3", "0/0", "-1/3"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
        assert!(Shard::new(4, 3).unwrap_err().to_string().starts_with("shard 4 of 3"));
    }

    #[test]
    fn equal_names_get_their_extensions() {
        let mut shapes = [shape("cat", "cat.off"), shape("cat", "cat.ply"), shape("dog", "dog.off")];
        name_apart(&mut shapes);
        assert_eq!(shapes.map(|s| s.name), ["cat.off", "cat.ply", "dog"]);
    }
}
