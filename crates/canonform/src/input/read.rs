//! From a file to a surface.

use std::path::Path;
use std::time::Instant;

use base::Observer;
use collection::read_mesh_file;
use mesh::{RepairOptions, Surface};
use mesh_io::ReadLimits;

use crate::error::Error;

/// Reads and repairs a mesh file.
///
/// ```
/// use canonform::{mesh, read_surface};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("ball.off");
/// mesh::io::write(&path, &mesh::shapes::icosphere(2))?;
/// let surface = read_surface(&path, &Default::default(), &Default::default(), &())?;
/// assert_eq!(surface.mesh().n_vertices(), 162);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] and [`Error::Exceeded`].
pub fn read_surface(
    path: &Path,
    options: &RepairOptions,
    limits: &ReadLimits,
    observer: &dyn Observer,
) -> Result<Surface, Error> {
    let start = Instant::now();
    let mesh = read_mesh_file(path, limits)?.mesh;
    let load_seconds = start.elapsed().as_secs_f64();
    let mut surface = Surface::new(&mesh, options, observer)?;
    surface.input.load_seconds = load_seconds;
    Ok(surface)
}
