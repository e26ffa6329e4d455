//! Names of mesh files: the extension, behind which `.gz` may follow.

use std::path::{Path, PathBuf};

/// The extension of gzip files.
const GZIP: &str = "gz";

/// Whether a file is compressed, judging by its name.
pub fn is_gzip(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(GZIP))
}

/// The name without `.gz`.
pub(crate) fn inflated(path: &Path) -> PathBuf {
    if is_gzip(path) { path.with_extension("") } else { path.to_owned() }
}

/// The extension of a file name in lower case, that before `.gz` if the file is compressed; empty if there is none.
///
/// ```
/// use std::path::Path;
/// use canonform_mesh_io::extension;
///
/// assert_eq!(extension(Path::new("scans/CAT.OBJ")), "obj");
/// assert_eq!(extension(Path::new("scans/cat.obj.gz")), "obj");
/// ```
pub fn extension(path: &Path) -> String {
    inflated(path).extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// The path without the extension, and without `.gz`.
pub fn without_extension(path: &Path) -> PathBuf {
    inflated(path).with_extension("")
}

/// The path with another extension; `.gz` stays.
pub(crate) fn with_extension(path: &Path, extension: &str) -> PathBuf {
    let mut name = inflated(path).with_extension(extension).into_os_string();
    if is_gzip(path) {
        name.push(".");
        name.push(path.extension().unwrap_or_default());
    }
    name.into()
}

/// The path that a reference inside a file stands for: `./my%20data.bin` is `my data.bin`.
pub fn referred(text: &str) -> Option<String> {
    let mut parts = text.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        let (digits, rest) = part.split_at_checked(2)?;
        let is_byte = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        bytes.push(u8::from_str_radix(digits, 16).ok().filter(|_| is_byte)?);
        bytes.extend(rest.bytes());
    }
    let path = String::from_utf8(bytes).ok()?;
    Some(path.split('/').filter(|part| *part != ".").collect::<Vec<_>>().join("/"))
}
