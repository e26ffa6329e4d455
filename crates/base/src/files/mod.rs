//! Files that appear complete or not at all, even if the program is interrupted.
//!
//! Every file is written to a temporary file in the same folder, flushed to disk, and renamed once it is complete. A
//! reader never sees half a file, and a failure, even of power, leaves the previous version in place. The temporary
//! file of a killed program is removed when the next one writes to the same folder.
//!
//! ```
//! # let folder = tempfile::tempdir().unwrap();
//! let path = folder.path().join("report.txt");
//! canonform_base::files::write_atomically(&path, |out| out.write_all(b"complete"))?;
//! assert_eq!(std::fs::read(&path).unwrap(), b"complete");
//! # Ok::<(), canonform_base::files::FileError>(())
//! ```

mod atomic;
mod error;
mod identity;

pub use atomic::{
    Pending, Scratch, abandon_unfinished, fill_atomically, is_input, keep_input, nameless_in, sync_folder,
    write_atomically, write_bytes,
};
pub use error::{FileError, remedy};
pub use identity::{FileId, has_other_names, is_at, is_same_file};
