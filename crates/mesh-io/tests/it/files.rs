//! Whole files: round trips, names, pairs, error messages, atomic writes.

use std::fs;
use std::io::{Read as _, Write as _};
use std::path::Path;

use canonform_mesh_io::{
    Disk, FORMATS, Format, GzipReader, MemoryFile, ReadLimits, VertexField, extension, files_of,
    is_mesh_path, mesh_files, or_list, read, read_file, read_from, read_memory, without_extension, write,
    write_polylines, write_scalar_field,
};
use mesh::{Fault, MeshError, TriMesh, shapes};
use nalgebra::Point3;
use proptest::prelude::*;
use surface::VertexId;
use tempfile::TempDir;
use testkit::gzip_of;

use crate::made::Rich;

/// The message of a failure.
fn refusal(outcome: Result<(), MeshError>) -> String {
    outcome.unwrap_err().to_string()
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn names_in(folder: &TempDir) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The fault in a file with this content.
fn fault_of(name: &str, content: &[u8]) -> Fault {
    let folder = folder();
    let path = folder.path().join(name);
    fs::write(&path, content).unwrap();
    match read(&path) {
        Err(MeshError::File { path: named, fault, .. }) if named == path => fault,
        other => panic!("{other:?}"),
    }
}

const EXACT: [&str; 11] = [
    "m.off", "m.obj", "m.ply", "m.vert", "m.tri", "M.PLY", "m.3mf", "m.off.gz", "m.ply.gz", "M.TRI.GZ",
    "m.3mf.gz",
];

/// Any finite number, of which zeros have signs.
fn any_finite() -> impl Strategy<Value = f64> {
    use prop::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_mesh_survives_a_round_trip(
        points in prop::collection::vec(prop::array::uniform3(any_finite()), 1..30),
        corners in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 1..30),
    ) {
        let n = points.len();
        let mesh = TriMesh {
            positions: points.into_iter().map(Point3::from).collect(),
            faces: corners.iter().map(|f| f.map(|i| VertexId::from(i.index(n)))).collect(),
        };
        let folder = folder();
        for name in EXACT {
            let path = folder.path().join(name);
            write(&path, &mesh).unwrap();
            let back = read(&path).unwrap();
            prop_assert_eq!(&back.faces, &mesh.faces);
            for (p, q) in back.positions.iter().zip(&mesh.positions) {
                prop_assert!((0..3).all(|i| p[i].to_bits() == q[i].to_bits()), "{}: {} {}", name, p, q);
            }
        }
    }
}

fn from_memory(files: &[(&str, &[u8])]) -> Result<TriMesh, MeshError> {
    let files: Vec<_> =
        files.iter().map(|(name, bytes)| MemoryFile { name: Path::new(*name), bytes }).collect();
    read_memory(&files, &ReadLimits::default())
}

#[test]
fn files_in_memory_read_like_files_on_disk() {
    let sphere = shapes::icosphere(2);
    let folder = folder();
    for name in ["m.off", "m.obj.gz"] {
        let bytes = testkit::written(name, &sphere);
        assert_eq!(from_memory(&[(name, &bytes)]).unwrap(), sphere);
    }
    write(&folder.path().join("p.vert"), &sphere).unwrap();
    let [vert, tri] = ["p.vert", "p.tri"].map(|name| fs::read(folder.path().join(name)).unwrap());
    let mut files = [("CAT0.VERT", &vert[..]), ("CAT0.TRI", &tri[..])];
    assert_eq!(from_memory(&files).unwrap(), sphere);
    files.reverse();
    assert_eq!(from_memory(&files).unwrap(), sphere);
}

