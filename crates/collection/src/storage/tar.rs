//! Tar archives, compressed by gzip or not.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use mesh::Fault;
use mesh_io::GzipReader;
use tar::EntryType;

use super::archive::{Archive, Data, Member, Spool};
use super::window::Window;
use crate::dataset::SkipKind;

pub(super) fn open(path: &Path, file: File, most: u64) -> Result<Archive, Fault> {
    let damaged = |error: io::Error| Fault::syntax("an intact tar archive", error.to_string());
    let window = Window::whole(file).map_err(damaged)?;
    if window.len() == 0 {
        return Err(Fault::Empty);
    }
    let is_tar = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("tar"));
    let window = if is_tar { window } else { inflated(window, most)? };
    let mut archive = Archive::of(Data::Plain(window.clone()));
    let mut headers = tar::Archive::new(window);
    for entry in headers.entries_with_seek().map_err(damaged)? {
        let entry = entry.map_err(damaged)?;
        let bytes = entry.path_bytes();
        let name = String::from_utf8_lossy(&bytes);
        let kind = entry.header().entry_type();
        match kind {
            EntryType::Regular | EntryType::Continuous | EntryType::Link
                if std::str::from_utf8(&bytes).is_err() =>
            {
                archive.skip(&name, SkipKind::NotUtf8);
            }
            EntryType::Regular | EntryType::Continuous => {
                let member =
                    Member { size: entry.size(), label: String::new(), at: entry.raw_file_position() };
                archive.add(&name, member);
            }
            // Another name of a file before it.
            EntryType::Link => {
                let target = entry.link_name_bytes().unwrap_or_default();
                match archive.member(&String::from_utf8_lossy(&target)).cloned() {
                    Some(member) => archive.add(&name, member),
                    None => archive.skip(&name, SkipKind::BrokenLink),
                }
            }
            EntryType::Directory | EntryType::XGlobalHeader => {}
            _ => archive.skip(&name, SkipKind::Special),
        }
    }
    Ok(archive)
}

/// Decompresses everything, at most so many bytes.
fn inflated(window: Window, most: u64) -> Result<Window, Fault> {
    let mut spool = Spool::new(window.len(), most)?;
    let mut stream = GzipReader::new(window);
    let mut buffer = vec![0; 1 << 16];
    loop {
        match stream.read(&mut buffer) {
            Ok(0) => return spool.finish(),
            Ok(n) => {
                spool.append(&buffer[..n])?;
            }
            Err(error) => return Err(Fault::syntax("compressed data", error.to_string())),
        }
    }
}
