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
mod file;
mod formats;
mod located;
mod name;
mod polygons;
mod prelude;
mod single;
mod source;
mod text;
mod write;

use std::io::Read;
use std::path::{Path, PathBuf};

use located::At;
use mesh::{Fault, MeshError, TriMesh};
use source::{Check, Memory};

pub use file::{FileFacts, LengthUnit, MeshFile, ReadLimits, ScalarField, VertexField};
pub use formats::{Content, FORMATS, Format, mesh_files, or_list, writable};
pub use name::{extension, is_gzip, referred, without_extension};
pub use source::{Disk, FileSource, GzipReader, MemoryFile, Opened, inflated_limit};
pub use write::{write, write_polylines, write_scalar_field};

/// Whether a file name belongs to a mesh, judging by its extension alone.
///
/// `.vert` stands for a `.vert`/`.tri` pair and `.tri` is not a mesh path, so that each shape of a folder
/// counts once.
pub fn is_mesh_path(path: &Path) -> bool {
    Format::of(path).is_ok_and(|format| format.extensions[0] == extension(path))
}

/// The files that [`read()`] opens for this name: two for a `.vert`/`.tri` pair, whichever half is named, and those that
/// a `.gltf` file names.
pub fn files_of(path: &Path) -> Vec<PathBuf> {
    files_in(path, &Disk)
}

/// As [`files_of`], in any place that holds files.
pub fn files_in(path: &Path, source: &dyn FileSource) -> Vec<PathBuf> {
    let Ok(format) = Format::of(path) else { return vec![path.to_owned()] };
    let mut files = format.files(path, source);
    // A file that cannot be read is reported when it is.
    if let Some(companions) = format.companions
        && let Ok(content) = load(source, path, &|start, size| format.check(start, size))
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
    let format = Format::of(path).or_else(|unknown| {
        // That a file is missing is told first.
        source.open(path)?;
        Err(unknown)
    })?;
    read_files(format, format.files(path, source), limits, |file, check| {
        if file == path || source.holds(file) {
            return load(source, file, check);
        }
        let partner = file.file_name().unwrap_or_default().to_string_lossy();
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
        Err(fault.whole().in_file(path))
    })
}

/// Opens the files of a mesh, and those that the first one refers to, and parses them together.
fn read_files(
    format: &Format,
    mut paths: Vec<PathBuf>,
    limits: &ReadLimits,
    mut open: impl FnMut(&Path, Check<'_>) -> Result<Vec<u8>, MeshError>,
) -> Result<MeshFile, MeshError> {
    let check: Check<'_> = &|start, size| format.check(start, size);
    let opened = paths.iter().map(|file| open(file, check));
    let mut contents = opened.collect::<Result<Vec<_>, _>>()?;
    if let Some(companions) = format.companions {
        for name in companions(&contents[0]).map_err(|fault| fault.in_file(&paths[0]))? {
            let file = paths[0].with_file_name(name);
            contents.push(open(&file, &|_, _| Ok(()))?);
            paths.push(file);
        }
    }
    let contents: Vec<&[u8]> = contents.iter().map(Vec::as_slice).collect();
    (format.parse)(&contents, limits).map_err(|fault| {
        let file = &paths[fault.file];
        fault.in_file(file)
    })
}

fn load(source: &dyn FileSource, path: &Path, check: Check<'_>) -> Result<Vec<u8>, MeshError> {
    source.open(path)?.load(path, is_gzip(path), check, u64::MAX)
}

/// Reads a mesh from a stream, such as standard input, to its end. `name` stands for it in messages. Formats of more
/// than one file cannot be read from a stream. A stream that is compressed by gzip is decompressed.
///
/// # Errors
/// As [`read()`]; [`Fault::OverLimit`] beyond `limits`, which bound the bytes of the stream too, and
/// a fault for a mesh of more than one file.
///
/// ```
/// use std::path::Path;
/// use canonform_mesh_io::{Format, ReadLimits, read_from};
///
/// let mut stream = &b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"[..];
/// let format = Format::named("off").unwrap();
/// let file = read_from(Path::new("standard input"), &mut stream, format, &ReadLimits::default())?;
/// assert_eq!(file.mesh.n_faces(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_from(
    name: &Path,
    stream: &mut dyn Read,
    format: &Format,
    limits: &ReadLimits,
) -> Result<MeshFile, MeshError> {
    let mut stream = Some(stream);
    read_files(format, vec![name.to_owned(); format.extensions.len()], limits, |_, check| {
        match stream.take().filter(|_| format.extensions.len() == 1) {
            Some(stream) => {
                let (opened, is_gzip) = Opened::sniffed(name, stream)?;
                opened.load(name, is_gzip, check, limits.max_bytes)
            }
            None => {
                let what = "this mesh has several files, and a stream holds one";
                Err(Fault::unsupported(what, "name one of its files, or convert it to PLY or GLB")
                    .whole()
                    .in_file(name))
            }
        }
    })
}

/// Reads a mesh from files in memory: one file, or a `.vert`/`.tri` pair in either order. Looks for no other file.
///
/// # Errors
/// As [`read()`], with the same messages; [`Fault::OverLimit`] beyond `limits`, [`MeshError::StrayFile`] if
/// there are more files than a mesh has.
///
/// ```
/// use std::path::Path;
/// use canonform_mesh_io::{MemoryFile, ReadLimits, read_memory};
///
/// let bytes = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n";
/// let file = MemoryFile { name: Path::new("upload.off"), bytes };
/// let error = read_memory(&[file], &ReadLimits::of_vertices(1000)).unwrap_err();
/// assert!(error.to_string().starts_with("upload.off, line 6: a face refers to vertex 9"));
/// ```
pub fn read_memory(files: &[MemoryFile<'_>], limits: &ReadLimits) -> Result<TriMesh, MeshError> {
    let nothing = MemoryFile { name: Path::new(""), bytes: &[] };
    let first = files.first().unwrap_or(&nothing);
    Format::of(first.name)?;
    let source = Memory(files);
    // Whether the files of a mesh belong together is checked when they are loaded.
    if let Some(extra) = files.get(files_in(first.name, &source).len()) {
        let (path, extra) = (first.name.to_owned(), extra.name.to_owned());
        return Err(MeshError::StrayFile { path, extra, supported: mesh_files() });
    }
    Ok(read_file(first.name, &source, limits)?.mesh)
}
