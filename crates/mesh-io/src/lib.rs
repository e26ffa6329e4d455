//! Mesh files: OFF, OBJ, PLY, STL, MATLAB `.mat`, TOSCA's `.vert`/`.tri` pairs, glTF, GLB and 3MF. Point clouds: the same
//! without faces, XYZ and PTS.
//!
//! The extension determines the format, in upper or lower case; [`FORMATS`] is the table of them. Any file may be
//! compressed, as `cat.obj.gz`. Vertices keep the order of the file, whether a face uses them or not. Polygons are
//! triangulated in their plane, convex or not. A file of vertices without faces is a point cloud. Other content is
//! ignored. A file that cannot be read faithfully is a [`MeshError`] that names the file, the place, the fault and a remedy. Readers never panic and reserve no more memory than the size of the file
//! justifies.
//!
//! A file of several meshes, as glTF and 3MF files are, becomes one mesh: the vertices of all instances, one after the
//! other, moved as the file says. [`read_file`] also tells the unit of length and what was ignored.

mod binary;
mod facts;
mod field;
mod formats;
mod gzip;
mod limits;
mod located;
mod name;
mod polygons;
mod single;
mod source;
mod text;

use std::borrow::Cow;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use base::files::Pending;
use flate2::Compression;
use flate2::write::GzEncoder;
use nalgebra::Point3;

use crate::located::At;
use formats::Precision;
use mesh::TriMesh;
use mesh::{Fault, MeshError};
use mesh::{check_finite, check_input};
use source::{CheckStart, Memory, load, load_stream};

pub use facts::{FileFacts, LengthUnit, MeshFile};
pub use field::{ScalarField, VertexField};
pub use formats::{Content, FORMATS, Format, mesh_files, or_list, writable};
pub use gzip::GzipReader;
pub use limits::ReadLimits;
pub use name::{extension, is_gzip, without_extension};
pub use source::{Disk, FileSource, MemoryFile, Opened, inflated_limit};

/// Whether a file name belongs to a mesh, judging by its extension alone.
///
/// `.vert` stands for a `.vert`/`.tri` pair and `.tri` is not a mesh path, so that each shape of a folder
/// counts once.
#[must_use]
pub fn is_mesh_path(path: &Path) -> bool {
    Format::of(path).is_ok_and(|format| format.extensions[0] == extension(path))
}

/// The files that [`read()`] opens for this name: two for a `.vert`/`.tri` pair, whichever half is named, and those that
/// a `.gltf` file names.
#[must_use]
pub fn files_of(path: &Path) -> Vec<PathBuf> {
    files_in(path, &Disk)
}

/// As [`files_of`], in any place that holds files.
#[must_use]
pub fn files_in(path: &Path, source: &dyn FileSource) -> Vec<PathBuf> {
    let Ok(format) = Format::of(path) else { return vec![path.to_owned()] };
    let mut files = format.files(path, source);
    // A file that cannot be read is reported when it is.
    if let Some(companions) = format.companions
        && let Ok(content) = load(source, path, format.check_start)
    {
        let names = companions(&content).unwrap_or_default();
        files.extend(names.iter().map(|name| path.with_file_name(name)));
    }
    files
}

/// Reads a mesh; a `.vert`/`.tri` pair by either name.
///
/// # Errors
/// [`MeshError::Io`] if a file cannot be opened, [`MeshError::File`] if it is neither a mesh nor a point cloud
/// ([`Fault`] lists what can be wrong with it), [`MeshError::UnknownFormat`] if the extension is unknown.
///
/// ```
/// use canonform_mesh_io as io;
/// use mesh::shapes;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("ball.ply");
/// io::write(&path, &shapes::icosphere(2))?;
/// let ball = io::read(&path)?;
/// assert_eq!((ball.n_vertices(), ball.n_faces()), (162, 320));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(path: &Path) -> Result<TriMesh, MeshError> {
    Ok(read_file(path, &Disk, &ReadLimits::default())?.mesh)
}

