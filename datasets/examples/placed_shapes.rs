//! Writes shapes whose true correspondence is known (`bench/maps.py`).
//!
//! ```text
//! cargo run --release -p canonform-datasets --example placed_shapes -- FOLDER VERTICES POSES [MESH...]
//! ```
//!
//! Writes to `FOLDER` the first poses of a built-in man, `davidN.off`, with their vertices at rest, `davidN-rest.off`, and every
//! mesh with about as many vertices and triangles of its own under its name.

use std::error::Error;
use std::path::Path;

use canonform_datasets::{ArticulatedOptions, Damage, Family, articulated_at_rest};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, folder, n_vertices, poses, meshes @ ..] = &arguments[..] else {
        return Err("usage: placed_shapes FOLDER VERTICES POSES [MESH...]".into());
    };
    let (folder, n_vertices) = (Path::new(folder), n_vertices.parse()?);
    std::fs::create_dir_all(folder)?;
    let options = ArticulatedOptions { n_vertices, ..ArticulatedOptions::default() };
    for pose in 0..poses.parse()? {
        let made = articulated_at_rest(Family::David, 0, pose, &options, &())?;
        mesh_io::write(&folder.join(format!("{}.off", made.shape.name)), &made.shape.mesh)?;
        mesh_io::write(&folder.join(format!("{}-rest.off", made.shape.name)), &made.rest)?;
    }
    for (seed, path) in meshes.iter().enumerate() {
        let mesh = mesh_io::read(Path::new(path))?;
        let share = n_vertices as f64 / mesh.n_vertices() as f64;
        let name = Path::new(path).file_stem().ok_or("a mesh has a name")?;
        let own = Damage::Sample(share.min(1.0)).apply(&mesh, seed as u64);
        mesh_io::write(&folder.join(name).with_extension("off"), &own)?;
    }
    Ok(())
}
