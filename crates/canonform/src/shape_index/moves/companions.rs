//! All files of a mesh, also those that are not read.

use std::cell::OnceCell;
use std::collections::HashMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

use collection::list_shapes;
use mesh_io::{Disk, files_in, referred};

/// Extensions of files that a mesh needs to look as it does.
const COMPANIONS: [&str; 14] = [
    ".mtl", ".bin", ".png", ".jpg", ".jpeg", ".tga", ".bmp", ".tif", ".tiff", ".dds", ".ktx2", ".webp",
    ".gif", ".exr",
];

/// What else is below a folder.
#[derive(Debug, Default)]
pub(super) struct Below {
    /// Links by the files that they lead to.
    pub(super) links: HashMap<PathBuf, PathBuf>,
    users: OnceCell<HashMap<PathBuf, Vec<PathBuf>>>,
}

impl Below {
    /// What cannot be read holds nothing.
    pub(super) fn new(folder: &Path) -> Self {
        let mut below = Self::default();
        let mut folders = vec![folder.to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
                let (path, Ok(kind)) = (entry.path(), entry.file_type()) else { continue };
                if kind.is_dir() {
                    folders.push(path);
                } else if let Some(target) = path.canonicalize().ok().filter(|_| kind.is_symlink()) {
                    below.links.insert(target, path);
                }
            }
        }
        below
    }

    /// Another mesh below `root` that needs one of these files, which are those of a mesh.
    pub(super) fn other_user(&self, files: &[PathBuf], root: &Path) -> Option<PathBuf> {
        let (mesh, others) = files.split_first()?;
        if others.is_empty() {
            return None;
        }
        let users = self.users.get_or_init(|| {
            let mut users: HashMap<PathBuf, Vec<PathBuf>> = HashMap::new();
            for shape in list_shapes(root, None).unwrap_or_default() {
                for file in files_of_mesh(&shape.path) {
                    users.entry(file).or_default().push(shape.path.clone());
                }
            }
            users
        });
        files.iter().find_map(|file| users.get(file)?.iter().find(|user| *user != mesh).cloned())
    }
}

/// The files that are read for a mesh, the mesh first, and the materials and pictures that it names beside or below it.
pub(super) fn files_of_mesh(mesh: &Path) -> Vec<PathBuf> {
    let mut files = vec![mesh.to_owned()];
    files.extend(files_in(mesh, &Disk).into_iter().filter(|file| file != mesh));
    let mut next = 0;
    while let Some(file) = files.get(next) {
        let names_others = next == 0 || file.extension().is_some_and(|extension| extension == "mtl");
        let named = if names_others { named_in(file) } else { Vec::new() };
        for file in named {
            if !files.contains(&file) {
                files.push(file);
            }
        }
        next += 1;
    }
    files
}

/// The companions that are named in a file: in a string of glTF, or at the end of a line of OBJ, MTL or PLY.
fn named_in(file: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for piece in fs::read(file).unwrap_or_default().split(|byte| matches!(byte, b'"' | b'\n' | b'\r')) {
        let piece = piece.trim_ascii();
        let ends = |known: &[u8]| {
            piece.len() > known.len() && piece[piece.len() - known.len()..].eq_ignore_ascii_case(known)
        };
        if !COMPANIONS.iter().any(|known| ends(known.as_bytes())) {
            continue;
        }
        let text = String::from_utf8_lossy(piece);
        let text = referred(&text).unwrap_or_else(|| text.into_owned()).replace('\\', "/");
        // Words before the name end with a blank; the name may hold blanks, too.
        let starts = text.match_indices([' ', '\t']).map(|(at, _)| at + 1);
        let names = std::iter::once(0).chain(starts).map(|at| Path::new(&text[at..]));
        let is_below = |name: &&Path| {
            name.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
        };
        let files = names.filter(is_below).map(|name| file.with_file_name("").join(name));
        found.extend(files.filter(|file| fs::symlink_metadata(file).is_ok_and(|about| !about.is_dir())));
    }
    found
}