#[test]
fn errors_of_files_in_memory_equal_those_of_files_on_disk() {
    let folder = folder();
    for (name, content) in [
        ("a.off", &b"OFF\n3 1 0\n0 0 0\n"[..]),
        ("a.stl", b""),
        ("a.gltf", br#"{"asset":{"version":"2.0"},"buffers":[{"uri":"b.bin","byteLength":4}]}"#),
        ("a.off.gz", b"OFF\n3 1 0\n0 0 0\n"),
        ("a.vert", b"0 0 0\n"),
        ("a.tri", b"1 2 3\n"),
        ("a.txt", b"hello"),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        let on_disk = read(&path).unwrap_err().to_string();
        fs::remove_file(&path).unwrap();
        let place = format!("{}/", folder.path().display());
        assert_eq!(from_memory(&[(name, content)]).unwrap_err().to_string(), on_disk.replace(&place, ""));
    }
    let (vert, tri) = (("a.vert", &b"0 0 0\n1 0 0\n0 1 0\n"[..]), ("b.tri", &b"1 2 3\n"[..]));
    let other_half = from_memory(&[vert, tri]).unwrap_err().to_string();
    assert!(other_half.starts_with("a.vert: its other half a.tri is missing"), "{other_half}");
    for files in [&[("a.off", tri.1), vert][..], &[vert, ("a.tri", tri.1), ("c.off", tri.1)]] {
        assert!(matches!(from_memory(files), Err(MeshError::StrayFile { .. })));
    }
    assert!(matches!(from_memory(&[]), Err(MeshError::UnknownFormat { .. })));
}

#[test]
fn mesh_paths_are_recognized_by_extension() {
    for extension in FORMATS.iter().flat_map(|format| format.extensions).filter(|name| **name != "tri") {
        for name in [format!("x/a.b.{extension}"), format!("A.{}.GZ", extension.to_uppercase())] {
            assert!(is_mesh_path(Path::new(&name)), "{name}");
        }
    }
    for name in
        ["cat0.tri", "CAT0.TRI", "a.tri.gz", "a.gz", ".off.gz", "a.txt.gz", "a.txt", "off", "a", "", ".off"]
    {
        assert!(!is_mesh_path(Path::new(name)), "{name}");
    }
}

#[test]
fn the_other_half_of_a_pair_is_found_in_either_case() {
    let tetrahedron = shapes::tetrahedron(0);
    let folder = folder();
    write(&folder.path().join("t.vert"), &tetrahedron).unwrap();
    assert_eq!(names_in(&folder), ["t.tri", "t.vert"]);
    for (vert, tri) in [("T.VERT", "T.TRI"), ("u.VERT", "u.tri"), ("v.vert", "v.TRI")] {
        for (from, to) in [("t.vert", vert), ("t.tri", tri)] {
            fs::copy(folder.path().join(from), folder.path().join(to)).unwrap();
        }
        assert_eq!(read(&folder.path().join(vert)).unwrap(), tetrahedron);
        assert_eq!(read(&folder.path().join(tri)).unwrap(), tetrahedron);
    }
    fs::remove_file(folder.path().join("t.tri")).unwrap();
    let error = read(&folder.path().join("t.vert")).unwrap_err().to_string();
    assert!(error.contains("its other half t.tri is missing"), "{error}");
}

#[test]
fn empty_and_foreign_files_are_errors_in_every_format() {
    for name in
        ["a.off", "a.obj", "a.ply", "a.stl", "a.mat", "a.glb", "a.gltf", "a.3mf", "a.xyz", "a.pts", "a.tri"]
    {
        if name != "a.tri" {
            assert_eq!(fault_of(name, b""), Fault::Empty, "{name}");
            assert_eq!(fault_of(name, b" \n\t\r\n"), Fault::Empty, "{name}");
        }
        let picture = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR and so on \xff\xfe\xfd";
        let fault = fault_of(name, picture);
        assert!(matches!(fault, Fault::Malformed(_)), "{name}: {fault:?}");
    }
}

#[test]
fn paths_without_a_mesh_are_errors() {
    let folder = folder();
    let missing = read(&folder.path().join("none.off")).unwrap_err();
    assert!(matches!(&missing, MeshError::Io(fault) if fault.action == "read"));
    let directory = folder.path().join("folder.off");
    fs::create_dir(&directory).unwrap();
    assert!(read(&directory).unwrap_err().to_string().contains("not a regular file"));
}

#[test]
fn a_file_of_zeros_is_refused_by_its_start() {
    let folder = folder();
    let valid = shapes::tetrahedron(0);
    write(&folder.path().join("half.vert"), &valid).unwrap();
    for (name, start) in [
        ("a.off", ""),
        ("b.off", "OFF\n4 4 0\n"),
        ("a.obj", ""),
        ("b.obj", "v 0 0 0\n"),
        ("a.ply", ""),
        ("b.ply", "ply\n"),
        ("a.stl", ""),
        ("b.stl", "solid"),
        ("a.mat", ""),
        ("a.glb", ""),
        ("b.glb", "glTF\x02\0\0\0"),
        ("a.gltf", ""),
        ("b.gltf", "{"),
        ("a.3mf", ""),
        ("a.xyz", "0 0 0\n"),
        ("half.tri", "1 2 3\n"),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, start).unwrap();
        // A hole of 64 GiB, more than the memory of most machines.
        fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(64 << 30).unwrap();
        let error = read(&path).unwrap_err();
        assert!(matches!(&error, MeshError::File { .. }), "{name}: {error}");
        fs::remove_file(&path).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_by_name() {
    let folder = folder();
    let device = folder.path().join("zero.off");
    std::os::unix::fs::symlink("/dev/zero", &device).unwrap();
    let pipe = folder.path().join("pipe.off");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in [device, pipe] {
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("not a regular file; pass its content through standard input"), "{error}");
    }
}

#[test]
fn a_stream_reads_like_a_file_within_its_limits() {
    let sphere = shapes::icosphere(4);
    let folder = folder();
    let name = Path::new("standard input");
    let from = |bytes: &[u8], extension: &str, limits: &ReadLimits| {
        read_from(name, &mut &bytes[..], Format::named(extension).unwrap(), limits).map(|file| file.mesh)
    };
    for extension in ["off", "OBJ", "ply", "stl", "glb", "3mf"] {
        let path = folder.path().join("m").with_extension(extension);
        write(&path, &sphere).unwrap();
        let bytes = fs::read(&path).unwrap();
        assert_eq!(from(&bytes, extension, &ReadLimits::default()).unwrap(), read(&path).unwrap());
    }
    // Endless streams end with an error.
    for extension in ["off", "obj", "ply", "stl", "mat", "glb", "gltf", "3mf", "xyz", "pts"] {
        let mut zeros = std::io::repeat(0);
        let format = Format::named(extension).unwrap();
        assert!(read_from(name, &mut zeros, format, &ReadLimits::default()).is_err(), "{extension}");
    }
    let limits = ReadLimits { max_bytes: 1 << 20, ..ReadLimits::default() };
    let mut blanks = std::io::repeat(b'\n');
    assert!(read_from(name, &mut blanks, Format::named("obj").unwrap(), &limits).is_err());
    let pair = from(b"", "vert", &limits).unwrap_err().to_string();
    assert!(pair.starts_with("standard input: this mesh has several files"), "{pair}");
}

#[test]
fn a_failed_write_leaves_the_old_file_and_no_other() {
    let folder = folder();
    let cube = shapes::cube(0);
    type Change = fn(&mut TriMesh);
    let cases: [(&str, Change, &str); 3] = [
        ("a.off", |m| m.positions[2].y = f64::NAN, "vertex 2 has a coordinate that is not finite"),
        ("a.vert", |m| m.faces[5][1] = VertexId(8), "face 5 refers to vertex 8, but the mesh has 8"),
        ("a.stl", |m| m.positions[1].x = 1e39, "vertex 1 has the coordinate 1e39, beyond"),
    ];
    for (name, change, expected) in cases {
        let path = folder.path().join(name);
        write(&path, &cube).unwrap();
        let mut mesh = cube.clone();
        change(&mut mesh);
        assert!(refusal(write(&path, &mesh)).starts_with(expected), "{name}");
        assert_eq!(read(&path).unwrap().n_faces(), 12);
    }
    let mat = write(&folder.path().join("a.mat"), &cube);
    assert!(refusal(mat).contains("MATLAB files cannot be written with a mesh; use .off"));
    let nowhere = write(&folder.path().join("none/a.off"), &cube);
    assert!(matches!(nowhere, Err(MeshError::Io(fault)) if fault.action == "write"));
    assert_eq!(names_in(&folder), ["a.off", "a.stl", "a.tri", "a.vert"]);
}

#[cfg(unix)]
#[test]
fn new_files_have_ordinary_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let (ours, ordinary) = (folder.path().join("a.off"), folder.path().join("b"));
    write(&ours, &shapes::cube(0)).unwrap();
    fs::write(&ordinary, "").unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&ordinary));
}

