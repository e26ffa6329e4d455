//! Writing files, complete or not at all.

use std::io::{self, Write};
use std::path::Path;

use base::files::{FileError, Pending};
use flate2::Compression;
use flate2::write::GzEncoder;
use mesh::{MeshError, TriMesh, check_finite, check_input};
use nalgebra::Point3;

use crate::file::VertexField;
use crate::formats::{Content, Format, Precision};
use crate::name::is_gzip;
use crate::single::{merged_face, origin};
use crate::source::Disk;

/// Writes a mesh in the format of the extension; the file appears complete or not at all.
///
/// OFF, OBJ, PLY, 3MF and the `.vert`/`.tri` pair (both files under either name) read back bit for bit. STL and GLB round
/// coordinates to 32 bits, and STL has no vertex numbers. GLB moves a mesh that would collapse to the origin and states
/// its place. A name that ends in `.gz` makes a compressed file.
///
/// # Errors
/// [`MeshError::Io`] if the file cannot be written, [`MeshError::UnknownFormat`] for an unknown extension, and
/// [`MeshError::NotWritable`] for a format that is only read; those of [`check_input`], [`MeshError::BeyondSinglePrecision`] and
/// [`MeshError::CollapsedFace`] for a mesh that the file could not hold.
pub fn write(path: &Path, mesh: &TriMesh) -> Result<(), MeshError> {
    let format = Format::for_writing(path, Content::Mesh)?;
    // What `read` would refuse.
    check_input(mesh)?;
    if let Precision::Single { moved } = format.precision {
        check_single_precision(mesh, moved, format)?;
    }
    let paths = format.files(path, &Disk);
    let written =
        paths.iter().zip(format.write).map(|(path, write)| pending(path, |out| write(out, mesh, None)));
    let pending = written.collect::<Result<Vec<_>, _>>()?;
    Ok(pending.into_iter().try_for_each(Pending::publish)?)
}

/// Writes a mesh with a scalar field: as PLY with the property [`VertexField::name`] (double) and the colors
/// `red green blue`; as OFF and OBJ with the colors alone.
///
/// # Errors
/// As [`write()`]; [`MeshError::FieldLength`] and [`MeshError::FieldName`].
pub fn write_scalar_field(path: &Path, mesh: &TriMesh, field: &VertexField<'_>) -> Result<(), MeshError> {
    let format = Format::for_writing(path, Content::Field)?;
    field.check(mesh.n_vertices())?;
    check_input(mesh)?;
    Ok(pending(path, |out| format.write.iter().try_for_each(|write| write(out, mesh, Some(field))))?
        .publish()?)
}

/// Writes polylines as OBJ, or as PLY with an element `edge` per segment.
///
/// # Errors
/// [`MeshError::Io`] if the file cannot be written, [`MeshError::UnknownFormat`] for an unknown extension, and
/// [`MeshError::NotWritable`] for another one, [`MeshError::NonFinite`].
pub fn write_polylines(path: &Path, lines: &[Vec<Point3<f64>>]) -> Result<(), MeshError> {
    let format = Format::for_writing(path, Content::Lines)?;
    check_finite(lines.iter().flatten())?;
    Ok(pending(path, |out| format.write_lines.map_or(Ok(()), |write| write(out, lines)))?.publish()?)
}

/// Writes a file, compressed if its name says so. It appears once it is published.
fn pending(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<Pending<'_>, FileError> {
    Pending::write(path, |out| match is_gzip(path) {
        false => content(out),
        true => {
            let mut compressed = GzEncoder::new(out, Compression::default());
            content(&mut compressed)?;
            compressed.finish().map(drop)
        }
    })
}

/// Refuses coordinates that 32 bits cannot hold, and a surface whose faces they make points or lines.
fn check_single_precision(mesh: &TriMesh, moved: bool, format: &Format) -> Result<(), MeshError> {
    let format = format.name;
    let overflows = |x: &&f64| !(**x as f32).is_finite();
    for (vertex, p) in mesh.positions.iter().enumerate() {
        if let Some(&value) = p.iter().find(overflows) {
            return Err(MeshError::BeyondSinglePrecision { vertex, value, format });
        }
    }
    let origin = if moved { origin(mesh) } else { Point3::origin() };
    match merged_face(mesh, &origin) {
        None => Ok(()),
        Some(face) => Err(MeshError::CollapsedFace { face, format }),
    }
}
