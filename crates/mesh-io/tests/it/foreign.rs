//! Files that other programs wrote, of one small torus and of two copies of it, one of them moved and mirrored.
//! `tests/foreign/make.py` makes them.

use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use canonform_mesh_io::{Disk, LengthUnit, MeshFile, ReadLimits, is_mesh_path, read_file};
use mesh::{Fault, MeshError, TriMesh};
use nalgebra::Point3;
use surface::VertexId;

/// The torus, vertex by vertex as `make.py` has it.
fn ring() -> TriMesh {
    let (n_major, n_minor) = (8usize, 5usize);
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for i in 0..n_major {
        let u = TAU * i as f64 / n_major as f64;
        for j in 0..n_minor {
            let v = TAU * j as f64 / n_minor as f64;
            let r = 2.0 + 0.7 * v.cos();
            positions.push(Point3::new(r * u.cos(), r * u.sin(), 0.7 * v.sin()));
            let (next, up) = ((i + 1) % n_major * n_minor, (j + 1) % n_minor);
            let [a, b, c, d] = [i * n_minor + j, next + j, next + up, i * n_minor + up].map(VertexId::from);
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    TriMesh { positions, faces }
}

/// The copy: turned, mirrored, stretched and moved.
fn placed(mesh: &TriMesh) -> TriMesh {
    let positions = mesh.positions.iter().map(|p| Point3::new(p.y + 10.0, p.x, 2.0 * p.z)).collect();
    TriMesh { positions, faces: mesh.faces.iter().map(|[a, b, c]| [*a, *c, *b]).collect() }
}

fn n_places(mesh: &TriMesh) -> usize {
    let rounded = mesh.positions.iter().map(|p| [p.x, p.y, p.z].map(|x| (x * 1e4).round() as i64));
    rounded.collect::<BTreeSet<_>>().len()
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
fn files_of_other_programs_hold_the_mesh() {
    let one = ring();
    let two = placed(&one);
    let mut formats = BTreeSet::new();
    for path in files() {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if name.contains("draco") {
            continue;
        }
        let MeshFile { mesh, facts, .. } = read(&path).unwrap_or_else(|fault| panic!("{fault}"));
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
        formats.insert(name.rsplit('.').next().unwrap().to_owned());
    }
    let formats: Vec<&str> = formats.iter().map(String::as_str).collect();
    assert_eq!(formats, ["3mf", "glb", "gltf", "obj", "off", "ply", "stl"]);
}

#[test]
fn vertices_keep_the_order_that_other_programs_gave_them() {
    let expected = ring();
    for name in [
        "trimesh-ring.off",
        "trimesh-ring.ply",
        "trimesh-ring.glb",
        "trimesh-ring.3mf",
        "meshio-ring.obj",
        "meshlab-ring.3mf",
        "blender-ring.ply",
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign").join(name);
        let mesh = read(&path).unwrap().mesh;
        assert_eq!(mesh.n_vertices(), expected.n_vertices(), "{name}");
        for (v, (p, q)) in mesh.positions.iter().zip(&expected.positions).enumerate() {
            assert!((p - q).norm() < 1e-5, "{name}: vertex {v} is at {p}, not at {q}");
        }
    }
}

#[test]
fn draco_files_of_blender_are_refused_with_a_remedy() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign/blender-draco.glb");
    let error = read(&path).unwrap_err();
    assert!(matches!(&error, MeshError::File { fault: Fault::Unsupported { .. }, .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("compressed by Draco; decompress them"), "{text}");
}