#[test]
fn a_scalar_field_has_a_value_and_a_color_per_vertex() {
    let cube = shapes::cube(0);
    let values = [0.0, 1.0, 2.0, f64::INFINITY, f64::NAN, 5.0, 6.0, 7.0];
    let folder = folder();
    let path = folder.path().join("field.ply");
    let colors: Vec<[u8; 3]> = (0..8).map(|v| [v, 10 * v, 255]).collect();
    let field = VertexField { name: "distance", values: &values, colors: &colors };
    write_scalar_field(&path, &cube, &field).unwrap();
    assert_eq!(read(&path).unwrap(), cube);
    let back = read_file(&path, &Disk, &ReadLimits::default()).unwrap().field.unwrap();
    let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!((back.name.as_str(), bits(&back.values)), ("distance", bits(&values)));
    let bytes = fs::read(&path).unwrap();
    for (value, color) in values.iter().zip(&colors) {
        let row = [&value.to_le_bytes()[..], color].concat();
        assert!(bytes.windows(row.len()).any(|window| window == row));
    }

    let wrong = |path: &Path, field: VertexField| write_scalar_field(path, &cube, &field).unwrap_err();
    let stl = wrong(&folder.path().join("field.stl"), field).to_string();
    assert!(
        stl.ends_with("STL files cannot be written with a value per vertex; use .off, .obj or .ply"),
        "{stl}"
    );
    let short = wrong(&path, VertexField { values: &values[1..], ..field }).to_string();
    assert!(short.starts_with("7 values for 8 vertices"), "{short}");
    let colorless = wrong(&path, VertexField { colors: &[], ..field }).to_string();
    assert!(colorless.starts_with("0 values for 8 vertices"), "{colorless}");
    for name in ["", "x", "red", "two words", "1st", "d\nelement", "\u{e9}"] {
        let error = wrong(&path, VertexField { name, ..field }).to_string();
        assert!(error.contains("is not a valid name of a PLY property"), "{error}");
    }
}

