//! Mesh files: OFF, OBJ, PLY, STL, TOSCA's `.vert`/`.tri` pairs and MATLAB `.mat`.
//!
//! The format follows from the extension, in upper or lower case. Vertices keep the order of the
//! file, used by a face or not. Polygons become triangles: quadrilaterals along the better diagonal,
//! larger ones as fans, so concave ones of five corners and more should be cut beforehand.
//! Everything else a file may hold is passed over. What cannot be read faithfully is a [`MeshError`]
//! that names file, place, fault and remedy: readers never panic, and reserve no more than the
//! file's size warrants.

mod assembly;
mod colormap;
mod limits;
mod mat;
#[cfg(test)]
mod mutations;
mod obj;
mod off;
mod ply;
mod polyline;
mod source;
mod stl;
mod text;
mod tosca;

use std::path::{Path, PathBuf};

use files::{Pending, write_atomically};
use nalgebra::Point3;

use crate::TriMesh;
use crate::error::MeshError;
use crate::face_set::check_input;
use source::{Disk, Memory, Source};
use surface::VertexId;

pub use limits::ReadLimits;
pub use source::MemoryFile;

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Off,
    Obj,
    Ply,
    Stl,
    Tosca,
    Mat,
}

impl Format {
    fn of(path: &Path) -> Result<Self, MeshError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        Ok(match extension.as_str() {
            "off" => Self::Off,
            "obj" => Self::Obj,
            "ply" => Self::Ply,
            "stl" => Self::Stl,
            "vert" | "tri" => Self::Tosca,
            "mat" => Self::Mat,
            _ => return Err(MeshError::UnknownFormat { path: path.to_path_buf(), extension }),
        })
    }
}

/// Whether a name is that of a mesh, by its extension alone.
///
/// `.vert` stands for the pair; its other half `.tri` is not a mesh path, so that a folder lists
/// each shape once.
#[must_use]
pub fn is_mesh_path(path: &Path) -> bool {
    let is_second_half = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("tri"));
    Format::of(path).is_ok() && !is_second_half
}

/// The files that [`read()`] looks into for this name: two for a `.vert`/`.tri` pair, whichever half is
/// named.
#[must_use]
pub fn files_of(path: &Path) -> Vec<PathBuf> {
    match Format::of(path) {
        Ok(Format::Tosca) => {
            let pair = tosca::Pair::of(path, &Disk);
            vec![pair.vert, pair.tri]
        }
        _ => vec![path.to_owned()],
    }
}

/// Reads a mesh; of a `.vert`/`.tri` pair either name will do.
///
/// # Errors
/// When the file cannot be opened or is not a mesh of at least one face, see
/// [`Fault`](crate::Fault) for what may be wrong with it; [`MeshError::UnknownFormat`] for a foreign
/// extension.
pub fn read(path: &Path) -> Result<TriMesh, MeshError> {
    parse(path, &Disk, &ReadLimits::default())
}

