//! The mesh files that become shapes of an index.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use files::FileError;
use index::{ContentHash, ShapeEntry};
use mesh::TriMesh;
use mesh::io::{MemoryFile, ReadLimits};
use rayon::prelude::*;

use crate::error::Error;
use crate::input::{LabelFile, ShapeFile, label_in, list_shapes};
use crate::observer::Observer;

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
    /// [`Error::NoSuchShard`].
    pub fn new(index: usize, count: usize) -> Result<Self, Error> {
        match count > 0 && index <= count {
            true => Ok(Self { index: index % count, count }),
            false => Err(Error::NoSuchShard { shard: index, n_shards: count }),
        }
    }

    /// Whether the shard holds the item at this place of the collection, counted from 1.
    fn holds(self, place: usize) -> bool {
        place % self.count == self.index
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
    /// Classes by name. Default: from the names of folders and files.
    pub labels: Option<&'a LabelFile>,
    /// One class for all of them, regardless of their names.
    pub label: Option<&'a str>,
}

impl Inputs<'_> {
    /// The meshes; files that differ only in their extensions have them in their names.
    pub(super) fn list(&self) -> Result<Vec<ShapeFile>, Error> {
        let mut shapes = Vec::new();
        for path in self.paths {
            if path.is_dir() {
                shapes.extend(list_shapes(path, self.labels)?);
            } else {
                let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                shapes.push(ShapeFile { label: label_in(self.labels, &name)?, name, path: path.clone() });
            }
        }
        if let Some(label) = self.label {
            shapes.iter_mut().for_each(|shape| shape.label = label.to_owned());
        }
        name_apart(&mut shapes);
        Ok(shapes)
    }
}

/// Adds the extension to the names of files that differ in nothing else.
pub(super) fn name_apart(shapes: &mut [ShapeFile]) {
    let mut counts: HashMap<String, usize> = HashMap::new();
    shapes.iter().for_each(|shape| *counts.entry(shape.name.clone()).or_default() += 1);
    for shape in shapes {
        if counts.get(&shape.name).is_some_and(|count| *count > 1)
            && let Some(extension) = shape.path.extension()
        {
            shape.name = format!("{}.{}", shape.name, extension.to_string_lossy());
        }
    }
}

/// The shapes of a shard.
pub(super) fn share(shapes: Vec<ShapeFile>, shard: Option<Shard>) -> Vec<ShapeFile> {
    let Some(shard) = shard else { return shapes };
    let in_share = |(i, shape): (usize, ShapeFile)| shard.holds(i + 1).then_some(shape);
    shapes.into_iter().enumerate().filter_map(in_share).collect()
}

/// A mesh file and the hash of its content, or the error of reading it.
pub(super) type Hashed = (ShapeFile, Result<ContentHash, Error>);

/// Hashes all files, in parallel.
pub(super) fn hash_all(shapes: Vec<ShapeFile>, observer: &dyn Observer) -> Vec<Hashed> {
    observer.begin("reading", shapes.len());
    shapes
        .into_par_iter()
        .map(|shape| {
            let hash = content(&shape.path);
            observer.step();
            (shape, hash)
        })
        .collect()
}

/// Reads the mesh of an indexed shape, if the file still has the content that was indexed.
pub(super) fn read_unchanged(id: &str, entry: &ShapeEntry) -> Result<TriMesh, Error> {
    let path = PathBuf::from(&entry.path);
    let files = mesh::io::files_of(&path);
    let pieces = files.iter().map(std::fs::read).collect::<Result<Vec<_>, _>>();
    let pieces =
        pieces.map_err(|source| Error::MeshGone { id: id.to_owned(), path: path.clone(), source })?;
    if ContentHash::of(&pieces) != entry.content {
        return Err(Error::MeshChanged { id: id.to_owned(), path });
    }
    // Parse the bytes that were hashed: the file might change in between.
    let files = files.iter().zip(&pieces).map(|(name, bytes)| MemoryFile { name, bytes });
    Ok(mesh::io::read_memory(&files.collect::<Vec<_>>(), &ReadLimits::default())?)
}

fn content(path: &Path) -> Result<ContentHash, Error> {
    let read = |path: &PathBuf| std::fs::read(path).map_err(|source| FileError::read(path, source));
    let pieces = mesh::io::files_of(path).iter().map(read).collect::<Result<Vec<_>, _>>()?;
    Ok(ContentHash::of(&pieces))
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
        assert!(matches!(Shard::new(4, 3), Err(Error::NoSuchShard { shard: 4, n_shards: 3 })));
    }

    #[test]
    fn equal_names_get_their_extensions() {
        let mut shapes = [shape("cat", "cat.off"), shape("cat", "cat.ply"), shape("dog", "dog.off")];
        name_apart(&mut shapes);
        assert_eq!(shapes.map(|s| s.name), ["cat.off", "cat.ply", "dog"]);
    }
}
