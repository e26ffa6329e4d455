//! The zip archive of a 3MF file and its parts.

use std::io::{Cursor, Read};

use quick_xml::events::Event;
use quick_xml::reader::Reader;
use zip::ZipArchive;
use zip::result::ZipError;

use super::model::{attributes, find_local};
use crate::name::referred;
use crate::prelude::*;
use crate::source::inflated_limit;

/// Where relationships say which part is the model.
const RELATIONSHIPS: &str = "_rels/.rels";
/// How the type of that relationship ends.
const MODEL_TYPE: &str = "/3dmodel";
/// The usual name of that part.
const USUAL: &str = "3D/3dmodel.model";

/// Checks that a file begins like a zip archive.
pub(crate) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    match start {
        [b'P', b'K', 3 | 5, ..] => Ok(()),
        [0xd0, 0xcf, 0x11, 0xe0, ..] => {
            let what = "this file is protected by a password";
            Err(Fault::unsupported(what, "save it without protection").whole())
        }
        _ => Err(other_format("a 3MF file, which is a zip archive", start).whole()),
    }
}

/// The parts of a file.
pub(super) struct Package<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    /// Bytes that may still be decompressed, and how many they were at first.
    budget: u64,
    limit: u64,
}

impl<'a> Package<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, Located> {
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged).whole()?;
        let limit = inflated_limit(bytes.len() as u64);
        Ok(Self { archive, budget: limit, limit })
    }

    /// The name of the part that holds the build.
    pub(super) fn root(&mut self) -> Result<String, Located> {
        let stated = match self.find(RELATIONSHIPS) {
            Some(_) => target(&self.read(RELATIONSHIPS)?),
            None => None,
        };
        let name = stated.unwrap_or_else(|| USUAL.to_owned());
        match self.find(&name) {
            Some(_) => Ok(name),
            None => Err(Fault::wrong_format("a 3MF file", format!("a zip archive without {name}")).whole()),
        }
    }

    /// Number of a part.
    fn find(&self, name: &str) -> Option<usize> {
        self.archive.index_for_name(name).or_else(|| {
            let (name, mut names) = (canonical(name), self.archive.file_names());
            names.position(|other| other.is_ok_and(|other| canonical(&other) == name))
        })
    }

    /// The content of a part.
    pub(super) fn read(&mut self, name: &str) -> Result<Vec<u8>, Located> {
        let Some(number) = self.find(name) else {
            let found = format!("no part {name}");
            return Err(Fault::syntax("all parts that the file refers to", found).whole());
        };
        let mut read = || {
            let mut content = Vec::new();
            let part = self.archive.by_index(number).map_err(damaged)?;
            part.take(self.budget.saturating_add(1))
                .read_to_end(&mut content)
                .map_err(|fault| Fault::syntax("compressed data", fault))?;
            let left = self.budget.checked_sub(content.len() as u64);
            self.budget = left.ok_or_else(|| Fault::decompression_bomb(self.limit))?;
            Ok(content)
        };
        read().whole().map_err(|fault| fault.of_member(name))
    }
}

/// A name as parts are told apart by: absolute, without escapes, and in lower case.
pub(super) fn canonical(name: &str) -> String {
    let name = referred(name).unwrap_or_else(|| name.to_owned());
    name.trim_start_matches('/').to_ascii_lowercase()
}

/// The target of the relationship to the model.
fn target(relationships: &[u8]) -> Option<String> {
    let mut reader = Reader::from_reader(relationships);
    loop {
        let element = match reader.read_event().ok()? {
            Event::Eof => return None,
            Event::Start(element) | Event::Empty(element) => element,
            _ => continue,
        };
        let Ok(attributes) = attributes(&element) else { continue };
        let is_model = find_local(&attributes, "Type").is_some_and(|kind| kind.ends_with(MODEL_TYPE));
        if let Some(target) = find_local(&attributes, "Target").filter(|_| is_model) {
            return Some(target.trim_start_matches('/').to_owned());
        }
    }
}

fn damaged(fault: ZipError) -> Fault {
    match fault {
        ZipError::UnsupportedArchive(_) | ZipError::CompressionMethodNotSupported(_) => {
            Fault::unsupported(fault, "save it again with Deflate compression and without a password")
        }
        other => Fault::syntax("an intact zip archive", other),
    }
}
