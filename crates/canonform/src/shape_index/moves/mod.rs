//! Moving duplicates out of a folder, and back.
//!
//! Every move is a line of a journal, on the disk before the first file of its mesh moves. So whatever interrupts the work,
//! the journal leads back.

mod companions;
mod journal;
mod report;

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use base::ContentHash;
use base::files::FileError;
use collection::{MOVES, content_hash, member_of};

use self::companions::{Below, files_of_mesh};
use self::journal::Journal;
use super::duplicates::{DuplicateMember, DuplicateReport, has_one_name};
use crate::error::Error;

pub use self::report::{MoveReport, NotMoved};

/// Refuses a place for the duplicates of a folder, before the folder is searched: it must be new, empty, or of earlier moves, so
/// that nothing else is hidden in it. Takes back a mesh of which an interrupted program has moved a part.
///
/// # Errors
/// [`Error::Refused`], [`Error::File`].
pub fn check_place(folder: &Path, place: &Path) -> Result<(), Error> {
    let refused = |what: &str| Err(Error::refused(format!("{}: {what}", place.display())));
    let root = folder.canonicalize().map_err(|source| FileError::read(folder, source))?;
    if root.to_str().is_none() {
        return refused("the name of a folder around the meshes is not UTF-8; rename it");
    }
    match place.canonicalize() {
        Ok(real) if root.starts_with(&real) => refused("the meshes are in this folder; name another one"),
        Ok(real) if real.join(MOVES).exists() => Journal::start(&real).map(drop),
        Ok(real) => match fs::read_dir(real).map_err(|source| FileError::read(place, source))?.next() {
            None => Ok(()),
            Some(_) => refused("the folder holds other files; name a new one, or one of earlier moves"),
        },
        Err(fault) if fault.kind() == ErrorKind::NotFound => Ok(()),
        Err(source) => Err(FileError::read(place, source).into()),
    }
}

/// Moves the duplicates of a report that are proved to have the bytes, or the vertices and faces, of a file that stays. They go
/// from `folders` into `place`, below which they keep their folders and names, with all files of their meshes. Nothing is
/// overwritten; links and what they lead to stay, and files in reference folders or on another file system. Collections around `place` leave it out from then on.
///
/// # Errors
/// Those of [`check_place`]; [`Error::Refused`] if `place` is in use; [`Error::File`]. What was moved before stays in the journal.
pub fn move_duplicates<P: AsRef<Path>>(
    report: &DuplicateReport,
    folders: &[P],
    place: &Path,
) -> Result<MoveReport, Error> {
    let mut roots = Vec::new();
    for folder in folders.iter().map(AsRef::as_ref) {
        check_place(folder, place)?;
        let root = folder.canonicalize().map_err(|source| FileError::read(folder, source))?;
        roots.push((Below::new(&root), root));
    }
    let (mut moves, mut journal) = (MoveReport::default(), None);
    let members =
        report.groups.iter().flat_map(|group| group.members.iter().map(move |member| (group, member)));
    for (group, member) in members.filter(|(_, member)| !member.file.reference) {
        let mut files = group.members.iter().map(|member| &member.file).chain([&group.keeper]);
        let kept = files.find(|file| file.id == member.of).map(|file| file.path.as_path());
        let root = roots.iter().find(|(_, root)| member.file.path.starts_with(root)).or(roots.first());
        let (Some((below, root)), Some(kept)) = (root, kept) else { continue };
        let files = match files_to_move(member, kept, root, below) {
            Ok(files) => files,
            Err(why) => {
                moves.not_moved.push(NotMoved { path: member.file.path.clone(), why });
                continue;
            }
        };
        let journal = match &mut journal {
            Some(journal) => journal,
            none => none.insert(Journal::start(place)?),
        };
        let line = journal.line(files, root);
        journal.append(&line)?;
        moves.journal = Some(journal.path.clone());
        if let Err(source) = line.there(&journal.folder, &mut moves) {
            line.back(&journal.folder, &mut MoveReport::default());
            journal.take_back()?;
            if source.kind() != ErrorKind::CrossesDevices {
                return Err(FileError::write(&member.file.path, source).into());
            }
            let why = "it is on another file system; name a folder on that one".to_owned();
            moves.not_moved.push(NotMoved { path: member.file.path.clone(), why });
        }
    }
    Ok(moves)
}

/// Puts files back that [`move_duplicates`] has moved, the last first, as its journal says. What cannot be put back stays in the
/// journal.
///
/// # Errors
/// [`Error::Refused`] if the journal is damaged or in use; [`Error::File`].
pub fn undo_moves(journal: &Path) -> Result<MoveReport, Error> {
    let mut journal = Journal::open(journal, false)?;
    let mut moves = MoveReport::default();
    let mut lines = std::mem::take(&mut journal.lines);
    lines.reverse();
    lines.retain(|line| !line.back(&journal.folder, &mut moves));
    lines.reverse();
    moves.journal = journal.finish(&lines)?;
    Ok(moves)
}

/// The files of a member, or why they stay.
fn files_to_move(
    member: &DuplicateMember,
    keeper: &Path,
    root: &Path,
    below: &Below,
) -> Result<Vec<PathBuf>, String> {
    let path = member.file.path.as_path();
    if !member.relation.kind.is_one_geometry() {
        return Err("it is not proved to have the vertices and faces of a file to keep".into());
    }
    if member_of(path).is_some() {
        return Err("it is in an archive".into());
    }
    let files = files_of_mesh(path);
    for file in &files {
        // A path without links below the root is its own canonical path.
        if !file.starts_with(root) || !file.canonicalize().is_ok_and(|real| real == *file) {
            return Err("it is a link, or not below the folder".into());
        }
        if let Some(link) = below.links.get(file) {
            return Err(format!("the link {} leads to it", link.display()));
        }
        if !has_one_name(file) {
            return Err("it has several names (hard links), so moving it spares nothing".into());
        }
    }
    let is_known = |(path, hash): (&Path, Option<ContentHash>)| {
        hash.is_some_and(|hash| content_hash(path).is_ok_and(|found| found == hash))
    };
    if ![keeper, path].into_iter().zip(member.relation.evidence.content).all(is_known) {
        return Err("it, or the file to keep, has changed since they were compared".into());
    }
    match below.other_user(&files, root) {
        Some(user) => Err(format!("{} needs a file of it", user.display())),
        None => Ok(files),
    }
}