/// Reads a mesh no larger than `limits` from any place that holds files, with what else its file says: the unit of length, the
/// scalar field of a PLY file, such as one by [`write_scalar_field`], and what was ignored.
///
/// # Errors
/// As [`read()`]; [`Fault::OverLimit`] beyond `limits`.
pub fn read_file(path: &Path, source: &dyn FileSource, limits: &ReadLimits) -> Result<MeshFile, MeshError> {
    let format = Format::of(path)?;
    let mut paths = format.files(path, source);
    let open = |file: &PathBuf, check: CheckStart| {
        if file != path && !source.holds(file) {
            let partner = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let fault = match format.companions {
                Some(_) => Fault::unsupported(
                    format!("its data is in {partner}, which is missing"),
                    "put both files into the same folder",
                ),
                None => Fault::unsupported(
                    format!("its other half {partner} is missing"),
                    "put both files of the pair into the same folder",
                ),
            };
            return Err(fault.whole().in_file(path));
        }
        load(source, file, check)
    };
    let loaded = paths.iter().map(|file| open(file, format.check_start));
    let mut contents = loaded.collect::<Result<Vec<Cow<'_, [u8]>>, _>>()?;
    if let (Some(companions), Some(content)) = (format.companions, contents.first()) {
        for name in companions(content).map_err(|fault| fault.in_file(path))? {
            let file = path.with_file_name(name);
            contents.push(open(&file, |_, _| Ok(()))?);
            paths.push(file);
        }
    }
    let contents: Vec<&[u8]> = contents.iter().map(AsRef::as_ref).collect();
    (format.parse)(&contents, limits).map_err(|fault| {
        let file = &paths[fault.file];
        fault.in_file(file)
    })
}

/// Reads a mesh from a stream, such as standard input, to its end. `name` stands for it in messages. Formats of more
/// than one file cannot be read from a stream. A stream that is compressed by gzip is decompressed.
///
/// # Errors
/// As [`read()`]; [`Fault::OverLimit`] beyond `limits`, which bound the bytes of the stream too, and
/// [`Fault::Unsupported`] for a mesh of more than one file.
///
/// ```
/// use std::path::Path;
/// use canonform_mesh_io::{self, Format, ReadLimits};
///
/// let mut stream = &b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"[..];
/// let format = Format::named("off").unwrap();
/// let file = io::read_from(Path::new("standard input"), &mut stream, format, &ReadLimits::default())?;
/// assert_eq!(file.mesh.n_faces(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_from(
    name: &Path,
    stream: &mut dyn Read,
    format: &Format,
    limits: &ReadLimits,
) -> Result<MeshFile, MeshError> {
    let of_several = |what: String| {
        Fault::unsupported(what, "name one of its files, or convert it to PLY or GLB").whole().in_file(name)
    };
    if format.extensions.len() > 1 {
        let what = format!("{} consists of two files and cannot be read from a stream", format.name);
        return Err(of_several(what));
    }
    let bytes = load_stream(name, stream, format.check_start, limits.max_bytes)?;
    let companions = format.companions.map_or(Ok(Vec::new()), |companions| companions(&bytes));
    if let Some(companion) = companions.map_err(|fault| fault.in_file(name))?.first() {
        let what = format!("its data is in another file, `{companion}`, which cannot be read from a stream");
        return Err(of_several(what));
    }
    (format.parse)(&[&bytes], limits).map_err(|fault| fault.in_file(name))
}

