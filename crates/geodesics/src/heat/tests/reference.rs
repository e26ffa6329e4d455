//! Beside exact polyhedral distances on real meshes. The data is not part of the project:
//! `CANONFORM_DATA` says where it is, and without it this test says so and passes.

use std::path::{Path, PathBuf};

use mesh::io;

use super::{heat, surface};
use crate::DistanceSolver;
use mesh::VertexId;

fn data() -> Option<PathBuf> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let path = std::env::var_os("CANONFORM_DATA").map_or_else(default, PathBuf::from);
    if !path.join("exact").is_dir() {
        println!("skipped: no exact distances in {}", path.display());
        return None;
    }
    Some(path)
}

/// The numbers of a one- or two-dimensional `.npy` file, `N` bytes each.
fn numbers<const N: usize, T>(path: &Path, read: fn([u8; N]) -> T) -> Vec<T> {
    let bytes = std::fs::read(path).unwrap();
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    bytes[header..].as_chunks().0.iter().map(|chunk| read(*chunk)).collect()
}

#[test]
fn errors_beside_exact_distances_are_no_larger_than_those_of_geometry_central() {
    let Some(data) = data() else { return };
    // Mean and largest relative error of potpourri3d 1.4 on the same sources.
    for (name, mesh, mean, largest) in [
        ("cat0", "tosca-lowres/cat0.vert", 0.0214, 0.460),
        ("cat1", "tosca-lowres/cat1.vert", 0.0202, 0.387),
        ("horse0", "tosca-lowres/horse0.vert", 0.0193, 0.596),
        ("wolf0", "tosca-lowres/wolf0.vert", 0.0186, 0.285),
        ("wolf1", "tosca-lowres/wolf1.vert", 0.0189, 0.414),
        ("spot", "single/spot.obj", 0.0212, 0.405),
        ("rocker-arm", "single/rocker-arm.obj", 0.0176, 0.378),
        ("armadillo", "single/armadillo.obj", 0.0091, 0.368),
    ] {
        let method = heat(&surface(&io::read(&data.join(mesh)).unwrap()));
        let sources = numbers(&data.join(format!("exact/{name}-sources.npy")), u32::from_le_bytes);
        let exact = numbers(&data.join(format!("exact/{name}-distances.npy")), f64::from_le_bytes);
        let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0);
        for (source, exact) in sources.iter().zip(exact.chunks_exact(method.n_vertices())) {
            for (found, exact) in method.distances(VertexId(*source)).iter().zip(exact) {
                if *exact > 0.0 && exact.is_finite() {
                    let error = (found - exact).abs() / exact;
                    sum += error;
                    worst = worst.max(error);
                    count += 1;
                }
            }
        }
        let found = sum / f64::from(count);
        assert!(found <= mean && worst <= largest, "{name}: mean {found}, largest {worst}");
    }
}
