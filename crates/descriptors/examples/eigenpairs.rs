//! Computes the smallest eigenpairs of the Laplacian of a mesh, prints the time it took, and writes all matrices, so
//! that other programs can solve the same problem (`bench/eigsh.py`).
//!
//! ```text
//! cargo run --release -p canonform-descriptors --example eigenpairs -- MESH PAIRS FOLDER
//! ```

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use linalg::{GeneralizedEigen, SparseSymmetric, smallest_eigenpairs};
use mesh::{RepairOptions, repair};
use surface::laplacian::Laplacian;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, mesh, pairs, folder] = &arguments[..] else {
        return Err("usage: eigenpairs MESH PAIRS FOLDER".into());
    };
    let surface = repair(&mesh_io::read(Path::new(mesh))?, &RepairOptions::default(), &())?.intrinsic;
    let start = Instant::now();
    let laplacian = Laplacian::new(&surface);
    let masses = laplacian.masses();
    let stiffness = SparseSymmetric::from_entries(laplacian.n_vertices(), laplacian.stiffness_entries());
    let assembly = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let eigen = smallest_eigenpairs(&stiffness, &masses, pairs.parse()?, GeneralizedEigen::ACCURATE, &())?;
    let seconds = start.elapsed().as_secs_f64();

    let folder = Path::new(folder);
    write(&folder.join("rows"), stiffness.entries().map(|(i, _, _)| i as f64))?;
    write(&folder.join("columns"), stiffness.entries().map(|(_, j, _)| j as f64))?;
    write(&folder.join("stiffness"), stiffness.entries().map(|(_, _, value)| value))?;
    write(&folder.join("masses"), masses.iter().copied())?;
    write(&folder.join("values"), eigen.values.iter().copied())?;
    write(&folder.join("vectors"), eigen.vectors.iter().copied())?;
    println!("{{\"n\": {}, \"assembly\": {assembly}, \"seconds\": {seconds}}}", masses.len());
    Ok(())
}

/// Writes numbers as little-endian float64.
fn write(path: &Path, numbers: impl Iterator<Item = f64>) -> Result<(), Box<dyn Error>> {
    let bytes: Vec<u8> = numbers.flat_map(f64::to_le_bytes).collect();
    Ok(std::fs::write(path, bytes)?)
}
