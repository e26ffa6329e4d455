//! Zip archives.

use std::fs::File;
use std::io::Read;

use mesh::Fault;
use mesh_io::inflated_limit;
use zip::ZipArchive;
use zip::result::ZipError;

use super::archive::{Archive, Data, Member};
use super::window::Window;
use crate::dataset::SkipKind;

pub(super) fn open(file: File) -> Result<Archive, Fault> {
    let window =
        Window::whole(file).map_err(|error| Fault::syntax("a file that can be read", error.to_string()))?;
    if window.len() == 0 {
        return Err(Fault::Empty);
    }
    let zip = ZipArchive::new(window).map_err(damaged)?;
    let directory = zip.metadata();
    // Clones share the directory and have positions of their own.
    let read = move |member: &Member, most| read(zip.clone(), member.at as usize, most);
    let mut archive = Archive::of(Data::Entries(Box::new(read)));
    for at in 0..directory.len() {
        let entry = directory.entry(at).map_err(damaged)?;
        // Many programs write UTF-8 without saying so.
        let raw = entry.name_raw();
        let name = std::str::from_utf8(raw).map(str::to_owned).or_else(|_| entry.name().map(Into::into));
        let Ok(name) = name else {
            archive.skip(&String::from_utf8_lossy(raw), SkipKind::NotUtf8);
            continue;
        };
        if entry.is_symlink() {
            archive.skip(&name, SkipKind::Special);
        } else if !entry.is_dir() {
            archive.add(&name, Member { size: entry.size(), label: String::new(), at: at as u64 });
        }
    }
    Ok(archive)
}

/// Decompresses a member, whose checksum must be right.
fn read(mut archive: ZipArchive<Window>, at: usize, most: u64) -> Result<Vec<u8>, Fault> {
    let entry = archive.by_index_data(at).map_err(damaged)?;
    if entry.encrypted() {
        let remedy = "unpack the archive with its password, or store it without one";
        return Err(Fault::unsupported("this member is encrypted", remedy));
    }
    // The stated sizes may be wrong.
    let limit = inflated_limit(entry.compressed_size()).min(most);
    let entry = archive.by_index(at).map_err(damaged)?;
    let mut bytes = Vec::new();
    entry
        .take(limit.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(|error| Fault::syntax("compressed data", error.to_string()))?;
    match bytes.len() as u64 > limit {
        true => Err(Fault::decompression_bomb(limit)),
        false => Ok(bytes),
    }
}

fn damaged(error: ZipError) -> Fault {
    match error {
        ZipError::UnsupportedArchive(_) | ZipError::CompressionMethodNotSupported(_) => {
            let remedy = "unpack the archive, or create it with Deflate compression";
            Fault::unsupported(error.to_string(), remedy)
        }
        other => Fault::syntax("an intact zip archive", other.to_string()),
    }
}