#[test]
fn lines_that_a_file_cannot_hold_are_errors() {
    let folder = folder();
    let wrong = |name: &str, lines: &[Vec<Point3<f64>>]| {
        write_polylines(&folder.path().join(name), lines).unwrap_err()
    };
    let error = wrong("lines.stl", &[]).to_string();
    assert!(error.ends_with("STL files cannot be written with lines; use .obj or .ply"), "{error}");
    let nowhere = vec![Point3::new(f64::NAN, 0.0, 0.0)];
    let error = wrong("lines.obj", &[nowhere]).to_string();
    assert!(error.starts_with("vertex 0 has a coordinate that is not finite"), "{error}");
}

#[test]
fn lines_have_an_edge_for_each_segment() {
    let point = |x: f64| Point3::new(x, 0.1, -1e-9);
    let lines = [vec![point(0.0), point(1.0), point(2.5)], vec![point(7.0)], vec![point(3.0), point(4.0)]];
    let folder = folder();
    let [obj, ply] = ["l.obj", "l.ply"].map(|name| {
        write_polylines(&folder.path().join(name), &lines).unwrap();
        fs::read(folder.path().join(name)).unwrap()
    });
    let text = String::from_utf8(obj).unwrap();
    assert_eq!(text.lines().filter(|line| line.starts_with("v ")).count(), 6);
    assert!(text.ends_with("v 4.0 0.1 -1e-9\nl 1 2 3\np 4\nl 5 6\n"), "{text}");
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 6\nproperty double x\nproperty double y\n\
        property double z\nelement edge 3\nproperty uint vertex1\nproperty uint vertex2\nend_header\n";
    let (points, edges) = ply.strip_prefix(header.as_bytes()).unwrap().split_at(6 * 24);
    let x = |v: usize| f64::from_le_bytes(*points[24 * v..].first_chunk().unwrap());
    assert_eq!([0, 1, 2, 3, 4, 5].map(x), [0.0, 1.0, 2.5, 7.0, 3.0, 4.0]);
    let ends: Vec<u32> = edges.as_chunks().0.iter().map(|&v| u32::from_le_bytes(v)).collect();
    assert_eq!(ends, [0, 1, 1, 2, 4, 5]);
}

#[test]
fn messages_about_extensions_list_the_formats() {
    assert_eq!([or_list([]), or_list(["ply"])], ["", ".ply"]);
    let all =
        "a .off, .obj, .ply, .stl, .mat, .glb, .gltf, .3mf, .xyz or .pts file, or a .vert with its .tri";
    assert_eq!(mesh_files(), all);
    let listed = |path: &str| Format::of(Path::new(path)).err().unwrap().to_string();
    assert!(listed("notes.txt").starts_with("notes.txt: unknown mesh format `.txt`; use .off"));
    assert!(listed("notes").starts_with("notes: the file name has no extension; use .off"));
    let scan =
        "scan.LAS: unknown mesh format `.las`, which `pdal translate in.las out.ply` converts; use .off";
    assert!(listed("scan.LAS").starts_with(scan), "{}", listed("scan.LAS"));
    let missing = read(Path::new("missing.zip")).unwrap_err().to_string();
    assert!(missing.starts_with("cannot read missing.zip: "), "{missing}");
}

