//! The bytes of a glTF file: chunks of GLB, buffers, data URIs and names of other files.

use std::borrow::Cow;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::schema::{Index, Root};
use crate::located::{At, Located};
use crate::name::referred;
use crate::text::{check_is_not_utf16, check_is_text, excerpt};
use mesh::Fault;

const MAGIC: &[u8] = b"glTF";
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// Checks that a file is text that begins like JSON.
pub(crate) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    check_is_not_utf16(start)?;
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
    match text.first() {
        None | Some(b'{') => check_is_text(start, "a glTF file"),
        Some(_) if start.starts_with(MAGIC) => {
            let found = "it begins like a binary one, whose extension is .glb";
            Err(Fault::wrong_format("a glTF file as text", found).whole())
        }
        Some(_) => Err(wrong("a glTF file", text)),
    }
}

/// Checks the header of a GLB file, and that the file has the length it states.
pub(crate) fn check_binary_start(start: &[u8], size: Option<u64>) -> Result<(), Located> {
    if start.trim_ascii().is_empty() {
        return Err(Fault::Empty.whole());
    }
    if !start.starts_with(MAGIC) {
        return Err(wrong("a GLB file", start));
    }
    let word =
        |at: usize| start.get(at..).and_then(<[u8]>::first_chunk).map(|word| u32::from_le_bytes(*word));
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(Fault::cut_short("the header").at_byte(start.len()));
    };
    if version != 2 {
        let what = format!("this is version {version} of GLB");
        return Err(Fault::unsupported(what, "export it as glTF 2.0").at_byte(4));
    }
    let least = (HEADER + CHUNK_HEADER) as u64;
    match size {
        _ if u64::from(length) < least => {
            let found = format!("{length} bytes in the header");
            Err(Fault::syntax("the length of a GLB file, which is not empty", found).at_byte(8))
        }
        Some(size) if size < u64::from(length) => {
            Err(Fault::truncated("bytes", u64::from(length), size).at_byte(8))
        }
        _ => Ok(()),
    }
}

fn wrong(expected: &'static str, start: &[u8]) -> Located {
    Fault::wrong_format(expected, format!("it begins with `{}`", excerpt(start))).whole()
}

/// The JSON of a file, the byte at which it begins, and the binary chunk if there is one.
pub(super) type Parts<'a> = (&'a [u8], usize, Option<&'a [u8]>);

/// Splits a GLB file.
pub(super) fn split_binary(bytes: &[u8]) -> Result<Parts<'_>, Located> {
    check_binary_start(bytes, Some(bytes.len() as u64))?;
    let length = bytes.get(8..).and_then(<[u8]>::first_chunk).map_or(0, |word| u32::from_le_bytes(*word));
    // Bytes after the stated length belong to nobody.
    let bytes = &bytes[..(length as usize).clamp(HEADER, bytes.len())];
    let Some((b"JSON", json, mut at)) = chunk(bytes, HEADER)? else {
        return Err(Fault::cut_short("the JSON chunk").at_byte(HEADER));
    };
    while let Some((kind, data, next)) = chunk(bytes, at)? {
        if kind == b"BIN\0" {
            return Ok((json, HEADER + CHUNK_HEADER, Some(data)));
        }
        at = next;
    }
    Ok((json, HEADER + CHUNK_HEADER, None))
}

/// The kind and the data of the chunk at a byte, and where the next one begins. `None` at the end of the file.
type Chunk<'a> = Option<(&'a [u8; 4], &'a [u8], usize)>;

fn chunk(bytes: &[u8], at: usize) -> Result<Chunk<'_>, Located> {
    let rest = bytes.get(at..).unwrap_or_default();
    let Some((header, rest)) = rest.split_at_checked(CHUNK_HEADER) else {
        // Less than a header is padding.
        return Ok(None);
    };
    let (Some(length), Some(kind)) = (header.first_chunk(), header.last_chunk()) else { return Ok(None) };
    let length = u32::from_le_bytes(*length) as usize;
    let data = rest
        .get(..length)
        .ok_or_else(|| Fault::truncated("bytes of a chunk", length as u64, rest.len() as u64).at_byte(at))?;
    Ok(Some((kind, data, at + CHUNK_HEADER + length)))
}