/// Reads a mesh from files in memory, with the same words about what is wrong with them: one file, or a
/// `.vert`/`.tri` pair in either order. No other file is looked for.
///
/// # Errors
/// As [`read()`]; [`Fault::OverLimit`](crate::Fault::OverLimit) beyond `limits`,
/// [`MeshError::StrayFile`] when there are more files than a mesh has.
pub fn read_memory(files: &[MemoryFile<'_>], limits: &ReadLimits) -> Result<TriMesh, MeshError> {
    let nothing = MemoryFile { name: Path::new(""), bytes: &[] };
    let (first, others) = files.split_first().unwrap_or((&nothing, &[]));
    // Whether the two belong together, the pair itself says.
    let stray = match Format::of(first.name)? {
        Format::Tosca => others.get(1),
        _ => others.first(),
    };
    if let Some(extra) = stray {
        return Err(MeshError::StrayFile { path: first.name.to_owned(), extra: extra.name.to_owned() });
    }
    parse(first.name, &Memory(files), limits)
}

fn parse(path: &Path, source: &dyn Source, limits: &ReadLimits) -> Result<TriMesh, MeshError> {
    let format = Format::of(path)?;
    if format == Format::Tosca {
        return tosca::read(path, source, limits);
    }
    let bytes = source.load(path)?;
    let parsed = match format {
        Format::Off => off::parse(&bytes, limits),
        Format::Obj => obj::parse(&bytes, limits),
        Format::Ply => ply::parse(&bytes, limits),
        Format::Stl => stl::parse(bytes.into_owned(), limits),
        Format::Mat | Format::Tosca => mat::parse(&bytes, limits),
    };
    parsed.map_err(|fault| fault.in_file(path))
}

/// Writes a mesh in the format of the extension; the file is there whole or not at all.
///
/// OFF, OBJ, PLY and the `.vert`/`.tri` pair (written together under either name) read back bit for
/// bit. STL rounds coordinates to 32 bits and knows no vertex numbers.
///
/// # Errors
/// When the file cannot be written, the extension is foreign or `.mat`, a coordinate is not finite
/// or beyond what the format can hold, or a face names a vertex out of range.
pub fn write(path: &Path, mesh: &TriMesh) -> Result<(), MeshError> {
    let format = Format::of(path)?;
    // What `read` would refuse to take back.
    check_input(mesh)?;
    match format {
        Format::Off => Ok(write_atomically(path, |out| off::write(out, mesh))?),
        Format::Obj => Ok(write_atomically(path, |out| obj::write(out, mesh))?),
        Format::Ply => Ok(write_atomically(path, |out| ply::write(out, mesh))?),
        Format::Stl => {
            let triangles = stl::triangles(mesh)?;
            Ok(write_atomically(path, |out| stl::write(out, &triangles))?)
        }
        Format::Tosca => {
            let pair = tosca::Pair::of(path, &Disk);
            let vert = Pending::write(&pair.vert, |out| tosca::write_positions(out, mesh))?;
            let tri = Pending::write(&pair.tri, |out| tosca::write_faces(out, mesh))?;
            vert.publish()?;
            Ok(tri.publish()?)
        }
        Format::Mat => Err(MeshError::ReadOnlyFormat { path: path.to_path_buf(), extension: "mat" }),
    }
}

/// Writes a mesh with a value for each vertex as PLY: the property `name` (double) and colours
/// `red green blue` from dark at the least value to bright at the greatest, grey where the value is
/// NaN or infinite.
///
/// # Errors
/// As [`write()`]; and when `path` does not end in `.ply`, there is not one value per vertex, or PLY
/// cannot carry `name`.
pub fn write_scalar_field(path: &Path, mesh: &TriMesh, values: &[f64], name: &str) -> Result<(), MeshError> {
    if Format::of(path)? != Format::Ply {
        return Err(MeshError::ScalarFieldNotPly { path: path.to_path_buf() });
    }
    if values.len() != mesh.n_vertices() {
        return Err(MeshError::FieldLength { values: values.len(), n_vertices: mesh.n_vertices() });
    }
    let is_word = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_word || ["x", "y", "z", "red", "green", "blue"].contains(&name) {
        return Err(MeshError::FieldName { name: name.into() });
    }
    check_input(mesh)?;
    let color = colormap::colors(values);
    let with_field = |v: usize| (values[v], color(values[v]));
    Ok(write_atomically(path, |out| ply::write_with_field(out, mesh, name, with_field))?)
}

/// Writes lines through points in space as OBJ or PLY (an element `edge` from point to point).
///
/// # Errors
/// When the file cannot be written, the extension is another, or a coordinate is not finite.
pub fn write_polylines(path: &Path, lines: &[Vec<Point3<f64>>]) -> Result<(), MeshError> {
    let is_finite = |p: &Point3<f64>| p.iter().all(|x| x.is_finite());
    if let Some(vertex) = lines.iter().flatten().position(|p| !is_finite(p)) {
        return Err(MeshError::NonFinitePosition { vertex: VertexId::from(vertex) });
    }
    match Format::of(path)? {
        Format::Obj => Ok(write_atomically(path, |out| polyline::write_obj(out, lines))?),
        Format::Ply => Ok(write_atomically(path, |out| polyline::write_ply(out, lines))?),
        _ => Err(MeshError::LinesFormat { path: path.to_path_buf() }),
    }
}
