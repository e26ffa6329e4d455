//! Files that other programs wrote, of one small torus and of two copies of it, one of them moved and mirrored.
//! `tests/foreign/make.py` makes them.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use canonform_mesh_io::{Disk, LengthUnit, MeshFile, ReadLimits, is_mesh_path, read_file};
use mesh::{MeshError, TriMesh, shapes, validate};
use nalgebra::Point3;
use surface::VertexId;

/// The torus, whose vertices `make.py` numbers tube by tube.
fn ring() -> TriMesh {
    let TriMesh { positions, faces } = shapes::torus(8, 5, 2.0, 0.7);
    let number = |v: VertexId| VertexId::from(v.index() % 8 * 5 + v.index() / 8);
    TriMesh {
        positions: (0..40).map(|v| positions[v % 5 * 8 + v / 5]).collect(),
        faces: faces.into_iter().map(|face| face.map(number)).collect(),
    }
}

/// The copy: turned, mirrored, stretched and moved.
fn placed(mesh: &TriMesh) -> TriMesh {
    let positions = mesh.positions.iter().map(|p| Point3::new(p.y + 10.0, p.x, 2.0 * p.z)).collect();
    TriMesh { positions, faces: mesh.faces.iter().map(|[a, b, c]| [*a, *c, *b]).collect() }
}

/// Files that keep the numbers of vertices.
const IN_ORDER: [&str; 7] = [
    "trimesh-ring.off",
    "trimesh-ring.ply",
    "trimesh-ring.glb",
    "trimesh-ring.3mf",
    "meshio-ring.obj",
    "meshlab-ring.3mf",
    "blender-ring.ply",
];

fn n_places(mesh: &TriMesh) -> usize {
    mesh.n_vertices() - validate(mesh).duplicate_vertices
}

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign");
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| is_mesh_path(path));
    files.sort();
    files
}

fn read(path: &Path) -> Result<MeshFile, MeshError> {
    read_file(path, &Disk, &ReadLimits::default())
}

#[test]
fn files_of_other_programs_hold_the_mesh_in_their_order() {
    let one = ring();
    let two = placed(&one);
    let mut formats = BTreeSet::new();
    for path in files() {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let read = read(&path);
        if name.contains("draco") {
            let text = read.unwrap_err().to_string();
            assert!(text.contains("compressed by Draco; decompress them"), "{text}");
            continue;
        }
        let MeshFile { mesh, facts, .. } = read.unwrap_or_else(|fault| panic!("{fault}"));
        let copies = if name.contains("two") { 2 } else { 1 };
        assert_eq!(mesh.n_faces(), copies * one.n_faces(), "{name}");
        assert_eq!(n_places(&mesh), copies * one.n_vertices(), "{name}");
        let [area, expected] = match copies {
            1 => [mesh.area(), one.area()],
            _ => [mesh.area(), one.area() + two.area()],
        };
        assert!((area / expected - 1.0).abs() < 1e-5, "{name}: area {area}, not {expected}");
        let expected = one.signed_volume() + if copies == 2 { two.signed_volume() } else { 0.0 };
        let found = mesh.signed_volume();
        assert!((found / expected - 1.0).abs() < 1e-4, "{name}: volume {found}, not {expected}");
        if let Some(instances) = facts.instances {
            assert_eq!(instances, copies, "{name}");
        }
        let is_gltf = name.ends_with(".glb") || name.ends_with(".gltf");
        assert_eq!(facts.unit == Some(LengthUnit::Meter), is_gltf, "{name}");
        assert_eq!(facts.ignored.contains(&"morph targets"), name.starts_with("blender-two"), "{name}");
        if IN_ORDER.contains(&name.as_str()) {
            assert_eq!(mesh.n_vertices(), one.n_vertices(), "{name}");
            let gaps = mesh.positions.iter().zip(&one.positions).map(|(p, q)| (p - q).norm());
            assert!(gaps.fold(0.0, f64::max) < 1e-5, "{name}");
        }
        formats.insert(name.rsplit('.').next().unwrap().to_owned());
    }
    let formats: Vec<&str> = formats.iter().map(String::as_str).collect();
    assert_eq!(formats, ["3mf", "glb", "gltf", "obj", "off", "ply", "stl"]);
}
