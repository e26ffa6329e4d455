//! The mesh formats, one module each, and the table of their names, extensions and abilities.

mod gltf;
mod mat;
mod obj;
mod off;
mod ply;
mod stl;
mod threemf;
mod tosca;
mod xyz;

use std::path::{Path, PathBuf};

use mesh::MeshError;

use crate::name::{extension, inflated, is_gzip, with_extension};
use crate::prelude::*;
use crate::source::FileSource;

/// What a mesh file can be written with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// Vertices and faces.
    Mesh,
    /// Vertices, faces, and a value and a color per vertex.
    Field,
    /// Polylines.
    Lines,
}

impl Content {
    fn name(self) -> &'static str {
        match self {
            Self::Mesh => "a mesh",
            Self::Field => "a value per vertex",
            Self::Lines => "lines",
        }
    }
}

type CheckStart = fn(&[u8], Option<u64>) -> Result<(), Located>;
type Parse = fn(&[&[u8]], &ReadLimits) -> Result<MeshFile, Located>;
type Companions = fn(&[u8]) -> Result<Vec<String>, Located>;
type WriteMesh = fn(&mut dyn Write, &TriMesh, Field<'_>) -> io::Result<()>;
type WriteLines = fn(&mut dyn Write, &[Vec<Point3<f64>>]) -> io::Result<()>;

/// A mesh file format; [`FORMATS`] lists them.
#[derive(Debug)]
pub struct Format {
    /// The name used in messages.
    pub name: &'static str,
    /// The extensions of the files that together hold one mesh, lower case, without a dot. Where there are
    /// two, the first one stands for the pair.
    pub extensions: &'static [&'static str],
    pub(crate) precision: Precision,
    /// Checks the start of each file.
    check_start: CheckStart,
    /// Names, relative to the file, of further files that its content refers to.
    pub(crate) companions: Option<Companions>,
    /// Parses the contents of [`files`](Self::files), followed by those of its companions.
    pub(crate) parse: Parse,
    /// Writers of the files, in the order of `extensions`; empty if the format is read-only.
    pub(crate) write: &'static [WriteMesh],
    /// Whether the writers can add a field.
    has_fields: bool,
    pub(crate) write_lines: Option<WriteLines>,
}

/// How a format stores coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Precision {
    /// Rounded to 32 bits, perhaps after moving the mesh to its [origin](crate::single::origin).
    Single { moved: bool },
    /// Such that 64-bit numbers read back bit for bit.
    Double,
}

/// All formats that can be read.
pub static FORMATS: [Format; 11] = [
    Format {
        write: &[off::write],
        has_fields: true,
        ..read_only("OFF", &["off"], off::check_start, off::parse)
    },
    Format {
        write: &[obj::write],
        has_fields: true,
        write_lines: Some(obj::write_lines),
        ..read_only("OBJ", &["obj"], |start, _| check_is_text(start, "an OBJ file"), obj::parse)
    },
    Format {
        write: &[ply::write],
        has_fields: true,
        write_lines: Some(ply::write_lines),
        ..read_only("PLY", &["ply"], ply::check_start, ply::parse)
    },
    Format {
        precision: Precision::Single { moved: false },
        write: &[stl::write],
        ..read_only("STL", &["stl"], stl::check_start, stl::parse)
    },
    read_only("MATLAB", &["mat"], mat::check_start, mat::parse),
    Format {
        write: &[tosca::write_positions, tosca::write_faces],
        ..read_only(
            "TOSCA",
            &["vert", "tri"],
            |start, _| check_is_text(start, "a file of numbers"),
            tosca::parse,
        )
    },
    Format {
        precision: Precision::Single { moved: true },
        companions: Some(gltf::companions),
        write: &[gltf::write],
        ..read_only("GLB", &["glb"], gltf::check_binary_start, gltf::parse)
    },
    Format {
        companions: Some(gltf::companions),
        ..read_only("glTF", &["gltf"], gltf::check_start, gltf::parse)
    },
    Format { write: &[threemf::write], ..read_only("3MF", &["3mf"], threemf::check_start, threemf::parse) },
    read_only("XYZ", &["xyz"], |start, _| check_is_text(start, "a file of points"), xyz::parse),
    read_only("PTS", &["pts"], |start, _| check_is_text(start, "a file of points"), xyz::parse),
];