#[test]
fn gltf_data_lies_beside_the_file() {
    let folder = folder();
    let (rich, gltf) = (Rich::new(), folder.path().join("rich.gltf"));
    let json = rich.json("more/the%20data.bin");
    fs::write(&gltf, &json).unwrap();
    let error = read(&gltf).unwrap_err().to_string();
    assert!(error.contains("its data is in the data.bin, which is missing"), "{error}");
    fs::create_dir(folder.path().join("more")).unwrap();
    let data = folder.path().join("more/the data.bin");
    fs::write(&data, &rich.data).unwrap();
    assert_eq!(files_of(&gltf), [gltf.clone(), data]);
    let (names, data) = (["rich.gltf", "more/the data.bin"], &rich.data[..]);
    let whole = from_memory(&[(names[0], json.as_bytes()), (names[1], data)]).unwrap();
    assert_eq!((whole.n_vertices(), whole), (12, read(&gltf).unwrap()));
    let stray = [(names[0], json.as_bytes()), (names[1], data), ("c.bin", data)];
    assert!(matches!(from_memory(&stray), Err(MeshError::StrayFile { .. })));
    let (name, format) = (Path::new("standard input"), Format::named("gltf").unwrap());
    let stream = read_from(name, &mut json.as_bytes(), format, &ReadLimits::default());
    assert!(stream.unwrap_err().to_string().contains("this mesh has several files, and a stream holds one"));
}

#[test]
fn compressed_files_are_read_within_their_limits() {
    let folder = folder();
    let (sphere, gzip) = (shapes::icosphere(3), folder.path().join("s.obj.gz"));
    let (plain, compressed) = (testkit::written("s.obj", &sphere), testkit::written("s.obj.gz", &sphere));
    assert!(compressed.starts_with(&[0x1f, 0x8b]) && compressed.len() < plain.len() / 2);
    // From a stream the content tells.
    let (obj, limits) = (Format::named("obj").unwrap(), ReadLimits::default());
    assert_eq!(read_from(Path::new("-"), &mut &compressed[..], obj, &limits).unwrap().mesh, sphere);
    for damage in [compressed.len() / 2, compressed.len() - 4] {
        fs::write(&gzip, &compressed[..damage]).unwrap();
        let error = read(&gzip).unwrap_err().to_string();
        assert!(error.contains("s.obj.gz: expected compressed data"), "{error}");
    }
    // A hundred thousand times the size of the file.
    let mut bomb = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    for _ in 0..100 {
        bomb.write_all(&vec![b'\n'; 1 << 20]).unwrap();
    }
    fs::write(&gzip, bomb.finish().unwrap()).unwrap();
    let error = read(&gzip).unwrap_err().to_string();
    assert!(error.contains("out of proportion to the file"), "{error}");
}

fn gunzip(bytes: &[u8]) -> std::io::Result<String> {
    let mut text = String::new();
    GzipReader::new(bytes).read_to_string(&mut text).map(|_| text)
}

#[test]
fn members_follow_each_other_and_zeros_the_last() {
    let [a, b, zeros] = [gzip_of(b"OFF\n"), gzip_of(b"3 1 0\n"), vec![0; 20_000]];
    for (pieces, text) in [
        (vec![&a], "OFF\n"),
        (vec![&a, &b], "OFF\n3 1 0\n"),
        (vec![&a, &zeros], "OFF\n"),
        (vec![&a, &zeros, &b, &zeros], "OFF\n3 1 0\n"),
        (vec![&gzip_of(b""), &a], "OFF\n"),
    ] {
        assert_eq!(gunzip(&pieces.into_iter().flatten().copied().collect::<Vec<_>>()).unwrap(), text);
    }
    for damaged in [&a[..a.len() - 3], &[&a[..], b"garbage"].concat(), b"", &zeros] {
        assert!(gunzip(damaged).is_err(), "{} bytes", damaged.len());
    }
}

#[test]
fn compressed_files_have_the_extension_of_their_content() {
    for (name, expected, stem) in [
        ("a/cat0.off", "off", "a/cat0"),
        ("a/cat0.OFF.GZ", "off", "a/cat0"),
        ("cat.1.ply.gz", "ply", "cat.1"),
        ("cat.gz", "", "cat"),
        ("cat", "", "cat"),
    ] {
        let path = Path::new(name);
        assert_eq!(extension(path), expected, "{name}");
        assert_eq!(without_extension(path), Path::new(stem), "{name}");
    }
}
