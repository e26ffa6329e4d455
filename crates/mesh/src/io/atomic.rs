//! Files that are there whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use tempfile::NamedTempFile;

use crate::MeshError;

/// A file written next to its destination but not yet in its place.
pub(super) struct Pending<'a> {
    file: NamedTempFile,
    path: &'a Path,
}

impl<'a> Pending<'a> {
    /// Writes all of a file; on any error nothing remains.
    pub(super) fn write(
        path: &'a Path,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Self, MeshError> {
        let written = || {
            let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let mut file = new_file_in(folder)?;
            let mut out = BufWriter::with_capacity(1 << 16, &mut file);
            content(&mut out)?;
            out.flush()?;
            drop(out);
            Ok(file)
        };
        let file = written().map_err(|source| cannot_write(path, source))?;
        Ok(Self { file, path })
    }

    /// Puts the file into its place, over what was there.
    pub(super) fn publish(self) -> Result<(), MeshError> {
        self.file.persist(self.path).map(drop).map_err(|e| cannot_write(self.path, e.error))
    }
}

/// A temporary file with the permissions of an ordinary new one, not only for its owner.
fn new_file_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".mesh-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

fn cannot_write(path: &Path, source: io::Error) -> MeshError {
    MeshError::Io { action: "write", path: path.to_path_buf(), source }
}