/// A format with 64-bit coordinates that cannot be written.
const fn read_only(
    name: &'static str,
    extensions: &'static [&'static str],
    check_start: CheckStart,
    parse: Parse,
) -> Format {
    let precision = Precision::Double;
    Format {
        name,
        extensions,
        precision,
        check_start,
        companions: None,
        parse,
        write: &[],
        has_fields: false,
        write_lines: None,
    }
}

impl Format {
    /// The format that the extension of a file name stands for, in upper or lower case.
    ///
    /// # Errors
    /// [`MeshError::UnknownFormat`].
    pub fn of(path: &Path) -> Result<&'static Self, MeshError> {
        let extension = match extension(path) {
            none if none.is_empty() && is_gzip(path) => "gz".to_owned(),
            extension => extension,
        };
        Self::named(&extension).ok_or_else(|| MeshError::UnknownFormat {
            path: path.to_path_buf(),
            extension,
            supported: or_list(FORMATS.iter().map(|format| format.extensions[0])),
        })
    }

    /// The format with this extension, in upper or lower case, without a dot.
    pub fn named(extension: &str) -> Option<&'static Self> {
        let extension = extension.to_ascii_lowercase();
        FORMATS.iter().find(|format| format.extensions.contains(&extension.as_str()))
    }

    /// Checks the first bytes of a file, given its size if that is known.
    pub(crate) fn check(&self, start: &[u8], size: Option<u64>) -> Result<(), Located> {
        match size == Some(start.len() as u64) && start.trim_ascii().is_empty() {
            true => Err(Fault::Empty.whole()),
            false => (self.check_start)(start, size),
        }
    }

    /// Whether files of this format can be written with this content.
    pub fn can_write(&self, content: Content) -> bool {
        match content {
            Content::Mesh => !self.write.is_empty(),
            Content::Field => self.has_fields,
            Content::Lines => self.write_lines.is_some(),
        }
    }

    /// The format of a file to be written with this content.
    pub(crate) fn for_writing(path: &Path, content: Content) -> Result<&'static Self, MeshError> {
        let format = Self::of(path)?;
        match format.can_write(content) {
            true => Ok(format),
            false => Err(MeshError::NotWritable {
                path: path.to_owned(),
                format: format.name,
                content: content.name(),
                supported: or_list(writable(content)),
            }),
        }
    }

    /// The files of the mesh that `path` names, in the order of `extensions`.
    ///
    /// The extension of a companion file has the case of the given one, unless only the other one exists.
    pub(crate) fn files(&self, path: &Path, source: &dyn FileSource) -> Vec<PathBuf> {
        let given = inflated(path).extension().unwrap_or_default().to_string_lossy().into_owned();
        let prefers_upper = given.chars().all(|c| c.is_ascii_uppercase());
        let file = |extension: &&str| {
            if given.eq_ignore_ascii_case(extension) {
                return path.to_owned();
            }
            let mut cases = [extension.to_string(), extension.to_ascii_uppercase()];
            if prefers_upper {
                cases.reverse();
            }
            let [preferred, other] = cases.map(|extension| with_extension(path, &extension));
            if source.holds(&other) && !source.holds(&preferred) { other } else { preferred }
        };
        self.extensions.iter().map(file).collect()
    }
}

/// Extensions of the formats that can be written with this content, in the order of [`FORMATS`].
pub fn writable(content: Content) -> impl Iterator<Item = &'static str> {
    FORMATS.iter().filter(move |format| format.can_write(content)).map(|format| format.extensions[0])
}

/// Extensions as a phrase, such as `.npy, .csv or .ply`.
pub fn or_list<'a>(extensions: impl IntoIterator<Item = &'a str>) -> String {
    let dotted: Vec<String> = extensions.into_iter().map(|extension| format!(".{extension}")).collect();
    match dotted.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => dotted.concat(),
    }
}

/// The files of one mesh, as a phrase: `a .off, ... or .mat file, or a .vert with its .tri`.
pub fn mesh_files() -> String {
    let (single, paired): (Vec<&Format>, Vec<&Format>) =
        FORMATS.iter().partition(|format| format.extensions.len() == 1);
    let paired = paired.iter().map(|format| format!(", or a .{}", format.extensions.join(" with its .")));
    let single = or_list(single.iter().map(|format| format.extensions[0]));
    format!("a {single} file{}", paired.collect::<String>())
}