/// Reads a mesh from files in memory: one file, or a `.vert`/`.tri` pair in either order. Looks for no other file.
///
/// # Errors
/// As [`read()`], with the same messages; [`Fault::OverLimit`] beyond `limits`, [`MeshError::StrayFile`] if
/// there are more files than a mesh has.
///
/// ```
/// use std::path::Path;
/// use canonform_mesh_io::{self, MemoryFile, ReadLimits};
///
/// let bytes = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n";
/// let file = MemoryFile { name: Path::new("upload.off"), bytes };
/// let error = io::read_memory(&[file], &ReadLimits::of_vertices(1000)).unwrap_err();
/// assert!(error.to_string().starts_with("upload.off, line 6: a face refers to vertex 9"));
/// ```
pub fn read_memory(files: &[MemoryFile<'_>], limits: &ReadLimits) -> Result<TriMesh, MeshError> {
    let nothing = MemoryFile { name: Path::new(""), bytes: &[] };
    let first = files.first().unwrap_or(&nothing);
    let format = Format::of(first.name)?;
    let source = Memory(files);
    // Whether the files of a mesh belong together is checked when they are loaded.
    let most = match format.companions {
        Some(_) => files_in(first.name, &source).len(),
        None => format.extensions.len(),
    };
    if let Some(extra) = files.get(most) {
        let (path, extra) = (first.name.to_owned(), extra.name.to_owned());
        return Err(MeshError::StrayFile { path, extra, supported: mesh_files() });
    }
    Ok(read_file(first.name, &source, limits)?.mesh)
}

/// Writes a file, compressed if its name says so. It appears once it is published.
fn pending(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<Pending<'_>, base::files::FileError> {
    Pending::write(path, |out| match is_gzip(path) {
        false => content(out),
        true => {
            let mut compressed = GzEncoder::new(out, Compression::default());
            content(&mut compressed)?;
            compressed.finish().map(drop)
        }
    })
}

/// Writes a mesh in the format of the extension; the file appears complete or not at all.
///
/// OFF, OBJ, PLY, 3MF and the `.vert`/`.tri` pair (both files under either name) read back bit for bit. STL and GLB round
/// coordinates to 32 bits, and STL has no vertex numbers. GLB moves a mesh that would collapse to the origin and states
/// its place. A name that ends in `.gz` makes a compressed file.
///
/// # Errors
/// [`MeshError::Io`] if the file cannot be written, [`MeshError::UnknownFormat`] for an unknown extension, and
/// [`MeshError::Unusable`] for a format that is only read and for a mesh that the file could not hold.
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

/// Refuses coordinates that 32 bits cannot hold, and a surface whose faces they make points or lines.
fn check_single_precision(mesh: &TriMesh, moved: bool, format: &Format) -> Result<(), MeshError> {
    let unusable = |what: String, remedy: &str| {
        let name = format.name;
        Err(MeshError::Unusable(format!(
            "{what} the 32-bit floats of {name}; {remedy} or use another format"
        )))
    };
    let overflows = |x: &&f64| !(**x as f32).is_finite();
    for (vertex, p) in mesh.positions.iter().enumerate() {
        if let Some(&value) = p.iter().find(overflows) {
            let what = format!("vertex {vertex} has the coordinate {value:e}, beyond");
            return unusable(what, "scale the mesh down");
        }
    }
    let origin = if moved { single::origin(mesh) } else { Point3::origin() };
    match single::merged_face(mesh, &origin) {
        None => Ok(()),
        Some(face) => unusable(format!("corners of face {face} coincide in"), "move the mesh to the origin"),
    }
}

/// Writes a mesh with a scalar field: as PLY with the property [`VertexField::name`] (double) and the colours
/// `red green blue`; as OFF and OBJ with the colours alone.
///
/// # Errors
/// As [`write()`]; [`MeshError::Unusable`] also for another extension and for a field that the file cannot hold.
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
/// [`MeshError::Unusable`] for another one and if a coordinate is not finite.
pub fn write_polylines(path: &Path, lines: &[Vec<Point3<f64>>]) -> Result<(), MeshError> {
    let format = Format::for_writing(path, Content::Lines)?;
    check_finite(lines.iter().flatten())?;
    Ok(pending(path, |out| format.write_lines.map_or(Ok(()), |write| write(out, lines)))?.publish()?)
}