/// Names of the other files that hold buffers, each once, in the order of the buffers.
pub(super) fn companions(root: &Root) -> Result<Vec<String>, Located> {
    let mut names = Vec::new();
    for (number, buffer) in root.buffers.iter().enumerate() {
        if let Some(uri) = buffer.uri.as_deref().filter(|uri| !is_data(uri)) {
            let name = local_name(uri).map_err(|fault| fault.in_part("buffer", number))?;
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    Ok(names)
}

fn is_data(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// The name of a file below the folder of the glTF file.
fn local_name(uri: &str) -> Result<String, Fault> {
    let outside = || {
        Fault::unsupported(
            format!("its data is in `{}`, which is not a file in its own folder", excerpt(uri.as_bytes())),
            "put both files into one folder and name the data by its file name, or export a .glb file",
        )
    };
    let name = referred(uri).ok_or_else(outside)?;
    let is_strange = |c: char| c.is_control() || matches!(c, '\\' | ':');
    let is_part = |part: &str| !matches!(part, "" | "..");
    match !name.contains(is_strange) && name.split('/').all(is_part) {
        true => Ok(name),
        false => Err(outside()),
    }
}

/// The data of all buffers.
pub(super) struct Buffers<'a>(Vec<Option<Cow<'a, [u8]>>>);

impl<'a> Buffers<'a> {
    /// Finds the buffers in the binary chunk, in data URIs and in the contents of [`companions`].
    pub(super) fn new(root: &Root, chunk: Option<&'a [u8]>, files: &[&'a [u8]]) -> Result<Self, Located> {
        let names = companions(root)?;
        let mut buffers = Vec::with_capacity(root.buffers.len());
        for (number, buffer) in root.buffers.iter().enumerate() {
            let at = |fault: Fault| fault.in_part("buffer", number);
            buffers.push(match buffer.uri.as_deref() {
                None if number == 0 => chunk.map(Cow::from),
                None => None,
                Some(uri) if is_data(uri) => Some(decoded(uri).map_err(at)?.into()),
                Some(uri) => {
                    let name = local_name(uri).map_err(at)?;
                    let place = names.iter().position(|known| *known == name);
                    place.and_then(|place| files.get(place)).map(|file| Cow::from(*file))
                }
            });
        }
        Ok(Self(buffers))
    }

    /// The bytes of a view and its stride.
    pub(super) fn view(&self, root: &Root, index: Index) -> Result<(&[u8], Option<usize>), Located> {
        let at = |fault: Fault| fault.in_part("buffer view", index);
        let (views, buffers) = (&root.buffer_views, &self.0);
        let view = views.get(index).ok_or_else(|| missing("buffer view", index, views.len()))?;
        let buffer = view.buffer;
        let slot = buffers.get(buffer).ok_or_else(|| missing("buffer", buffer, buffers.len()))?;
        let bytes = slot.as_deref().ok_or_else(|| {
            let what = format!("buffer {buffer} has no data, as in compressed files");
            at(Fault::unsupported(what, "export it without compression"))
        })?;
        let start = view.byte_offset.unwrap_or(0);
        let end = start.checked_add(view.byte_length);
        let range = end.and_then(|end| Some(usize::try_from(start).ok()?..usize::try_from(end).ok()?));
        let data = range.and_then(|range| bytes.get(range)).ok_or_else(|| {
            let items = format!("bytes in buffer {buffer}");
            at(Fault::truncated(items, end.unwrap_or(u64::MAX), bytes.len() as u64))
        })?;
        Ok((data, view.byte_stride.filter(|stride| *stride > 0)))
    }
}

/// The fault that a part of the file refers to another that does not exist.
pub(super) fn missing(kind: &'static str, number: usize, count: usize) -> Located {
    Fault::syntax("the number of a part that exists", format!("{kind} {number} of {count}")).whole()
}

/// The data in a data URI.
fn decoded(uri: &str) -> Result<Vec<u8>, Fault> {
    let wrong = |found: String| Fault::syntax("a data URI in base64", found);
    let (head, data) = uri.split_once(',').ok_or_else(|| wrong(excerpt(uri.as_bytes())))?;
    if !head.to_ascii_lowercase().ends_with(";base64") {
        return Err(wrong(excerpt(head.as_bytes())));
    }
    STANDARD.decode(data.trim()).map_err(|fault| wrong(fault.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_is_only_looked_for_below_the_folder_of_the_file() {
        for (uri, name) in [("cat.bin", "cat.bin"), ("a%20b/c.bin", "a b/c.bin"), ("%C3%A9.bin", "é.bin")] {
            assert_eq!(local_name(uri).unwrap(), name);
        }
        for uri in [
            "../cat.bin",
            "a/../../cat.bin",
            "/etc/passwd",
            "%2e%2e/cat.bin",
            "a%2F..%2F..%2Fb",
            "file:///etc/passwd",
            "https://example.org/a.bin",
            "C:\\a.bin",
            "..\\a.bin",
            "",
            ".",
            "a//b",
            "%zz",
            "%ff",
            "a%00b",
        ] {
            assert!(matches!(local_name(uri), Err(Fault::Unsupported { .. })), "{uri}");
        }
    }

    #[test]
    fn data_uris_are_decoded() {
        assert_eq!(decoded("data:application/octet-stream;base64,AAEC/w==").unwrap(), [0, 1, 2, 255]);
        assert!(decoded("DATA:;BASE64,").unwrap().is_empty());
        for uri in ["data:", "data:text/plain,abc", "data:;base64,A", "data:;base64,?"] {
            assert!(decoded(uri).is_err(), "{uri}");
        }
    }
}
